// What goes over the WebSocket of a softfinger run, message by message as docs/protocol.md has it. Lengths in mm.

export type RigidShape =
  | { kind: "plane" }
  | { kind: "sphere"; radius_mm: number }
  | { kind: "box"; size_mm: [number, number, number]; edge_radius_mm: number }
  | { kind: "cylinder"; radius_mm: number; length_mm: number; edge_radius_mm: number }
  | { kind: "mesh"; positions_mm: number[]; triangles: number[] };
/** What is soft is told as it is at rest; see Snapshot.soft_objects. */
export type Shape = RigidShape | { kind: "soft"; positions_mm: number[]; triangles: number[] };

/** What a finger follows of a hand that a headset sees. */
export interface FollowedFinger {
  hand: "right" | "left";
  finger: "thumb" | "index" | "middle" | "ring" | "pinky";
  start: number[]; // X_WFt: position (mm) and quaternion x, y, z, w
}

/** What a device reaches. Tilts go from zero, entry k of n in direction (pitch, roll) = 2 pi k / n. */
export interface Workspace {
  reaches: { name: string; min: number; max: number }[]; // of each axis, or of all alike
  tilt_layers: { travel_mm: number; tilts_deg: number[] }[];
  pitch_axis: number; // of q; -1: none
  roll_axis: number;
  travel_axis: number;
}

export interface FingerDescription {
  name: string;
  skin_positions_mm: number[];
  skin_triangles: number[];
  rigid_positions_mm: number[];
  bone_triangles: number[];
  nail_triangles: number[];
  device_kind: string; // "": no device
  device_kind_words: string; // what people call it
  cables: boolean; // its linkage is of cables
  configuration_names: string[];
  objectives: number[]; // places in Scene.objectives of those that the device can have
  joint_unit: "deg" | "mm";
  disk_radius_mm: number;
  legs: number;
  pieces: { shape: RigidShape; count: number }[]; // of the device's solid, alike ones in a row together
  cap_radius_mm: number; // above 0: the first piece is a ball that shows above this ring
  workspace: Workspace;
  twin: boolean;
  moved_here: boolean; // by the page
  registrable: boolean; // what its tracker follows, for the person whose file was given
  fittable: boolean; // its device can learn who wears it, for the same person
  fits_by_touch: boolean; // the wearer tells each touch: it has no force sensor
  headset: FollowedFinger | null; // null: no headset moves it
}

export interface Scene {
  type: "scene";
  protocol_version: number;
  generation: number; // grows with each scene or restart
  scene: string;
  scenes: string[];
  duration_s: number;
  objects: { name: string; shape: Shape; hand: string | null; holdable: boolean; joint: "slider" | "hinge" | "ball" | "fixed" | null }[];
  fingers: FingerDescription[];
  notices: Notice[];
  objectives: Objective[];
  device_states: DeviceState[]; // the most urgent first
  latency_stages: LatencyStage[];
}

export type SceneObject = Scene["objects"][number];

/** What a device can be led by. */
export interface Objective {
  name: string;
  words: string;
}

/** What a device may be doing, and how much that asks of a person. */
export interface DeviceState {
  name: string;
  tone: string; // plain, touching, warning, fault
}

/** A stage on the way from a finger to the servos. */
export interface LatencyStage {
  name: string;
  words: string;
}

/** What a person should know of a finger's device before it moves. */
export interface Notice {
  finger: number; // of the scene's
  kind: string;
  text: string;
}

/** Which scene is on its way in place of the one shown,. */
export interface Loading {
  type: "loading";
  scene: string; // "": none
}

/** How a registration stands. */
export interface Registration {
  type: "registration";
  state: "idle" | "running" | "saved" | "refused";
  finger: number; // of the scene's
  held: number; // postures, of so many
  of: number;
  posture: string; // to hold now
  words: string; // how, one sentence
  progress: number; // 0 to 1
  message: string; // what was found, or why nothing was saved
}

/** How a fit of a device to its wearer stands. */
export interface Fit {
  type: "fit";
  state: "idle" | "waiting" | "pressing" | "estimating" | "saved" | "refused";
  finger: number; // of the scene's
  by_touch: boolean; // presses are touches that the wearer tells, by "felt"
  press: number; // under way, from 1; 0: none yet
  of: number; // so many
  words: string; // what happens now, one sentence
  force_N: number; // as the sensor says
  progress: number; // of presses or estimate, 0 to 1
  message: string; // what was found, or why nothing was saved
}

/** What people are told on the terminal,. */
export interface Notifications {
  type: "notifications";
  lines: string[];
}

/** What happened to objects of a scene that move by forces. */
export interface Events {
  type: "events";
  generation: number; // of the scene
  events: {
    time_s: number; // simulated
    kind: "impact" | "release" | "click" | "detent" | "limit";
    object: string; // its name
    other: string | null; // an object's or a finger's
    impulse_N_s: number | null;
  }[];
}

/** Position (mm) and unit quaternion x, y, z, w. */
export type PoseArray = Float32Array;

/** Skin in contact, in F. */
export interface Skin {
  positions_mm: Float32Array;
  pressures_kPa: Float32Array;
  in_contact: Uint8Array;
}

/** The second finger, pressed by the device. NaN where a measure is not defined. */
export interface Twin extends Skin {
  iou: number;
  centroid_shift_mm: number;
  normal_angle_deg: number;
  normal_force_error: number;
  normal_force_bias: number;
  normal_force_N: number;
  contact_area_mm2: number;
  press_ms: number;
  normal_force_sum_N: number;
  tangential_force_N: number;
  tangential_force_error: number;
  slip_ratio_error: number;
}

/** What the contact of a finger comes to. */
export interface ContactSums {
  contact_area_mm2: number;
  normal_force_N: number; // magnitude of the sum
  tangential_force_N: number;
  slip_ratio: number;
  stuck_fraction: number; // of the contact area
  normal_force_sum_N: number; // sum of magnitudes
}

export interface FingerSnapshot extends Skin, ContactSums {
  X_WFt: PoseArray;
  X_WF: PoseArray;
  X_FP: PoseArray;
  deviation_mm2: number;
  tick: number; // of the device
  stages_ms: Float32Array; // of that tick, one each of latency_stages; NaN: unknown
  device_said_ms: number; // how long ago who leads the servos last showed life; NaN: nobody does
  device_state: string;
  force_limited: boolean; // the device would advance further but for its limit of force
  objective: number; // that leads the device: its place in Scene.objectives
  configuration: Float32Array; // in the units of configuration_names
  actual: Float32Array; // the same as the servos say; empty: they do not
  joint_values: Float32Array; // in joint_unit
  linkage_mm: Float32Array; // in F; base joint, knee, platform joint of each leg
  pieces: Float32Array; // eight a piece: pose in F, radius_mm of a ball
  twin: Twin | null; // null: not pressed yet, or none
}

/** The surface of an object of kind soft as it stands. */
export interface SoftObjectSnapshot {
  object: number; // its place in Scene.objects
  positions_mm: Float32Array; // of the points of its shape, in O
}

export interface Snapshot {
  generation: number;
  step: number;
  paused: boolean;
  /** A device is to be stopped: it is led away, and stays so until it is released. */
  stopped: boolean;
  /** All that are to be stopped are, as those say that lead their servos. */
  stop_confirmed: boolean;
  stops: number; // how often devices were stopped so far
  finished: boolean;
  time_s: number;
  wall_ms: number; // of the program's clock, when it was taken; wraps around
  step_ms: number;
  match_ms: number;
  deadline_misses: number;
  X_WO: PoseArray[];
  fingers: FingerSnapshot[];
  soft_objects: SoftObjectSnapshot[]; // those that the scene has, in its order
}

export type Request =
  | { request: "pause" }
  | { request: "resume" }
  | { request: "restart" }
  | { request: "stop" }
  | { request: "release"; generation: number; stops: number } // as the newest snapshot had them
  | { request: "register"; finger: number; length_mm?: number; breadth_mm?: number; depth_mm?: number; table_mm?: number }
  | { request: "cancel_registration" }
  | { request: "fit"; finger: number; again?: boolean }
  | { request: "cancel_fit" }
  | { request: "felt" }
  | { request: "scene"; scene: string }
  | { request: "objective"; finger: number; objective: string } // a name
  | { request: "pose"; finger: number; position_mm: number[]; quaternion: number[] } // w, x, y, z
  | { request: "hold"; object: string; position_mm: number[]; quaternion: number[] } // likewise
  | { request: "let_go"; object: string };
