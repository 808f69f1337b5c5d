import type { Events, Fit, Loading, Notifications, Registration, Request, Scene, Snapshot } from "./messages.js";

export * from "./messages.js";

/** What a Client tells its listeners. */
export interface Listened {
  /** The program begins a scene, or begins it anew. */
  scene: Scene;
  /** 60 times a second, fewer where the connection is slow: then older ones are left out. */
  snapshot: Snapshot;
  registration: Registration;
  fit: Fit;
  notifications: Notifications;
  loading: Loading;
  /** What happened to objects that move, each once. */
  events: Events;
  state: "connecting" | "live" | "lost" | "closed";
}

/** Of Node.js alone; a browser has them from the page that it shows. */
export interface Options {
  /** Of `softfinger run --token FILE`, where the address does not have it. */
  token?: string;
  /** Certificates, PEM, of who signed the program's own. */
  ca?: string | Uint8Array;
}

/**
 * A connection to a softfinger run. Lost, it looks for the program each second until it is closed. Methods that ask for
 * something say whether it was sent, false without a connection, and throw an Error of one line for what the program
 * would refuse. Fingers go by their name, or their place in `scene.fingers`.
 */
export class Client {
  private constructor();

  /** Of the program, without a token. */
  readonly address: string;
  /** The newest; null before there is one. */
  readonly scene: Scene | null;
  /** The newest of `scene`. */
  readonly snapshot: Snapshot | null;
  readonly state: Listened["state"];

  /**
   * Calls `listener` with each message from now on, and at once with the newest where one still counts (all but
   * notifications and events). With "state" comes why, one line: of "lost", and of "closed" where the program speaks another
   * version of the protocol. Returns what ends it.
   */
  on<Kind extends Exclude<keyof Listened, "state">>(kind: Kind, listener: (message: Listened[Kind]) => void): () => void;
  on(kind: "state", listener: (state: Listened["state"], why: string) => void): () => void;
  /** The first to come from now on. Rejects, with why, when the connection is lost or closed before. */
  next<Kind extends keyof Listened>(kind: Kind): Promise<Listened[Kind]>;

  pause(): boolean;
  resume(): boolean;
  restart(): boolean;
  /** Stops all devices: they retract, and stay so until released. Asked for without a connection it is sent as soon as there is one. */
  stop(): boolean;
  /** Releases devices from the stop that `seen` tells of; without it, the newest snapshot. A stop that has come since stays. */
  release(seen?: Pick<Snapshot, "generation" | "stops"> | null): boolean;
  /** One of `scene.scenes`. */
  chooseScene(name: string): boolean;
  /** What leads a finger's device: the name of one of `scene.objectives` that the finger can have. */
  chooseObjective(finger: number | string, name: string): boolean;
  /**
   * X_WFt of a finger whose tracker is `page` (`moved_here`): position in W, mm, each coordinate within 1000, and
   * quaternion w, x, y, z. To be sent again and again, 20 to 50 times a second: 200 ms of silence are a finger that is
   * gone. The first client that moves a finger is the one that does, while it is connected.
   */
  pose(finger: number | string, position_mm: readonly number[], quaternion?: readonly number[]): boolean;
  /**
   * A person holds a `holdable` object there, as pose(), X_WO: a spring pulls it, as hard as a hand would. Again and again:
   * after 200 ms of silence it is let go.
   */
  hold(object: string, position_mm: readonly number[], quaternion?: readonly number[]): boolean;
  /** It flies on as it moved. */
  letGo(object: string): boolean;
  /**
   * A hand for fingers whose tracker is `webxr` (`headset`), as pose(): eight numbers each of kHandJoints, position (m)
   * and quaternion x, y, z, w in a y-up space with the scene's origin, and radius (m); null: it is not seen. Dropped
   * where earlier ones still wait to be sent.
   */
  hand(side: "right" | "left", joints: ArrayLike<number> | null, time_ms?: number): boolean;
  /** Begins the registration of a `registrable` finger; sizes and height of the table (z of W) where they were measured, mm. */
  register(finger: number | string, measured?: Measured): boolean;
  cancelRegistration(): boolean;
  /**
   * The device of a `fittable` finger presses by itself and learns who wears it. `again`: the finger is known, the device was
   * put on again. It stays retracted afterwards, until it is released.
   */
  fit(finger: number | string, again?: boolean): boolean;
  /** Ends it; the device retracts and nothing is written. */
  cancelFit(): boolean;
  /** The wearer feels the device, of a fit by touches. */
  felt(): boolean;
  /** Any request, as it stands. */
  send(request: Request): boolean;
  /** For good. */
  close(): void;
}

export type Measured = Omit<Extract<Request, { request: "register" }>, "request" | "finger">;

/** A client that has a scene. */
export type ConnectedClient = Client & { readonly scene: Scene };

/**
 * Connects to `softfinger run` at the address that it prints, e.g. "http://127.0.0.1:8080", and waits for its scene. Throws
 * an Error of one line where there is none, or where it speaks another version of the protocol.
 */
export function connect(address: string, options?: Options): Promise<ConnectedClient>;
/** The same without waiting, for who may begin before the program does. */
export function open(address: string, options?: Options): Client;

/** Of the protocol. */
export const kProtocolVersion: number;
/** Names of ContactSums in the order of a snapshot. */
export const kContactSums: readonly (keyof import("./messages.js").ContactSums)[];
/** Names of a hand's joints in the order of `Client.hand`, those of WebXR. */
export const kHandJoints: readonly string[];
/** Reads a binary frame of a scene; null where it is none. Arrays are views into it. */
export function readSnapshot(frame: ArrayBuffer, scene: Scene): Snapshot | null;
