// A hand as WebXR gives it, and the message that carries it to the program (hand_message.hpp).
import type { FollowedFinger } from "./wire";

export type Side = FollowedFinger["hand"];

const kFingers = ["index-finger", "middle-finger", "ring-finger", "pinky-finger"] as const;

/** In the order of XRHandJoint (W3C, WebXR Hand Input Module). */
export const kJoints = [
  "wrist", "thumb-metacarpal", "thumb-phalanx-proximal", "thumb-phalanx-distal", "thumb-tip",
  ...kFingers.flatMap((finger) => [
    `${finger}-metacarpal`, `${finger}-phalanx-proximal`, `${finger}-phalanx-intermediate`,
    `${finger}-phalanx-distal`, `${finger}-tip`,
  ]),
] as XRHandJoint[];

const kMagic = 0x58484653;
const kFarthest = 10; // m from the origin, in a coordinate
const kPerJoint = 8; // position, quaternion x, y, z, w, radius

/** Poses and radii of all joints in `space`, eight numbers a joint; null where the hand is not seen. */
export function readJoints(frame: XRFrame, hand: XRHand, space: XRReferenceSpace): Float32Array | null {
  const joints = new Float32Array(kPerJoint * kJoints.length);
  for (const [i, name] of kJoints.entries()) {
    const joint = hand.get(name);
    const pose = joint && frame.getJointPose?.(joint, space);
    if (!pose) return null;
    const { position: p, orientation: q } = pose.transform;
    joints.set([p.x, p.y, p.z, q.x, q.y, q.z, q.w, Math.min(Math.max(pose.radius ?? 0, 0), 0.1)], kPerJoint * i);
    if (![p.x, p.y, p.z].every((x) => Math.abs(x) <= kFarthest)) return null;
  }
  return joints.every(Number.isFinite) ? joints : null;
}

/** Null: the hand is not seen. `time` in ms. */
export function handMessage(side: Side, joints: Float32Array | null, time: number): ArrayBuffer {
  const message = new ArrayBuffer(16 + (joints ? 4 * joints.length : 0));
  const view = new DataView(message);
  view.setUint32(0, kMagic, true);
  view.setUint32(4, (joints ? 1 : 0) | (side === "left" ? 2 : 0), true);
  view.setFloat64(8, time, true);
  joints?.forEach((x, i) => view.setFloat32(16 + 4 * i, x, true));
  return message;
}

/** A joint's position of what readJoints gives, m. */
export function positionOf(joints: Float32Array, joint: XRHandJoint): [number, number, number] {
  const at = kPerJoint * kJoints.indexOf(joint);
  return [joints[at]!, joints[at + 1]!, joints[at + 2]!];
}

/** And its quaternion x, y, z, w. */
export function rotationOf(joints: Float32Array, joint: XRHandJoint): [number, number, number, number] {
  const at = kPerJoint * kJoints.indexOf(joint) + 3;
  return [joints[at]!, joints[at + 1]!, joints[at + 2]!, joints[at + 3]!];
}

/** And how far its skin is, m. */
export function radiusOf(joints: Float32Array, joint: XRHandJoint): number {
  return joints[kPerJoint * kJoints.indexOf(joint) + 7]!;
}

/** The distal joint and the tip of a finger of the wire. */
export function endsOf(finger: FollowedFinger["finger"]): { distal: XRHandJoint; tip: XRHandJoint } {
  const name = finger === "thumb" ? "thumb" : (`${finger}-finger` as const);
  return { distal: `${name}-phalanx-distal`, tip: `${name}-tip` };
}
