// Where a scene lies in the room that a headset sees.
import { Matrix4, Quaternion, Vector3 } from "three";
import type { FollowedFinger } from "softfinger-client";
import { endsOf, positionOf, rotationOf } from "./xr_hand";

/** The world's axes (z up) in a y-up frame: x_W = -z, y_W = -x, z_W = y. */
export const kWorldInRoom = new Quaternion().setFromRotationMatrix(
  new Matrix4().makeBasis(new Vector3(0, 0, -1), new Vector3(-1, 0, 0), new Vector3(0, 1, 0)));

const kUp = new Vector3(0, 1, 0);
const kLevel = 0.5; // how much of an axis has to be horizontal to tell a heading

/** A finger in a y-up frame: the middle of its distal phalanx (m), x_F and y_F. */
interface Finger {
  middle: Vector3;
  distal: Vector3;
  left: Vector3;
}

function fingerOfJoints(joints: Float32Array, finger: FollowedFinger["finger"]): Finger {
  const { distal, tip } = endsOf(finger);
  const at = (joint: XRHandJoint) => new Vector3(...positionOf(joints, joint));
  const rotation = new Quaternion(...rotationOf(joints, distal));
  return {
    middle: at(distal).add(at(tip)).multiplyScalar(0.5),
    distal: new Vector3(0, 0, -1).applyQuaternion(rotation),
    left: new Vector3(-1, 0, 0).applyQuaternion(rotation),
  };
}

/** Of a pose X_WFt of the wire. */
function fingerOfPose(pose: number[]): Finger {
  const rotation = new Quaternion(pose[3]!, pose[4]!, pose[5]!, pose[6]!);
  const seen = (v: Vector3) => v.applyQuaternion(kWorldInRoom);
  return {
    middle: seen(new Vector3(pose[0]!, pose[1]!, pose[2]!)).multiplyScalar(1e-3),
    distal: seen(new Vector3(1, 0, 0).applyQuaternion(rotation)),
    left: seen(new Vector3(0, 1, 0).applyQuaternion(rotation)),
  };
}

const heading = (v: Vector3) => Math.atan2(v.x, v.z); // rad, about y

function transform(position: Vector3, turn: number): XRRigidTransform {
  const q = new Quaternion().setFromAxisAngle(kUp, turn);
  return new XRRigidTransform(
    { x: position.x, y: position.y, z: position.z }, { x: q.x, y: q.y, z: q.z, w: q.w });
}

/**
 * The scene's origin in the room such that a finger seen there is where the scene starts it: in
 * position, and in heading about the vertical. Up stays up.
 */
export function placeByFinger(joints: Float32Array, followed: FollowedFinger): XRRigidTransform {
  const seen = fingerOfJoints(joints, followed.finger);
  const wanted = fingerOfPose(followed.start);
  const level = Math.hypot(wanted.distal.x, wanted.distal.z) >= kLevel;
  const turn = level ? heading(seen.distal) - heading(wanted.distal) : heading(seen.left) - heading(wanted.left);
  return transform(seen.middle.clone().sub(wanted.middle.clone().applyAxisAngle(kUp, turn)), turn);
}

/** Where nobody's finger is tracked: before the eyes and below them. */
export function placeByEyes(eyes: XRRigidTransform): XRRigidTransform {
  const { position: p, orientation: q } = eyes;
  const turn = heading(new Vector3(0, 0, 1).applyQuaternion(new Quaternion(q.x, q.y, q.z, q.w)));
  const ahead = new Vector3(0, -0.15, -0.35).applyAxisAngle(kUp, turn);
  return transform(ahead.add(new Vector3(p.x, p.y, p.z)), turn);
}
