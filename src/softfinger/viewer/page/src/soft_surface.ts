import { BufferAttribute, BufferGeometry } from "three";

const kCrease = Math.cos(Math.PI / 6); // edges sharper than that at rest stay sharp

/**
 * The surface of something soft, refilled from new positions each frame. Attributes `rest` and `restNormal` say
 * where each vertex was, so that what is drawn on it goes with it.
 */
export class SoftSurface {
  readonly geometry = new BufferGeometry();
  private readonly positions: Float32Array;
  private readonly normals: Float32Array;
  private readonly faces: Float32Array; // normal of each triangle, as long as its area is large
  private readonly smoothed: number[][]; // of each corner, the triangles whose normals it has

  constructor(restPositions: ArrayLike<number>, private readonly triangles: ArrayLike<number>) {
    const corners = triangles.length;
    this.positions = new Float32Array(3 * corners);
    this.normals = new Float32Array(3 * corners);
    this.faces = new Float32Array(corners);
    this.fillFaces(restPositions);
    this.smoothed = this.findSmoothed();
    this.geometry.setAttribute("position", new BufferAttribute(this.positions, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(this.normals, 3));
    this.update(restPositions);
    this.geometry.setAttribute("rest", new BufferAttribute(this.positions.slice(), 3));
    this.geometry.setAttribute("restNormal", new BufferAttribute(this.normals.slice(), 3));
  }

  dispose(): void {
    this.geometry.dispose();
  }

  /** positions: flat, one point each as at rest. */
  update(positions: ArrayLike<number>): void {
    this.fillFaces(positions);
    const { triangles, faces, normals } = this;
    for (let corner = 0; corner < triangles.length; ++corner) {
      let x = 0, y = 0, z = 0;
      for (const face of this.smoothed[corner]!) {
        x += faces[3 * face]!;
        y += faces[3 * face + 1]!;
        z += faces[3 * face + 2]!;
      }
      const length = Math.hypot(x, y, z) || 1;
      normals.set([x / length, y / length, z / length], 3 * corner);
      for (let c = 0; c < 3; ++c) this.positions[3 * corner + c] = positions[3 * triangles[corner]! + c]!;
    }
    for (const name of ["position", "normal"]) {
      (this.geometry.getAttribute(name) as BufferAttribute).needsUpdate = true;
    }
  }

  private fillFaces(p: ArrayLike<number>): void {
    const { triangles, faces } = this;
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t]!, b = 3 * triangles[t + 1]!, c = 3 * triangles[t + 2]!;
      const ux = p[b]! - p[a]!, uy = p[b + 1]! - p[a + 1]!, uz = p[b + 2]! - p[a + 2]!;
      const vx = p[c]! - p[a]!, vy = p[c + 1]! - p[a + 1]!, vz = p[c + 2]! - p[a + 2]!;
      faces.set([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], t);
    }
  }

  private findSmoothed(): number[][] {
    const around = new Map<number, number[]>();
    for (let corner = 0; corner < this.triangles.length; ++corner) {
      const vertex = this.triangles[corner]!;
      if (!around.has(vertex)) around.set(vertex, []);
      around.get(vertex)!.push(Math.floor(corner / 3));
    }
    const face = (t: number) => [0, 1, 2].map((c) => this.faces[3 * t + c]!);
    const length = (v: number[]) => Math.hypot(...v) || 1;
    return Array.from({ length: this.triangles.length }, (_, corner) => {
      const own = face(Math.floor(corner / 3));
      return around.get(this.triangles[corner]!)!.filter((t) => {
        const other = face(t);
        const along = own.reduce((sum, value, c) => sum + value * other[c]!, 0);
        return along >= kCrease * length(own) * length(other);
      });
    });
  }
}
