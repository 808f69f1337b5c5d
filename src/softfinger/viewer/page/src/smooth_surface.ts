import { BufferAttribute, BufferGeometry } from "three";

/**
 * A closed-looking skin from few vertices: curved point-normal triangles (Vlachos et al. 2001) through
 * the samples, so that each sample stays on the drawn surface. Refilled from new positions each frame.
 */
export class SmoothSurface {
  readonly geometry = new BufferGeometry();
  private readonly level: number;
  private readonly normals: Float32Array;
  private readonly weights: { b: number[]; n: number[] }[] = [];
  private readonly positionOut: Float32Array;
  private readonly normalOut: Float32Array;
  private readonly glowOut: Float32Array;

  constructor(private readonly triangles: Uint32Array, samples: number) {
    const count = triangles.length / 3;
    this.level = count < 600 ? 5 : count < 2000 ? 3 : 1;
    this.normals = new Float32Array(3 * samples);
    for (let i = 0; i <= this.level; ++i) {
      for (let j = 0; j <= this.level - i; ++j) this.addPoint(i / this.level, j / this.level);
    }
    const vertices = count * this.weights.length;
    this.positionOut = new Float32Array(3 * vertices);
    this.normalOut = new Float32Array(3 * vertices);
    this.glowOut = new Float32Array(vertices);
    this.geometry.setAttribute("position", new BufferAttribute(this.positionOut, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(this.normalOut, 3));
    this.geometry.setAttribute("glow", new BufferAttribute(this.glowOut, 1));
    this.geometry.setIndex(new BufferAttribute(this.makeIndices(count), 1));
  }

  dispose(): void {
    this.geometry.dispose();
  }

  /** positions: flat, one point a sample. glow: 0..1 a sample, interpolated for the shader. */
  update(positions: ArrayLike<number>, glow: ArrayLike<number>): void {
    this.computeNormals(positions);
    const { triangles, normals, weights, positionOut, normalOut, glowOut } = this;
    const control = new Float64Array(30);
    const normalControl = new Float64Array(18);
    let out = 0;
    for (let t = 0; t < triangles.length; t += 3) {
      const corners = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!];
      fillControl(positions, normals, corners, control, normalControl);
      const g0 = glow[corners[0]!]!, g1 = glow[corners[1]!]!, g2 = glow[corners[2]!]!;
      for (const { b, n } of weights) {
        for (let c = 0; c < 3; ++c) {
          let p = 0;
          for (let k = 0; k < 10; ++k) p += b[k]! * control[3 * k + c]!;
          let q = 0;
          for (let k = 0; k < 6; ++k) q += n[k]! * normalControl[3 * k + c]!;
          positionOut[3 * out + c] = p;
          normalOut[3 * out + c] = q;
        }
        // n[0..2] are squares of the barycentric coordinates.
        glowOut[out] = Math.sqrt(n[0]!) * g0 + Math.sqrt(n[1]!) * g1 + Math.sqrt(n[2]!) * g2;
        ++out;
      }
    }
    for (const name of ["position", "normal", "glow"]) {
      (this.geometry.getAttribute(name) as BufferAttribute).needsUpdate = true;
    }
  }

  /** Bernstein weights at barycentric (1 - u - v, u, v): ten for positions, six for normals. */
  private addPoint(u: number, v: number): void {
    const w = 1 - u - v;
    this.weights.push({
      b: [w * w * w, u * u * u, v * v * v, 3 * w * w * u, 3 * w * u * u, 3 * u * u * v,
          3 * u * v * v, 3 * v * v * w, 3 * v * w * w, 6 * w * u * v],
      n: [w * w, u * u, v * v, 2 * w * u, 2 * u * v, 2 * v * w],
    });
  }

  private makeIndices(count: number): Uint32Array {
    const { level } = this;
    const perTriangle = this.weights.length;
    // Row i (parameter u) holds level - i + 1 points (parameter v).
    const at = (i: number, j: number) => i * (level + 1) - (i * (i - 1)) / 2 + j;
    const pattern: number[] = [];
    for (let i = 0; i < level; ++i) {
      for (let j = 0; j < level - i; ++j) {
        pattern.push(at(i, j), at(i + 1, j), at(i, j + 1));
        if (j < level - i - 1) pattern.push(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
    const indices = new Uint32Array(count * pattern.length);
    for (let t = 0; t < count; ++t) {
      pattern.forEach((p, k) => (indices[t * pattern.length + k] = t * perTriangle + p));
    }
    return indices;
  }

  private computeNormals(p: ArrayLike<number>): void {
    const { triangles, normals } = this;
    normals.fill(0);
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t]!, b = 3 * triangles[t + 1]!, c = 3 * triangles[t + 2]!;
      const ux = p[b]! - p[a]!, uy = p[b + 1]! - p[a + 1]!, uz = p[b + 2]! - p[a + 2]!;
      const vx = p[c]! - p[a]!, vy = p[c + 1]! - p[a + 1]!, vz = p[c + 2]! - p[a + 2]!;
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (const i of [a, b, c]) {
        normals[i]! += nx;
        normals[i + 1]! += ny;
        normals[i + 2]! += nz;
      }
    }
    for (let i = 0; i < normals.length; i += 3) {
      const length = Math.hypot(normals[i]!, normals[i + 1]!, normals[i + 2]!) || 1;
      normals[i]! /= length;
      normals[i + 1]! /= length;
      normals[i + 2]! /= length;
    }
  }
}

/** Control points of one curved triangle: ten of the cubic, six of the quadratic normal. */
function fillControl(
  p: ArrayLike<number>, n: Float32Array, corners: number[], control: Float64Array,
  normalControl: Float64Array,
): void {
  const centre = [0, 0, 0];
  for (let k = 0; k < 3; ++k) {
    const i = 3 * corners[k]!, j = 3 * corners[(k + 1) % 3]!;
    const dx = p[j]! - p[i]!, dy = p[j + 1]! - p[i + 1]!, dz = p[j + 2]! - p[i + 2]!;
    const alongI = dx * n[i]! + dy * n[i + 1]! + dz * n[i + 2]!;
    const alongJ = -(dx * n[j]! + dy * n[j + 1]! + dz * n[j + 2]!);
    const squared = dx * dx + dy * dy + dz * dz || 1;
    const sum = dx * (n[i]! + n[j]!) + dy * (n[i + 1]! + n[j + 1]!) + dz * (n[i + 2]! + n[j + 2]!);
    const d = [dx, dy, dz];
    const middle = [0, 0, 0];
    for (let c = 0; c < 3; ++c) {
      control[3 * k + c] = p[i + c]!;
      normalControl[3 * k + c] = n[i + c]!;
      const nearI = (2 * p[i + c]! + p[j + c]! - alongI * n[i + c]!) / 3;
      const nearJ = (2 * p[j + c]! + p[i + c]! - alongJ * n[j + c]!) / 3;
      control[9 + 6 * k + c] = nearI;
      control[12 + 6 * k + c] = nearJ;
      centre[c]! += (nearI + nearJ) / 4 - p[i + c]! / 6;
      middle[c] = n[i + c]! + n[j + c]! - (2 * sum * d[c]!) / squared;
    }
    const length = Math.hypot(middle[0]!, middle[1]!, middle[2]!) || 1;
    for (let c = 0; c < 3; ++c) normalControl[9 + 3 * k + c] = middle[c]! / length;
  }
  for (let c = 0; c < 3; ++c) control[27 + c] = centre[c]!;
}
