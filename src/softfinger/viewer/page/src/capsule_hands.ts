import { BufferAttribute, BufferGeometry, type Material, Mesh, Vector3 } from "three";
import { positionOf, radiusOf, type SeenHand } from "./xr_hand";

const kAround = 16; // corners of a ring
const kRings = 6; // of each end
const kThinnest = 1e-3; // m
const kMostHands = 2;
const kFingers = ["index-finger", "middle-finger", "ring-finger", "pinky-finger"] as const;

/** A stretch of skin from one joint to another; `between`: halfway to the same stretch of another finger. */
interface Stretch {
  from: XRHandJoint;
  to: XRHandJoint;
  between?: { from: XRHandJoint; to: XRHandJoint };
}

function chain(...joints: string[]): Stretch[] {
  return joints.slice(1).map((to, i) => ({ from: joints[i] as XRHandJoint, to: to as XRHandJoint }));
}

/** All of a hand: its fingers, and the palm filled between them. */
const kStretches: Stretch[] = [
  ...chain("wrist", "thumb-metacarpal", "thumb-phalanx-proximal", "thumb-phalanx-distal", "thumb-tip"),
  ...kFingers.flatMap((finger) => chain("wrist", `${finger}-metacarpal`, `${finger}-phalanx-proximal`,
    `${finger}-phalanx-intermediate`, `${finger}-phalanx-distal`, `${finger}-tip`)),
  ...kFingers.slice(1).flatMap((finger, i): Stretch[] => {
    const [own] = chain(`${finger}-metacarpal`, `${finger}-phalanx-proximal`);
    const [next] = chain(`${kFingers[i]}-metacarpal`, `${kFingers[i]}-phalanx-proximal`);
    return [{ ...own!, between: next }];
  }),
  { ...chain("thumb-metacarpal", "thumb-phalanx-proximal")[0]!,
    between: chain("index-finger-metacarpal", "index-finger-phalanx-proximal")[0] },
];

/** Hands of stretched balls, as thick as the headset says that their joints are. */
export class CapsuleHands {
  readonly meshes: Mesh[];
  private readonly geometry = new BufferGeometry();
  private readonly positions: Float32Array;
  private readonly normals: Float32Array;
  private readonly perStretch = 2 * kRings * (kAround + 1);

  constructor(skin: Material[]) {
    const most = kMostHands * kStretches.length;
    this.positions = new Float32Array(3 * most * this.perStretch);
    this.normals = new Float32Array(3 * most * this.perStretch);
    this.geometry.setAttribute("position", new BufferAttribute(this.positions, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(this.normals, 3));
    this.geometry.setIndex(new BufferAttribute(this.indices(most), 1));
    this.meshes = skin.map((material) => new Mesh(this.geometry, material));
  }

  /** Poses as readJoints gives them; what lies between joints of `instead` is drawn by somebody else. */
  show(hands: SeenHand[]): void {
    let count = 0;
    for (const { joints, instead } of hands.slice(0, kMostHands)) {
      for (const stretch of kStretches) {
        if (instead.has(stretch.from) && instead.has(stretch.to)) continue;
        const [a, b] = [endOf(joints, stretch.from, stretch.between?.from), endOf(joints, stretch.to, stretch.between?.to)];
        // It ends where the finger that is drawn by somebody else begins.
        if (instead.has(stretch.to)) b.at.lerp(a.at, Math.min(b.radius / Math.max(a.at.distanceTo(b.at), 1e-6), 0.9));
        this.fill(count++ * this.perStretch, a, b);
      }
    }
    this.geometry.setDrawRange(0, count * kRingsIndices);
    for (const name of ["position", "normal"]) (this.geometry.getAttribute(name) as BufferAttribute).needsUpdate = true;
  }

  /** The skin of two balls and what is stretched between them. */
  private fill(first: number, a: End, b: End): void {
    const along = b.at.clone().sub(a.at);
    const length = along.length();
    if (length > 1e-6) along.divideScalar(length);
    else along.set(0, 0, 1);
    const side = new Vector3(Math.abs(along.x) < 0.8 ? 1 : 0, Math.abs(along.x) < 0.8 ? 0 : 1, 0).cross(along).normalize();
    const other = along.clone().cross(side);
    // Where the cone touches both balls: as far from the axis's direction as this.
    const slope = Math.min(Math.max((a.radius - b.radius) / Math.max(length, 1e-6), -0.98), 0.98);
    const touch = Math.acos(slope);
    let vertex = first;
    for (let ring = 0; ring < 2 * kRings; ++ring) {
      const near = ring < kRings;
      const share = (near ? ring : ring - kRings) / (kRings - 1);
      const angle = near ? Math.PI + (touch - Math.PI) * share : touch * (1 - share);
      const { at, radius } = near ? a : b;
      const [forward, outward] = [Math.cos(angle), Math.sin(angle)];
      for (let corner = 0; corner <= kAround; ++corner, ++vertex) {
        const turn = (2 * Math.PI * corner) / kAround;
        const [u, v] = [outward * Math.cos(turn), outward * Math.sin(turn)];
        for (const [c, axis] of (["x", "y", "z"] as const).entries()) {
          const normal = forward * along[axis] + u * side[axis] + v * other[axis];
          this.normals[3 * vertex + c] = normal;
          this.positions[3 * vertex + c] = at[axis] + radius * normal;
        }
      }
    }
  }

  private indices(stretches: number): Uint32Array {
    const indices = new Uint32Array(stretches * kRingsIndices);
    let out = 0;
    for (let k = 0; k < stretches; ++k) {
      for (let ring = 0; ring + 1 < 2 * kRings; ++ring) {
        for (let corner = 0; corner < kAround; ++corner) {
          const i = k * this.perStretch + ring * (kAround + 1) + corner;
          indices.set([i, i + 1, i + kAround + 1, i + 1, i + kAround + 2, i + kAround + 1], out);
          out += 6;
        }
      }
    }
    return indices;
  }
}

const kRingsIndices = 6 * kAround * (2 * kRings - 1); // of a stretch

interface End {
  at: Vector3;
  radius: number; // m
}

function endOf(joints: Float32Array, joint: XRHandJoint, other?: XRHandJoint): End {
  const at = new Vector3(...positionOf(joints, joint));
  const radius = Math.max(radiusOf(joints, joint), kThinnest);
  if (!other) return { at, radius };
  return {
    at: at.add(new Vector3(...positionOf(joints, other))).multiplyScalar(0.5),
    radius: 0.5 * (radius + Math.max(radiusOf(joints, other), kThinnest)),
  };
}
