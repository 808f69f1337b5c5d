// Hands as the world leaves them: what a headset sees of one goes through things, bones of the scene do not.
import { Quaternion, Vector3 } from "three";
import type { Scene, Snapshot } from "softfinger-client";
import { kWorldInRoom } from "./placement";
import { endsOf, kJoints, positionOf, rotationOf, setPose, type Side } from "./xr_hand";

const kFurthest = 0.2; // m: a bone this far from where it is seen is not that hand's

/** What of the scene follows the stretch of a hand from a joint to the next. */
interface Held {
  side: Side;
  joint: XRHandJoint;
  poseIn: (snapshot: Snapshot) => ArrayLike<number> | undefined; // of its middle, x away from the wrist
}

/** The joint at which the bone of a scene's hand that is called right or left begins. */
function jointOf(bone: string): { side: Side; joint: XRHandJoint } | null {
  const parts = /^(right|left)-(thumb|index|middle|ring|pinky)-(metacarpal|proximal|middle)$/.exec(bone);
  if (!parts) return null;
  const [, side, finger, name] = parts;
  const of = finger === "thumb" ? "thumb" : `${finger}-finger`;
  const part = { metacarpal: "metacarpal", proximal: "phalanx-proximal", middle: "phalanx-intermediate" }[name!];
  return { side: side as Side, joint: `${of}-${part}` as XRHandJoint };
}

/** Hands of the scene that follow the headset. */
export class HeldHands {
  private held: Held[] = [];
  private bones = new Map<number, Side>(); // by object

  begin(scene: Scene): void {
    const followed = new Set(scene.fingers.flatMap(({ headset }) => (headset ? [headset.hand] : [])));
    this.held = [];
    this.bones.clear();
    scene.objects.forEach(({ name, hand }, o) => {
      const bone = hand ? jointOf(name) : null;
      if (!bone || !followed.has(bone.side)) return; // a script's
      this.bones.set(o, bone.side);
      this.held.push({ ...bone, poseIn: ({ X_WO }) => X_WO[o] });
    });
    const whole = new Set(this.bones.values());
    scene.fingers.forEach(({ headset }, f) => {
      if (!headset || !whole.has(headset.hand)) return; // the rest of it is where it is seen
      this.held.push({ side: headset.hand, joint: endsOf(headset.finger).distal, poseIn: ({ fingers }) => fingers[f]?.X_WF });
    });
  }

  /** Whose bone an object is; undefined: nobody's. */
  sideOf(object: number): Side | undefined {
    return this.bones.get(object);
  }

  /**
   * The joints of a hand seen in the scene's space where the world holds them, how many, and how far one of them is from
   * where it is seen, m; null where the scene has no such hand, or not there.
   */
  asHeld(side: Side, seen: Float32Array, snapshot: Snapshot): { joints: Float32Array; count: number; back: number } | null {
    const of = this.held.filter((held) => held.side === side);
    if (of.length === 0) return null;
    const joints = seen.slice();
    const palm: Vector3[] = []; // ways
    let back = 0;
    for (const { joint, poseIn } of of) {
      const pose = poseIn(snapshot);
      if (!pose) return null;
      const next = kJoints[kJoints.indexOf(joint) + 1]!;
      const [from, to] = [new Vector3(...positionOf(seen, joint)), new Vector3(...positionOf(seen, next))];
      const middle = new Vector3(pose[0], pose[1], pose[2]).multiplyScalar(1e-3).applyQuaternion(kWorldInRoom);
      const way = middle.clone().sub(from.clone().add(to).multiplyScalar(0.5));
      if (way.length() > kFurthest) return null;
      back = Math.max(back, way.length());
      if (joint.endsWith("-metacarpal")) palm.push(way);
      const turned = kWorldInRoom.clone().multiply(new Quaternion(pose[3], pose[4], pose[5], pose[6]))
        .multiply(kWorldInRoom.clone().invert());
      const half = new Vector3(0, 0, -0.5 * from.distanceTo(to)).applyQuaternion(turned);
      setPose(joints, joint, middle.clone().sub(half), turned);
      if (next.endsWith("-tip")) setPose(joints, next, middle.clone().add(half), turned);
    }
    const wrist = new Vector3(...positionOf(seen, "wrist"));
    for (const way of palm) wrist.addScaledVector(way, 1 / palm.length);
    setPose(joints, "wrist", wrist, new Quaternion(...rotationOf(seen, "wrist")));
    return { joints, count: of.length, back };
  }
}
