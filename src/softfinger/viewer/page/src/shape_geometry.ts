import {
  BoxGeometry, BufferGeometry, CylinderGeometry, Float32BufferAttribute, LatheGeometry, PlaneGeometry,
  SphereGeometry, Vector2, Vector3,
} from "three";
import { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
import type { RigidShape } from "softfinger-client";

/** A shape of the wire in its own frame. */
export function geometryOf(shape: RigidShape): BufferGeometry {
  switch (shape.kind) {
    case "plane":
      return new PlaneGeometry(240, 240);
    case "sphere":
      return new SphereGeometry(shape.radius_mm, 96, 64);
    case "box":
      return roundedBox(shape.size_mm, shape.edge_radius_mm);
    case "cylinder":
      return roundedCylinder(shape.radius_mm, shape.length_mm, shape.edge_radius_mm);
    case "mesh":
      return triangles(shape.positions_mm, shape.triangles);
  }
}

/** Edges sharper than 30 degrees are drawn sharp. */
function triangles(positions: number[], indices: number[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
  geometry.setIndex(indices);
  const creased = toCreasedNormals(geometry, Math.PI / 6);
  geometry.dispose();
  return creased;
}

/** A finely divided cube pushed onto the rounded box. */
function roundedBox(size: [number, number, number], edge: number): BufferGeometry {
  const segments = 24;
  const geometry = new BoxGeometry(2, 2, 2, segments, segments, segments);
  const position = geometry.getAttribute("position");
  const normal = geometry.getAttribute("normal");
  const inner = size.map((s) => s / 2 - edge);
  const point = new Vector3();
  const core = new Vector3();
  const out = new Vector3();
  for (let i = 0; i < position.count; ++i) {
    point.fromBufferAttribute(position, i);
    // The outer third of each face bends round the edge, the rest stays flat.
    const bend = (t: number) => Math.sign(t) * Math.max(0, Math.abs(t) - 2 / 3) * 3;
    const flat = (t: number) => Math.max(-1, Math.min(1, t * 1.5));
    core.set(flat(point.x) * inner[0]!, flat(point.y) * inner[1]!, flat(point.z) * inner[2]!);
    out.set(bend(point.x), bend(point.y), bend(point.z)).normalize();
    position.setXYZ(i, core.x + edge * out.x, core.y + edge * out.y, core.z + edge * out.z);
    if (edge > 0) normal.setXYZ(i, out.x, out.y, out.z);
  }
  return geometry;
}

function roundedCylinder(radius: number, length: number, edge: number): BufferGeometry {
  if (edge <= 0) return new CylinderGeometry(radius, radius, length, 96).rotateX(Math.PI / 2);
  const profile = [new Vector2(0, -length / 2)];
  for (const side of [-1, 1]) {
    for (let k = 0; k <= 10; ++k) {
      const angle = ((side < 0 ? k - 10 : k) / 10) * (Math.PI / 2);
      profile.push(new Vector2(
        radius - edge + edge * Math.cos(angle), side * (length / 2 - edge) + edge * Math.sin(angle)));
    }
  }
  profile.push(new Vector2(0, length / 2));
  return new LatheGeometry(profile, 96).rotateX(Math.PI / 2);
}
