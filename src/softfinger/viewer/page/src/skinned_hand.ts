import { Bone, type Material, Matrix4, Quaternion, Skeleton, SkinnedMesh, Vector3 } from "three";
import left from "@webxr-input-profiles/assets/dist/profiles/generic-hand/left.glb?url";
import right from "@webxr-input-profiles/assets/dist/profiles/generic-hand/right.glb?url";
import { kJoints, positionOf, rotationOf, type SeenHand, type Side } from "./xr_hand";

const kModels: Record<Side, string> = { left, right };

/** A fingertip that somebody else draws shrinks to this share of itself: a stump, closed, inside that finger. */
const kStump = new Vector3(0.8, 0.8, 0.2);

/** What of the skin follows a joint. */
interface Link {
  joint: XRHandJoint;
  next: XRHandJoint | null; // where a bone of known length ends
  length: number; // m, of the model's own hand; 0 without `next`
  bone: Bone;
}

/** A model of a hand whose skin follows the joints, as large as the hand is. */
export class SkinnedHand {
  readonly meshes: SkinnedMesh[];
  private readonly links: Link[];

  private constructor({ geometry, skeleton }: SkinnedMesh, skin: Material[]) {
    const joints = skeleton.bones.map(({ name }) => name as XRHandJoint);
    const rest = new Map(joints.map((joint, i) =>
      [joint, new Vector3().setFromMatrixPosition(skeleton.boneInverses[i]!.clone().invert())]));
    if (!kJoints.every((joint) => rest.has(joint))) throw new Error("a hand without all joints");
    this.links = joints.map((joint) => {
      const next = nextOf(joint);
      return { joint, next, length: next ? rest.get(joint)!.distanceTo(rest.get(next)!) : 0, bone: new Bone() };
    });
    // Of no parent: every bone is where its joint is.
    const bones = new Skeleton(this.links.map(({ bone }) => bone), skeleton.boneInverses);
    this.meshes = skin.map((material) => {
      const mesh = new SkinnedMesh(geometry, material);
      mesh.bind(bones, new Matrix4());
      return mesh;
    });
  }

  static async load(side: Side, skin: Material[]): Promise<SkinnedHand> {
    const { GLTFLoader } = await import("three/addons/loaders/GLTFLoader.js");
    const { scene } = await new GLTFLoader().loadAsync(kModels[side]);
    const model = scene.getObjectByProperty("isSkinnedMesh", true) as SkinnedMesh | undefined;
    if (!model) throw new Error("no skin");
    return new SkinnedHand(model, skin);
  }

  /** Returns how many of its fingertips are stumps. */
  pose({ joints, instead }: SeenHand): number {
    const at = (joint: XRHandJoint) => new Vector3(...positionOf(joints, joint));
    const lengths = this.links.map(({ joint, next }) => (next ? at(joint).distanceTo(at(next)) : 0));
    const size = sum(lengths) / sum(this.links.map(({ length }) => length));
    let stumps = 0;
    this.links.forEach(({ joint, next, length, bone }, i) => {
      const scale = new Vector3(size, size, next ? lengths[i]! / length : size);
      if (instead.has(joint) && joint.endsWith("-phalanx-distal")) {
        scale.multiply(kStump);
        ++stumps;
      }
      bone.matrixWorld.compose(at(joint), new Quaternion(...rotationOf(joints, joint)), scale);
    });
    return stumps;
  }
}

/** The joint at the other end of a joint's bone. How deep in the flesh a tip lies, headsets differ about. */
function nextOf(joint: XRHandJoint): XRHandJoint | null {
  return /wrist|distal|tip/.test(joint) ? null : kJoints[kJoints.indexOf(joint) + 1]!;
}

function sum(numbers: number[]): number {
  return numbers.reduce((total, x) => total + x, 0);
}
