import {
  BoxGeometry, CylinderGeometry, Group, Mesh, MeshStandardMaterial, TorusGeometry, Vector3,
} from "three";
import type { FingerDescription, FingerSnapshot } from "softfinger-client";
import { place } from "./finger_view";
import { palette } from "./palette";
import { bar, gripRadius, joint, metalOf, type PieceView, pieceViews, stretch } from "./piece_view";

const kJointSize = 4; // mm; motors stick out around their joints
const kFinger = { length: 13, depth: 8.5 }; // mm from its middle; what a picture has to show anyway
const kBorder = 3; // mm to leave free above and below
const kNearest = 66; // mm; from where a finger alone is seen best

/**
 * A device of any kind about the finger, in F: the pieces of its solid, which touch, and, where it has
 * links or cables, these and the base that carries them.
 */
export class DeviceView {
  readonly group = new Group();
  private readonly pieces: PieceView[];
  private readonly grip = new Group(); // moves with the first piece
  private readonly legs: Leg[];
  private built = false;
  private reach: Vector3[] = []; // where pieces and joints were when they were built

  constructor(private readonly description: FingerDescription) {
    this.group.visible = false;
    this.pieces = pieceViews(description.pieces, description.cap_radius_mm);
    this.legs = Array.from({ length: description.legs }, () => new Leg(description.cables));
    this.group.add(...this.pieces.map((view) => view.group), this.grip,
      ...this.legs.map((leg) => leg.group));
  }

  update(snapshot: FingerSnapshot): void {
    if (!snapshot.linkage_mm.every(Number.isFinite) || !snapshot.pieces.every(Number.isFinite)) return;
    const points = pointsOf(snapshot.linkage_mm);
    if (points.length < 3 * this.legs.length || snapshot.pieces.length === 0) return;
    for (const view of this.pieces) view.update(snapshot.pieces);
    place(this.grip, snapshot.pieces.subarray(0, 7));
    if (!this.built) {
      this.build(points);
      this.reach = [...points, ...placesOf(snapshot.pieces)];
      this.built = true;
    }
    this.legs.forEach((leg, i) => leg.update(points[3 * i]!, points[3 * i + 1]!, points[3 * i + 2]!));
    this.group.visible = true;
  }

  /** Middle of finger, device and links, and the distance they are seen from; once they are there. */
  surroundings(): { middle: Vector3; distance: number } | null {
    if (!this.built) return null;
    const low = Math.min(-kFinger.depth, ...this.reach.map((point) => point.z));
    const high = Math.max(kFinger.depth, ...this.reach.map((point) => point.z));
    const around = Math.max(kFinger.length, ...this.reach.map((p) => Math.hypot(p.x, p.y) + kJointSize));
    // Seen from about 27 degrees below, through a window of 30 degrees.
    const height = 0.89 * (high - low) / 2 + 0.45 * around;
    return {
      middle: new Vector3(0.5, 0, (low + high) / 2),
      distance: Math.max(kNearest, 0.92 * (height + kBorder) / Math.tan(Math.PI / 12)),
    };
  }

  /** The parts whose shape follows from where the joints are. */
  private build(points: Vector3[]): void {
    // A leg that begins where the one before ends is its continuation.
    const bases = this.legs.map((_, i) => points[3 * i]!)
      .filter((base, i) => i === 0 || base.distanceTo(points[3 * i - 1]!) > 1e-3);
    this.grip.updateMatrixWorld(true);
    const toGrip = this.grip.matrix.clone().invert();
    this.holdPlatform(this.legs.map((_, i) => points[3 * i + 2]!.clone().applyMatrix4(toGrip)));
    if (bases.length > 0) this.group.add(this.base(bases));
  }

  /** What joins a platform's joints to the piece that touches. */
  private holdPlatform(ends: Vector3[]): void {
    const shape = this.description.pieces[0]!.shape;
    const radius = gripRadius(shape);
    if (radius === 0 || ends.length < 3) return;
    for (const end of ends) {
      const from = shape.kind === "cylinder" ? new Vector3(end.x, end.y, 0) : end.clone();
      if (from.length() < radius + 0.2) continue;
      const rod = bar(0.6, palette.metal, 0.5);
      rod.material = metalOf(palette.device);
      stretch(rod, from.setLength(radius), end);
      this.grip.add(rod, joint(end, 1.0));
    }
  }

  private base(bases: Vector3[]): Group {
    const centre = new Vector3();
    for (const point of bases) centre.addScaledVector(point, 1 / bases.length);
    const normal = new Vector3(0, 0, 1);
    if (bases.length >= 3) {
      normal.crossVectors(bases[1]!.clone().sub(bases[0]!), bases[2]!.clone().sub(bases[0]!));
      normal.normalize();
      if (normal.z < 0) normal.negate(); // out of the nail, whichever way round the legs are
    }
    const group = new Group();
    const radius = centre.distanceTo(bases[0]!) - 3.2;
    const cushion = this.cushion(centre, normal);
    if (radius > 1) {
      const ring = new Mesh(
        new TorusGeometry(radius, 0.8, 16, 96),
        new MeshStandardMaterial({ color: palette.metal, roughness: 0.35, metalness: 0.7 }));
      ring.position.copy(centre);
      ring.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
      group.add(ring);
      if (cushion) {
        const plate = new Mesh(
          new CylinderGeometry(radius, radius, 1.6, 72).rotateX(Math.PI / 2),
          new MeshStandardMaterial({
            color: palette.servo, roughness: 0.5, transparent: true, opacity: 0.55, depthWrite: false,
          }));
        plate.renderOrder = 4;
        ring.add(plate);
      }
    }
    if (cushion) group.add(cushion);
    for (const point of bases) group.add(servo(point, centre, normal));
    return group;
  }

  /** What holds the base on the nail, down to its highest point; null for a base on the pad's side. */
  private cushion(centre: Vector3, normal: Vector3): Mesh | null {
    const { rigid_positions_mm: p, nail_triangles } = this.description;
    let height = Infinity;
    for (const i of nail_triangles) {
      const vertex = new Vector3(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
      height = Math.min(height, -normal.dot(vertex.sub(centre)));
    }
    if (!(height > 0.5 && height < 40)) return null;
    const cushion = new Mesh(
      new CylinderGeometry(5.6, 4.2, height, 40).rotateX(Math.PI / 2),
      new MeshStandardMaterial({ color: palette.servo, roughness: 0.85 }));
    cushion.position.copy(centre).addScaledVector(normal, -height / 2);
    cushion.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    return cushion;
  }
}

/** Two links with a knee, or a cable. */
class Leg {
  readonly group = new Group();
  private readonly first: Mesh;
  private readonly second: Mesh;
  private readonly knee = joint(new Vector3(), 1.15);

  constructor(cable: boolean) {
    this.first = cable ? bar(0.22, palette.cable, 0.1) : bar(0.95, palette.metal, 0.75);
    this.second = cable ? bar(0.22, palette.cable, 0.1) : bar(0.6, palette.metal, 0.75);
    this.group.add(this.first, this.second);
    if (!cable) this.group.add(this.knee);
  }
  update(base: Vector3, knee: Vector3, end: Vector3): void {
    stretch(this.first, base, knee);
    stretch(this.second, knee, end);
    this.knee.position.copy(knee);
  }
}

/** Of pieces smaller than a finger; a flat membrane's ball is not. */
function placesOf(pieces: Float32Array): Vector3[] {
  return Array.from({ length: pieces.length / 8 }, (_, k) => new Vector3().fromArray(pieces, 8 * k))
    .filter((_, k) => pieces[8 * k + 7]! < kFinger.length);
}

function pointsOf(flat: Float32Array): Vector3[] {
  return Array.from({ length: Math.floor(flat.length / 3) },
    (_, i) => new Vector3(flat[3 * i]!, flat[3 * i + 1]!, flat[3 * i + 2]!));
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
  group.matrixAutoUpdate = false;
  group.matrix.makeBasis(out, axis, normal.clone()).setPosition(at);
  return group;
}
