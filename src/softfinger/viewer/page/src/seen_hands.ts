import { InstancedMesh, Matrix4, MeshBasicMaterial, Scene, SphereGeometry } from "three";
import { palette } from "./palette";
import { kJoints, positionOf, radiusOf } from "./xr_hand";

/** The joints of hands as a headset sees them, so that the wearer sees where they are. */
export class SeenHands {
  readonly scene = new Scene();
  private readonly joints: InstancedMesh;
  private readonly matrix = new Matrix4();

  constructor() {
    const material = new MeshBasicMaterial({ color: palette.skin, transparent: true, opacity: 0.3, depthWrite: false });
    this.joints = new InstancedMesh(new SphereGeometry(1, 12, 8), material, 2 * kJoints.length);
    this.joints.frustumCulled = false;
    this.scene.add(this.joints);
  }

  /** Poses as readJoints gives them; joints in `instead` are drawn by somebody else. */
  show(hands: { joints: Float32Array; instead: Set<XRHandJoint> }[]): void {
    let count = 0;
    for (const { joints, instead } of hands.slice(0, 2)) {
      for (const joint of kJoints) {
        if (instead.has(joint)) continue;
        const radius = Math.max(radiusOf(joints, joint), 1e-3);
        this.matrix.makeScale(radius, radius, radius).setPosition(...positionOf(joints, joint));
        this.joints.setMatrixAt(count++, this.matrix);
      }
    }
    this.joints.count = count;
    this.joints.instanceMatrix.needsUpdate = true;
  }
}
