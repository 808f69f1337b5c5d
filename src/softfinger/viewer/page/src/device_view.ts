import {
  BoxGeometry, CylinderGeometry, Group, Mesh, MeshStandardMaterial, Object3D,
  Quaternion, SphereGeometry, TorusGeometry, Vector3,
} from "three";
import { place } from "./finger_view";
import { palette } from "./palette";
import type { FingerDescription, FingerSnapshot } from "./wire";

const kDiskThickness = 1.2; // mm

/** A device with legs or a disk about the finger, in F: base, legs, moving disk. Others are not drawn. */
export class DeviceView {
  readonly group = new Group();
  private readonly platform = new Group();
  private readonly base = new Group();
  private readonly legs: Leg[] = [];
  private built = false;

  constructor(private readonly description: FingerDescription) {
    this.group.visible = false;
    this.group.add(this.platform, this.base);
    for (let i = 0; i < description.legs; ++i) {
      const leg = new Leg();
      this.legs.push(leg);
      this.group.add(leg.group);
    }
  }

  update(snapshot: FingerSnapshot): void {
    if (!snapshot.linkage_mm.every(Number.isFinite)) return;
    const points = linkagePoints(snapshot.linkage_mm);
    const nothing = this.legs.length === 0 && this.description.disk_radius_mm === 0;
    if (points.length < 3 * this.legs.length || nothing) {
      this.group.visible = false;
      return;
    }
    place(this.platform, snapshot.X_FP);
    if (!this.built) {
      this.build(points);
      this.built = true;
    }
    this.legs.forEach((leg, i) => leg.update(points[3 * i]!, points[3 * i + 1]!, points[3 * i + 2]!));
    this.group.visible = true;
  }

  /** The parts whose shape follows from where the joints are. */
  private build(points: Vector3[]): void {
    const bases = this.legs.map((_, i) => points[3 * i]!);
    this.platform.updateMatrixWorld(true);
    const inverse = this.platform.matrix.clone().invert();
    const ends = this.legs.map((_, i) => points[3 * i + 2]!.clone().applyMatrix4(inverse));
    this.buildPlatform(ends);
    if (bases.length > 0) this.buildBase(bases);
  }

  private buildPlatform(ends: Vector3[]): void {
    const radius = this.description.disk_radius_mm;
    const disk = new Mesh(
      new CylinderGeometry(radius, radius, kDiskThickness, 72).rotateX(Math.PI / 2),
      new MeshStandardMaterial({
        color: palette.device, roughness: 0.25, transparent: true, opacity: 0.3, depthWrite: false,
        emissive: palette.device, emissiveIntensity: 0.08,
      }));
    disk.position.z = -kDiskThickness / 2;
    disk.renderOrder = 3;
    const rim = new Mesh(new TorusGeometry(radius, 0.45, 12, 96), deviceMaterial());
    rim.position.z = -kDiskThickness / 2;
    this.platform.add(disk, rim);
    for (const end of ends) {
      const from = end.clone().setLength(radius).setZ(-kDiskThickness / 2);
      this.platform.add(rod(from, end, 0.6, deviceMaterial()), joint(end, 1.0));
    }
  }

  private buildBase(bases: Vector3[]): void {
    const centre = new Vector3();
    for (const point of bases) centre.addScaledVector(point, 1 / bases.length);
    const radius = centre.distanceTo(bases[0]!);
    const normal = new Vector3(0, 0, 1);
    if (bases.length >= 3) {
      normal.crossVectors(bases[1]!.clone().sub(bases[0]!), bases[2]!.clone().sub(bases[0]!));
      normal.normalize();
    }
    const frame = new Group();
    frame.position.copy(centre);
    frame.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    const plate = new Mesh(
      new CylinderGeometry(radius - 3.2, radius - 3.2, 1.6, 72).rotateX(Math.PI / 2),
      new MeshStandardMaterial({
        color: palette.servo, roughness: 0.5, transparent: true, opacity: 0.55, depthWrite: false,
      }));
    plate.renderOrder = 4;
    const ring = new Mesh(
      new TorusGeometry(radius - 3.2, 0.8, 16, 96),
      new MeshStandardMaterial({ color: palette.metal, roughness: 0.35, metalness: 0.7 }));
    frame.add(plate, ring);
    this.base.add(frame);
    this.addCushion(centre, normal);
    for (const point of bases) this.base.add(servo(point, centre, normal));
  }

  /** What holds the base on the nail: drawn from the plate down to the nail's highest point. */
  private addCushion(centre: Vector3, normal: Vector3): void {
    const { rigid_positions_mm: p, nail_triangles } = this.description;
    let height = Infinity;
    for (const i of nail_triangles) {
      const vertex = new Vector3(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
      height = Math.min(height, -normal.dot(vertex.sub(centre)));
    }
    if (!(height > 0.5 && height < 40)) return;
    const cushion = new Mesh(
      new CylinderGeometry(5.6, 4.2, height, 40).rotateX(Math.PI / 2),
      new MeshStandardMaterial({ color: palette.servo, roughness: 0.85 }));
    cushion.position.copy(centre).addScaledVector(normal, -height / 2);
    cushion.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    this.base.add(cushion);
  }
}

class Leg {
  readonly group = new Group();
  private readonly crank = bar(0.95, palette.metal, 0.75);
  private readonly coupler = bar(0.6, palette.metal, 0.75);
  private readonly knee = joint(new Vector3(), 1.15);

  constructor() {
    this.group.add(this.crank, this.coupler, this.knee);
  }
  update(base: Vector3, knee: Vector3, end: Vector3): void {
    stretch(this.crank, base, knee);
    stretch(this.coupler, knee, end);
    this.knee.position.copy(knee);
  }
}

function deviceMaterial(): MeshStandardMaterial {
  return new MeshStandardMaterial({ color: palette.device, roughness: 0.35, metalness: 0.25 });
}

function linkagePoints(flat: Float32Array): Vector3[] {
  return Array.from({ length: Math.floor(flat.length / 3) },
    (_, i) => new Vector3(flat[3 * i]!, flat[3 * i + 1]!, flat[3 * i + 2]!));
}

/** A rod of length one along z, to be stretched. */
function bar(radius: number, color: string, metalness: number): Mesh {
  return new Mesh(
    new CylinderGeometry(radius, radius, 1, 20).rotateX(Math.PI / 2),
    new MeshStandardMaterial({ color, roughness: 0.32, metalness }));
}

function stretch(node: Object3D, from: Vector3, to: Vector3): void {
  const along = to.clone().sub(from);
  node.position.copy(from).addScaledVector(along, 0.5);
  node.scale.z = Math.max(along.length(), 1e-3);
  node.quaternion.copy(
    new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), along.clone().normalize()));
}

function rod(from: Vector3, to: Vector3, radius: number, material: MeshStandardMaterial): Mesh {
  const mesh = bar(radius, palette.metal, 0.5);
  mesh.material = material;
  stretch(mesh, from, to);
  return mesh;
}

function joint(at: Vector3, radius: number): Mesh {
  const mesh = new Mesh(new SphereGeometry(radius, 24, 16), deviceMaterial());
  mesh.position.copy(at);
  return mesh;
}

/** Motor housing beside a base joint, its axis across the leg's plane. */
function servo(at: Vector3, centre: Vector3, normal: Vector3): Group {
  const out = at.clone().sub(centre).normalize();
  const axis = new Vector3().crossVectors(normal, out).normalize();
  const group = new Group();
  const body = new Mesh(
    new BoxGeometry(5.2, 7.5, 4.4),
    new MeshStandardMaterial({ color: palette.servo, roughness: 0.55, metalness: 0.1 }));
  const cap = new Mesh(
    new CylinderGeometry(1.9, 1.9, 8.6, 32),
    new MeshStandardMaterial({ color: palette.metal, roughness: 0.3, metalness: 0.8 }));
  group.add(body, cap);
  // Box axes: x outwards, y the motor's axis, z the base normal.
  const up = normal.clone();
  group.matrixAutoUpdate = false;
  group.matrix.makeBasis(out, axis, up).setPosition(at);
  return group;
}
