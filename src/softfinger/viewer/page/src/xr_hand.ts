// A hand as WebXR gives it.
import type { Quaternion, Vector3 } from "three";
import { type FollowedFinger, kHandJoints } from "softfinger-client";

export type Side = FollowedFinger["hand"];

/** Joints as readJoints gives them; what lies between those of `instead` is drawn by somebody else. */
export interface SeenHand {
  side: Side;
  joints: Float32Array;
  instead: Set<XRHandJoint>;
}

export const kJoints = kHandJoints as readonly XRHandJoint[];

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

/** A joint's position of what readJoints gives, m. */
export function positionOf(joints: Float32Array, joint: XRHandJoint): [number, number, number] {
  const at = kPerJoint * kJoints.indexOf(joint);
  return [joints[at]!, joints[at + 1]!, joints[at + 2]!];
}

/** Puts it there. */
export function setPose(joints: Float32Array, joint: XRHandJoint, at: Vector3, turned: Quaternion): void {
  joints.set([at.x, at.y, at.z, turned.x, turned.y, turned.z, turned.w], kPerJoint * kJoints.indexOf(joint));
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
