// What may be asked of a softfinger run. What it would refuse is refused here, since it ends the connection for that.
import { Connection } from "./connection.js";
import { handMessage, kHandJoints } from "./wire.js";

const kFarthest = 1000; // mm from the origin of W, of a coordinate
const kPerJoint = 8; // position, quaternion, radius

export class Client extends Connection {
  pause() { return this.send({ request: "pause" }); }
  resume() { return this.send({ request: "resume" }); }
  restart() { return this.send({ request: "restart" }); }
  cancelRegistration() { return this.send({ request: "cancel_registration" }); }
  cancelFit() { return this.send({ request: "cancel_fit" }); }

  felt() { return this.send({ request: "felt" }); }

  /** @type {import("./index.js").Client["release"]} */
  release(seen = this.snapshot) {
    return seen !== null && this.send({ request: "release", generation: seen.generation, stops: seen.stops });
  }

  /** @type {import("./index.js").Client["chooseScene"]} */
  chooseScene(name) {
    if (!this.scene) return false;
    return this.send({ request: "scene", scene: oneOf("scene", name, this.scene.scenes) });
  }

  /** @type {import("./index.js").Client["chooseObjective"]} */
  chooseObjective(finger, name) {
    if (!this.scene) return false;
    const index = this.#fingerOf(finger);
    const objectives = this.scene.fingers[index]?.objectives.map((place) => this.scene?.objectives[place]?.name ?? "");
    return this.send({ request: "objective", finger: index, objective: oneOf("objective", name, objectives ?? []) });
  }

  /** @type {import("./index.js").Client["pose"]} */
  pose(finger, position_mm, quaternion = [1, 0, 0, 0]) {
    if (!this.scene) return false;
    return this.send({ request: "pose", finger: this.#fingerOf(finger), ...poseOf(position_mm, quaternion) });
  }

  /** @type {import("./index.js").Client["hold"]} */
  hold(object, position_mm, quaternion = [1, 0, 0, 0]) {
    if (!this.scene) return false;
    return this.send({ request: "hold", object: this.#holdable(object), ...poseOf(position_mm, quaternion) });
  }

  /** @type {import("./index.js").Client["letGo"]} */
  letGo(object) {
    return this.scene !== null && this.send({ request: "let_go", object: this.#holdable(object) });
  }

  /** @type {import("./index.js").Client["hand"]} */
  hand(side, joints, time_ms = performance.now()) {
    check(!joints || joints.length === kPerJoint * kHandJoints.length,
      `${kPerJoint} numbers of each of ${kHandJoints.length} joints`, joints?.length);
    return this.sendNewest(handMessage(side, joints, time_ms));
  }

  /** @type {import("./index.js").Client["register"]} */
  register(finger, measured = {}) {
    return this.scene !== null && this.send({ request: "register", finger: this.#fingerOf(finger), ...measured });
  }

  /** @type {import("./index.js").Client["fit"]} */
  fit(finger, again = false) {
    return this.scene !== null && this.send({ request: "fit", finger: this.#fingerOf(finger), again });
  }

  /** @param {string} name */
  #holdable(name) {
    const objects = this.scene?.objects.filter(({ holdable }) => holdable) ?? [];
    return oneOf("object that can be held", name, objects.map((object) => object.name));
  }

  /** @param {number | string} finger */
  #fingerOf(finger) {
    const names = this.scene?.fingers.map(({ name }) => name) ?? [];
    return names.indexOf(oneOf("finger", typeof finger === "number" ? names[finger] ?? finger : finger, names));
  }
}

/** @param {readonly number[]} position_mm @param {readonly number[]} quaternion */
function poseOf(position_mm, quaternion) {
  check(position_mm.length === 3 && position_mm.every((x) => Math.abs(x) <= kFarthest),
    `a position of three coordinates within ${kFarthest} mm of the origin`, position_mm);
  check(quaternion.length === 4 && Math.abs(Math.hypot(...quaternion) - 1) < 0.01,
    "a quaternion w, x, y, z of length 1", quaternion);
  return { position_mm: [...position_mm], quaternion: [...quaternion] };
}

/** @param {string} what @param {string | number} name @param {string[]} names @returns {string} */
function oneOf(what, name, names) {
  if (typeof name === "string" && names.includes(name)) return name;
  throw new Error(`softfinger: no ${what} '${name}' here; there is ${names.join(", ") || "none"}`);
}

/** @param {boolean} sound @param {string} expected @param {unknown} found */
function check(sound, expected, found) {
  if (!sound) throw new Error(`softfinger: expected ${expected}, not ${JSON.stringify(found)}`);
}
