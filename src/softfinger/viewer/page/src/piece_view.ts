import {
  BoxGeometry, BufferGeometry, CylinderGeometry, DynamicDrawUsage, EdgesGeometry,
  Float32BufferAttribute, Group, InstancedMesh, LineBasicMaterial, LineSegments, type Material,
  Matrix4, Mesh, MeshStandardMaterial, Quaternion, SphereGeometry, TorusGeometry, Vector3,
} from "three";
import type { RigidShape } from "softfinger-client";
import { glass } from "./glass";
import { palette } from "./palette";
import { geometryOf } from "./shape_geometry";

const kFloats = 8; // of a piece on the wire: pose, radius of a ball
const kMany = 4; // cylinders from which on they stand in a tray

/** What a device touches the finger with: its solid, piece by piece, at poses of the wire. */
export interface PieceView {
  readonly group: Group;
  /** Reads the pieces from the wire's array, this view's from index `first` on. */
  update(pieces: Float32Array): void;
}

export function pieceViews(runs: { shape: RigidShape; count: number }[], capRadius: number): PieceView[] {
  let first = 0;
  return runs.map(({ shape, count }, i) => {
    const view = i === 0 && capRadius > 0
      ? new CapView(capRadius, first) : new AlikePieces(shape, count, first);
    first += count;
    return view;
  });
}

/** How far the shape's middle is from where links may take hold of it, mm. */
export function gripRadius(shape: RigidShape): number {
  return shape.kind === "sphere" || shape.kind === "cylinder" ? shape.radius_mm : 0;
}

/** Pieces of one shape. */
class AlikePieces implements PieceView {
  readonly group = new Group();
  private readonly meshes: InstancedMesh[] = [];
  private tray: Mesh | null = null;

  constructor(private readonly shape: RigidShape, private readonly count: number, private readonly first: number) {
    const many = count >= kMany;
    if (isDisk(shape)) {
      this.add(geometryOf(shape), glass({ color: palette.device, body: 0.2, rim: 0.3, grid: 0 }), 3);
      this.add(rimOf(shape), metalOf(palette.device), 0);
    } else {
      this.add(geometryOf(shape),
        glass({ color: palette.device, body: many ? 0.42 : 0.24, rim: 0.75, grid: many ? 0 : 2 }), 3);
      for (const edge of edgesOf(shape)) this.add(edge, metalOf(palette.device), 0);
    }
  }

  update(pieces: Float32Array): void {
    for (let k = 0; k < this.count; ++k) {
      const matrix = matrixAt(pieces, this.first + k);
      for (const mesh of this.meshes) mesh.setMatrixAt(k, matrix);
    }
    for (const mesh of this.meshes) mesh.instanceMatrix.needsUpdate = true;
    if (!this.tray && this.count >= kMany && this.shape.kind === "cylinder") {
      this.tray = trayOf(this.shape, pieces, this.first, this.count);
      this.group.add(this.tray);
    }
  }

  private add(geometry: BufferGeometry, material: Material, order: number): void {
    const mesh = new InstancedMesh(geometry, material, this.count);
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    mesh.frustumCulled = false; // its bounds change with every frame
    mesh.renderOrder = order;
    this.meshes.push(mesh);
    this.group.add(mesh);
  }
}

/** A membrane: the part of a ball above a ring. The ball grows and shrinks. */
class CapView implements PieceView {
  readonly group = new Group();
  private static readonly kRings = 14;
  private static readonly kSegments = 64;
  private readonly positions: Float32BufferAttribute;
  private readonly normals: Float32BufferAttribute;

  constructor(private readonly ring: number, private readonly first: number) {
    const vertices = (CapView.kRings + 1) * (CapView.kSegments + 1);
    const geometry = new BufferGeometry();
    this.positions = new Float32BufferAttribute(new Float32Array(3 * vertices), 3);
    this.normals = new Float32BufferAttribute(new Float32Array(3 * vertices), 3);
    geometry.setAttribute("position", this.positions);
    geometry.setAttribute("normal", this.normals);
    const row = CapView.kSegments + 1;
    const indices: number[] = [];
    for (let i = 0; i < CapView.kRings; ++i) {
      for (let j = 0; j < CapView.kSegments; ++j) {
        const at = i * row + j;
        indices.push(at, at + row, at + 1, at + 1, at + row, at + row + 1);
      }
    }
    geometry.setIndex(indices);
    const cap = new Mesh(geometry, glass({ color: palette.membrane, body: 0.32, rim: 0.5, grid: 2 }));
    cap.renderOrder = 4;
    cap.frustumCulled = false;
    this.group.add(cap);
  }

  update(pieces: Float32Array): void {
    const at = kFloats * this.first;
    const radius = Math.max(pieces[at + 7]!, this.ring);
    // The ring's plane, seen from the ball's centre.
    const plane = Math.sqrt(radius * radius - this.ring * this.ring);
    this.group.quaternion.set(pieces[at + 3]!, pieces[at + 4]!, pieces[at + 5]!, pieces[at + 6]!);
    this.group.position.set(pieces[at]!, pieces[at + 1]!, pieces[at + 2]!)
      .add(new Vector3(0, 0, plane).applyQuaternion(this.group.quaternion));
    let vertex = 0;
    for (let i = 0; i <= CapView.kRings; ++i) {
      const rho = this.ring * Math.sin((i / CapView.kRings) * (Math.PI / 2)); // closer at the rim
      const height = Math.sqrt(Math.max(0, radius * radius - rho * rho));
      // height - plane without the loss of digits of a nearly flat cap.
      const above = (this.ring * this.ring - rho * rho) / (height + plane || 1);
      for (let j = 0; j <= CapView.kSegments; ++j, ++vertex) {
        const angle = (2 * Math.PI * j) / CapView.kSegments;
        const [x, y] = [rho * Math.cos(angle), rho * Math.sin(angle)];
        this.positions.setXYZ(vertex, x, y, above);
        this.normals.setXYZ(vertex, x / radius, y / radius, height / radius);
      }
    }
    this.positions.needsUpdate = true;
    this.normals.needsUpdate = true;
  }
}

function matrixAt(pieces: Float32Array, index: number): Matrix4 {
  const p = pieces.subarray(kFloats * index, kFloats * (index + 1));
  return new Matrix4().compose(
    new Vector3(p[0], p[1], p[2]), new Quaternion(p[3], p[4], p[5], p[6]), new Vector3(1, 1, 1));
}

type Cylinder = Extract<RigidShape, { kind: "cylinder" }>;

function isDisk(shape: RigidShape): shape is Cylinder {
  return shape.kind === "cylinder" && shape.length_mm < shape.radius_mm;
}

/** The rim of a disk's face. */
function rimOf(disk: Cylinder): BufferGeometry {
  const tube = Math.min(0.45, disk.length_mm / 2);
  return new TorusGeometry(disk.radius_mm, tube, 12, 96).translate(0, 0, disk.length_mm / 2 - tube);
}

/** Lines that tell a clear body's form: both rims of a cylinder. */
function edgesOf(shape: RigidShape): BufferGeometry[] {
  if (shape.kind !== "cylinder") return [];
  const tube = Math.min(0.16, 0.16 * shape.radius_mm);
  const ring = () => new TorusGeometry(shape.radius_mm - tube, tube, 8, 48);
  const z = shape.length_mm / 2 - tube;
  return [ring().translate(0, 0, z), ring().translate(0, 0, -z)];
}

/** The block that many pins rise from, where the lowest have sunk as they are now. */
function trayOf(pin: Cylinder, pieces: Float32Array, first: number, count: number): Mesh {
  const frame = new Quaternion(...pieces.subarray(kFloats * first + 3, kFloats * first + 7));
  const back = frame.clone().invert();
  const low = new Vector3(Infinity, Infinity, Infinity);
  const high = new Vector3(-Infinity, -Infinity, -Infinity);
  for (let k = first; k < first + count; ++k) {
    const at = new Vector3().fromArray(pieces, kFloats * k).applyQuaternion(back);
    low.min(at);
    high.max(at);
  }
  const across = 2.4 * pin.radius_mm + 0.8;
  const size = new Vector3(high.x - low.x + 2 * across, high.y - low.y + 2 * across, 0.45 * pin.length_mm);
  const box = new BoxGeometry(size.x, size.y, size.z);
  const tray = new Mesh(box, glass({ color: palette.metal, body: 0.14, rim: 0.2, grid: 0 }));
  tray.renderOrder = 3;
  tray.add(new LineSegments(new EdgesGeometry(box), new LineBasicMaterial({ color: palette.metal })));
  tray.quaternion.copy(frame);
  tray.position.set((low.x + high.x) / 2, (low.y + high.y) / 2, low.z - 0.5 * pin.length_mm + 0.1 * size.z)
    .applyQuaternion(frame);
  return tray;
}

export function metalOf(color: string): MeshStandardMaterial {
  return new MeshStandardMaterial({ color, roughness: 0.35, metalness: 0.25 });
}

/** A rod of length one along z, to be stretched. */
export function bar(radius: number, color: string, metalness: number): Mesh {
  return new Mesh(
    new CylinderGeometry(radius, radius, 1, 20).rotateX(Math.PI / 2),
    new MeshStandardMaterial({ color, roughness: 0.32, metalness }));
}

export function stretch(node: Mesh, from: Vector3, to: Vector3): void {
  const along = to.clone().sub(from);
  const length = along.length();
  node.visible = length > 1e-3;
  if (!node.visible) return;
  node.position.copy(from).addScaledVector(along, 0.5);
  node.scale.z = length;
  node.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), along.divideScalar(length));
}

export function joint(at: Vector3, radius: number): Mesh {
  const mesh = new Mesh(new SphereGeometry(radius, 24, 16), metalOf(palette.device));
  mesh.position.copy(at);
  return mesh;
}
