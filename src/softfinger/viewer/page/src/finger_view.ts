import {
  BackSide, BufferGeometry, DoubleSide, FrontSide, Group,
  InstancedBufferAttribute, InstancedMesh, Matrix4, Mesh, MeshStandardMaterial, Object3D, SphereGeometry,
  type Side, Vector3,
} from "three";
import type { FingerDescription, PoseArray, Skin } from "softfinger-client";
import { palette } from "./palette";
import { SmoothSurface } from "./smooth_surface";

/**
 * Skin, its samples, bone and nail of one finger, in its own frame F. Can be shown in several places
 * at once: all of them share the same geometry, filled once a frame.
 */
export class FingerView {
  private readonly surface: SmoothSurface;
  private readonly skin = [skinMaterial(BackSide, 0.55), skinMaterial(FrontSide, 0.42)];
  private readonly rigid: Mesh[];
  private readonly free: SampleCloud;
  private readonly touching: SampleCloud;
  private readonly count: number;
  private readonly glow: Float32Array;

  constructor(description: FingerDescription) {
    this.count = description.skin_positions_mm.length / 3;
    this.glow = new Float32Array(this.count);
    this.surface = new SmoothSurface(new Uint32Array(description.skin_triangles), this.count);
    this.free = new SampleCloud(this.count, palette.free, 0.27, false);
    this.touching = new SampleCloud(this.count, palette.contact, 0.42, true);
    const positions = new Float32Array(description.rigid_positions_mm);
    const bone = new MeshStandardMaterial({ color: palette.bone, roughness: 0.75, side: DoubleSide });
    const nail = new MeshStandardMaterial({ color: palette.nail, roughness: 0.25, side: DoubleSide });
    const cut = new MeshStandardMaterial({ color: palette.cut, roughness: 0.9, side: DoubleSide });
    this.rigid = [new Mesh(rounded(positions, description.nail_triangles), nail)];
    for (const part of connectedParts(description.bone_triangles)) {
      this.rigid.push(new Mesh(rounded(positions, part), isFlat(positions, part) ? cut : bone));
    }
    this.fill(description.skin_positions_mm, new Uint8Array(this.count), null);
  }

  /** A new group that shows this finger. */
  show(): Group {
    const group = new Group();
    // Far side first, then the near side: both show, in the right order.
    this.skin.forEach((material, side) => {
      const mesh = new Mesh(this.surface.geometry, material);
      mesh.renderOrder = 1 + side;
      mesh.frustumCulled = false; // its bounds change with every frame
      group.add(mesh);
    });
    for (const mesh of this.rigid) group.add(new Mesh(mesh.geometry, mesh.material));
    group.add(this.free.show(), this.touching.show());
    return group;
  }

  dispose(): void {
    this.surface.dispose();
    for (const mesh of this.rigid) mesh.geometry.dispose();
    for (const material of this.skin) material.dispose();
    this.free.dispose();
    this.touching.dispose();
  }

  update(skin: Skin): void {
    if (skin.in_contact.length !== this.count) return;
    if (!skin.positions_mm.every(Number.isFinite)) return; // nothing to draw: keep the last shape
    this.fill(skin.positions_mm, skin.in_contact, skin.pressures_kPa);
  }

  private fill(
    positions: ArrayLike<number>, inContact: Uint8Array, pressures: Float32Array | null,
  ): void {
    this.free.clear();
    this.touching.clear();
    for (let i = 0; i < this.count; ++i) {
      const touching = inContact[i] !== 0;
      (touching ? this.touching : this.free).add(
        positions[3 * i]!, positions[3 * i + 1]!, positions[3 * i + 2]!);
      this.glow[i] = touching ? 0.35 + 0.65 * (1 - Math.exp(-(pressures?.[i] ?? 0) / 8)) : 0;
    }
    this.free.finish();
    this.touching.finish();
    this.surface.update(positions, this.glow);
  }
}

/** Skin samples of one colour as small balls. */
class SampleCloud {
  private readonly meshes: InstancedMesh[] = [];
  private readonly matrices: InstancedBufferAttribute;
  private readonly ball = new SphereGeometry(1, 12, 8);
  private readonly material: MeshStandardMaterial;
  private readonly matrix = new Matrix4();
  private filled = 0;

  /** `onTop`: drawn after skin and glass, which then do not dim it. */
  constructor(count: number, color: string, radius: number, private readonly onTop: boolean) {
    this.matrices = new InstancedBufferAttribute(new Float32Array(16 * count), 16);
    this.matrix.makeScale(radius, radius, radius);
    this.material = new MeshStandardMaterial({
      color, emissive: color, emissiveIntensity: onTop ? 0.55 : 0.2, roughness: 0.5,
      toneMapped: false, transparent: onTop,
    });
  }
  show(): InstancedMesh {
    const mesh = new InstancedMesh(this.ball, this.material, this.matrices.count);
    mesh.instanceMatrix = this.matrices;
    mesh.count = this.filled;
    mesh.frustumCulled = false;
    if (this.onTop) mesh.renderOrder = 5;
    this.meshes.push(mesh);
    return mesh;
  }
  clear(): void {
    this.filled = 0;
  }
  add(x: number, y: number, z: number): void {
    this.matrix.setPosition(x, y, z);
    this.matrix.toArray(this.matrices.array as Float32Array, 16 * this.filled++);
  }
  finish(): void {
    this.matrices.needsUpdate = true;
    for (const mesh of this.meshes) mesh.count = this.filled;
  }
  dispose(): void {
    this.ball.dispose();
    this.material.dispose();
    for (const mesh of this.meshes) mesh.dispose();
  }
}

/** Moves a group to a pose of the wire. */
export function place(group: Object3D, pose: PoseArray): void {
  group.position.set(pose[0]!, pose[1]!, pose[2]!);
  group.quaternion.set(pose[3]!, pose[4]!, pose[5]!, pose[6]!);
}

/** Translucent skin that flushes where it is pressed. */
function skinMaterial(side: Side, opacity: number): MeshStandardMaterial {
  const material = new MeshStandardMaterial({
    color: palette.skin, roughness: 0.55, emissive: "#9a4630", emissiveIntensity: 0.32,
    transparent: true, opacity, depthWrite: false, side,
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

function rounded(positions: Float32Array, triangles: number[]): BufferGeometry {
  const surface = new SmoothSurface(new Uint32Array(triangles), positions.length / 3);
  surface.update(positions, new Float32Array(positions.length / 3));
  return surface.geometry;
}

/** Splits triangles into parts that share no vertex: the bone itself, and the finger's proximal cut. */
function connectedParts(triangles: number[]): number[][] {
  const leader = new Map<number, number>();
  const find = (i: number): number => {
    const next = leader.get(i) ?? i;
    return next === i ? i : find(next);
  };
  for (let t = 0; t < triangles.length; t += 3) {
    leader.set(find(triangles[t + 1]!), find(triangles[t]!));
    leader.set(find(triangles[t + 2]!), find(triangles[t]!));
  }
  const parts = new Map<number, number[]>();
  for (let t = 0; t < triangles.length; t += 3) {
    const root = find(triangles[t]!);
    if (!parts.has(root)) parts.set(root, []);
    parts.get(root)!.push(...triangles.slice(t, t + 3));
  }
  return [...parts.values()];
}

function isFlat(positions: Float32Array, triangles: number[]): boolean {
  const corner = (i: number) => new Vector3().fromArray(positions, 3 * triangles[i]!);
  const origin = corner(0);
  const normal = corner(1).sub(origin).cross(corner(2).sub(origin)).normalize();
  return triangles.every((_, i) => Math.abs(corner(i).sub(origin).dot(normal)) < 0.3);
}
