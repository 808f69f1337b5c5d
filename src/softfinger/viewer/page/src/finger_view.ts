import {
  BackSide, BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, Group, InstancedMesh,
  Matrix4, Mesh, MeshPhysicalMaterial, MeshStandardMaterial, SphereGeometry, type Side,
} from "three";
import { palette } from "./palette";
import { SmoothSurface } from "./smooth_surface";
import type { FingerDescription, FingerSnapshot, PoseArray } from "./wire";

const kSampleRadius = 0.27; // mm
const kContactRadius = 0.4;

/** Skin, its samples, bone and nail of one finger, in its own frame F. */
export class FingerView {
  readonly group = new Group();
  private readonly surface: SmoothSurface;
  private readonly samples: InstancedMesh;
  private readonly count: number;
  private readonly glow: Float32Array;
  private readonly contactColor = new Color(palette.contact);
  private readonly freeColor = new Color(palette.free);
  private readonly matrix = new Matrix4();

  constructor(description: FingerDescription) {
    this.count = description.skin_positions_mm.length / 3;
    this.glow = new Float32Array(this.count);
    this.surface = new SmoothSurface(new Uint32Array(description.skin_triangles), this.count);
    // Far side first, then the near side: both show, in the right order.
    for (const [side, opacity, order] of [[BackSide, 0.5, 1], [FrontSide, 0.4, 2]] as const) {
      const skin = new Mesh(this.surface.geometry, skinMaterial(side, opacity));
      skin.renderOrder = order;
      this.group.add(skin);
    }

    const rigid = new BufferAttribute(new Float32Array(description.rigid_positions_mm), 3);
    const bone = new MeshStandardMaterial({ color: palette.bone, roughness: 0.75, side: DoubleSide });
    this.group.add(new Mesh(rigidGeometry(rigid, description.bone_triangles), bone));
    const nail = new MeshPhysicalMaterial({
      color: palette.nail, roughness: 0.28, clearcoat: 0.6, clearcoatRoughness: 0.25, side: DoubleSide,
    });
    this.group.add(new Mesh(rigidGeometry(rigid, description.nail_triangles), nail));

    const ball = new SphereGeometry(1, 14, 10);
    this.samples = new InstancedMesh(
      ball, new MeshStandardMaterial({ roughness: 0.45, toneMapped: false }), this.count);
    this.samples.frustumCulled = false;
    for (let i = 0; i < this.count; ++i) this.samples.setColorAt(i, this.freeColor);
    this.group.add(this.samples);
    this.fill(description.skin_positions_mm, new Uint8Array(this.count), null);
  }

  dispose(): void {
    this.surface.dispose();
    this.samples.dispose();
    this.group.traverse((node) => {
      if (node instanceof Mesh) node.geometry.dispose();
    });
  }

  update(snapshot: FingerSnapshot): void {
    if (snapshot.in_contact.length !== this.count) return;
    this.fill(snapshot.positions_mm, snapshot.in_contact, snapshot.pressures_kPa);
  }

  private fill(
    positions: ArrayLike<number>, inContact: Uint8Array, pressures: Float32Array | null,
  ): void {
    for (let i = 0; i < this.count; ++i) {
      const touching = inContact[i] !== 0;
      const radius = touching ? kContactRadius : kSampleRadius;
      this.matrix.makeScale(radius, radius, radius);
      this.matrix.setPosition(positions[3 * i]!, positions[3 * i + 1]!, positions[3 * i + 2]!);
      this.samples.setMatrixAt(i, this.matrix);
      this.samples.setColorAt(i, touching ? this.contactColor : this.freeColor);
      const pressure = pressures ? pressures[i]! : 0;
      this.glow[i] = touching ? 0.35 + 0.65 * (1 - Math.exp(-pressure / 8)) : 0;
    }
    this.samples.instanceMatrix.needsUpdate = true;
    if (this.samples.instanceColor) this.samples.instanceColor.needsUpdate = true;
    this.surface.update(positions, this.glow);
  }
}

/** Moves a group to a pose of the wire. */
export function place(group: Group, pose: PoseArray): void {
  group.position.set(pose[0]!, pose[1]!, pose[2]!);
  group.quaternion.set(pose[3]!, pose[4]!, pose[5]!, pose[6]!);
}

/** Translucent skin that flushes where it is pressed. */
function skinMaterial(side: Side, opacity: number): MeshPhysicalMaterial {
  const material = new MeshPhysicalMaterial({
    color: palette.skin, roughness: 0.62, sheen: 0.5, sheenRoughness: 0.6,
    sheenColor: new Color("#ff9a78"), transparent: true, opacity, depthWrite: false, side,
  });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nattribute float glow;\nvarying float vGlow;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvGlow = glow;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying float vGlow;")
      .replace(
        "#include <color_fragment>",
        `#include <color_fragment>
         float flush = smoothstep(0.0, 1.0, vGlow);
         diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.86, 0.16, 0.12), 0.65 * flush);
         float edge = 1.0 - abs(dot(normalize(vNormal), normalize(vViewPosition)));
         diffuseColor.a = clamp(diffuseColor.a + 0.5 * edge * edge, 0.0, 1.0);`,
      );
  };
  return material;
}

function rigidGeometry(positions: BufferAttribute, triangles: number[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", positions);
  geometry.setIndex(triangles);
  const indexed = geometry.clone(); // own normals, though positions are shared
  indexed.computeVertexNormals();
  return indexed;
}
