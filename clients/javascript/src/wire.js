// Binary messages, as docs/protocol.md lays them out: snapshots read, hands written. Little-endian.

/** Of the protocol; grows when who knows the one before would misread it. */
export const kProtocolVersion = 2;

/** What the contact of a finger comes to, in the order of a snapshot. */
export const kContactSums = [
  "contact_area_mm2",
  "normal_force_N",
  "tangential_force_N",
  "slip_ratio",
  "stuck_fraction",
  "normal_force_sum_N",
];

/** Measures of the twin, in the order of a snapshot. */
const kTwinMeasures = [
  "iou",
  "centroid_shift_mm",
  "normal_angle_deg",
  "normal_force_error",
  "normal_force_bias",
  "normal_force_N",
  "contact_area_mm2",
  "press_ms",
  "normal_force_sum_N",
  "tangential_force_N",
  "tangential_force_error",
  "slip_ratio_error",
];

const kFingers = ["index", "middle", "ring", "pinky"];
const kBones = ["metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip"];

/** In the order of XRHandJoint (W3C, WebXR Hand Input Module). */
export const kHandJoints = [
  "wrist", "thumb-metacarpal", "thumb-phalanx-proximal", "thumb-phalanx-distal", "thumb-tip",
  ...kFingers.flatMap((finger) => kBones.map((bone) => `${finger}-finger-${bone}`)),
];

const kSnapshotMagic = 0x41534653; // "SFSA"
const kSnapshotHeader = 56; // bytes
const kHandMagic = 0x58484653; // "SFHX"
const kHandHeader = 16; // bytes

/** Takes one number after the other from a frame. Arrays are views into it. */
class Reader {
  #view;
  #frame;
  #at = 0;

  /** @param {ArrayBuffer} frame */
  constructor(frame) {
    this.#frame = frame;
    this.#view = new DataView(frame);
  }

  u32() { return this.#view.getUint32(this.#step(4), true); }
  f32() { return this.#view.getFloat32(this.#step(4), true); }
  f64() { return this.#view.getFloat64(this.#step(8), true); }
  /** @param {number} count */
  floats(count) { return new Float32Array(this.#frame, this.#step(4 * count), count); }
  /** @param {number} count */
  bytes(count) { return new Uint8Array(this.#frame, this.#step(count), count); }
  pose() { return this.floats(7); }
  /** @param {number} size */
  text(size) { return new TextDecoder().decode(this.bytes(size)).replace(/\0+$/, ""); }
  /** @param {readonly string[]} names @returns {any} */
  named(names) { return Object.fromEntries(names.map((name) => [name, this.f32()])); }

  /** @param {number} samples */
  skin(samples) {
    const positions_mm = this.floats(3 * samples);
    const pressures_kPa = this.floats(samples);
    const in_contact = this.bytes(samples);
    this.#at = (this.#at + 3) & ~3;
    return { positions_mm, pressures_kPa, in_contact };
  }

  /** @param {number} bytes */
  #step(bytes) { return (this.#at += bytes) - bytes; }
}

/** @param {Reader} read @param {number} stages @returns {import("./messages.js").FingerSnapshot} */
function readFinger(read, stages) {
  const poses = { X_WFt: read.pose(), X_WF: read.pose(), X_FP: read.pose() };
  const sums = read.named(kContactSums);
  const deviation_mm2 = read.f32();
  const tick = read.u32();
  const stages_ms = read.floats(stages);
  const device_said_ms = read.f32();
  const [samples, dofs, joints, points, pieces, twinSamples, known, flags] = Array.from({ length: 8 }, () => read.u32());
  return {
    ...poses, ...sums, deviation_mm2, tick, stages_ms, device_said_ms,
    force_limited: (flags & 1) !== 0,
    objective: flags >>> 8,
    device_state: read.text(16),
    ...read.skin(samples),
    configuration: read.floats(dofs),
    actual: read.floats(known),
    joint_values: read.floats(joints),
    linkage_mm: read.floats(3 * points),
    pieces: read.floats(8 * pieces),
    twin: twinSamples > 0 ? { ...read.named(kTwinMeasures), ...read.skin(twinSamples) } : null,
  };
}

/** @param {Reader} read @returns {import("./messages.js").SoftObjectSnapshot} */
function readSoftObject(read) {
  const object = read.u32();
  const points = read.u32();
  return { object, positions_mm: read.floats(3 * points) };
}

/** @type {typeof import("./index.js").readSnapshot} */
export function readSnapshot(frame, scene) {
  const read = new Reader(frame);
  if (frame.byteLength < kSnapshotHeader || read.u32() !== kSnapshotMagic) return null;
  const generation = read.u32();
  const step = read.u32();
  const flags = read.u32();
  const time_s = read.f64();
  const step_ms = read.f32();
  const match_ms = read.f32();
  const [deadline_misses, objects, fingers, wall_ms, stops, softObjects] = Array.from({ length: 6 }, () => read.u32());
  return {
    generation, step, time_s, wall_ms, stops, step_ms, match_ms, deadline_misses,
    paused: (flags & 1) !== 0,
    finished: (flags & 2) !== 0,
    stopped: (flags & 4) !== 0,
    stop_confirmed: (flags & 8) !== 0,
    X_WO: Array.from({ length: objects }, () => read.pose()),
    fingers: Array.from({ length: fingers }, () => readFinger(read, scene.latency_stages.length)),
    soft_objects: Array.from({ length: softObjects }, () => readSoftObject(read)),
  };
}

/**
 * A hand that a headset sees; `joints` null: it does not.
 * @param {"right" | "left"} side
 * @param {ArrayLike<number> | null} joints
 * @param {number} time_ms
 */
export function handMessage(side, joints, time_ms) {
  const message = new ArrayBuffer(kHandHeader + (joints ? 4 * joints.length : 0));
  const view = new DataView(message);
  view.setUint32(0, kHandMagic, true);
  view.setUint32(4, (joints ? 1 : 0) | (side === "left" ? 2 : 0), true);
  view.setFloat64(8, time_ms, true);
  if (joints) new Float32Array(message, kHandHeader).set(joints);
  return message;
}
