import {
  BoxGeometry, BufferGeometry, Color, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group,
  LatheGeometry, Mesh, PlaneGeometry, ShaderMaterial, SphereGeometry, Vector2, Vector3,
} from "three";
import { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
import { palette } from "./palette";
import type { Shape } from "./wire";

/** A virtual object as thin glass with a 5 mm grid, so that the pad is seen through it. */
export class ObjectView {
  readonly group = new Group();
  private readonly material: ShaderMaterial;

  constructor(shape: Shape) {
    this.material = glass(shape.kind === "plane");
    const mesh = new Mesh(geometryOf(shape), this.material);
    mesh.renderOrder = 3;
    this.group.add(mesh);
  }

  dispose(): void {
    this.material.dispose();
    (this.group.children[0] as Mesh).geometry.dispose();
  }

  /** Where the object's grid fades around: the finger, in the world. */
  lookAround(centre: Vector3): void {
    (this.material.uniforms.centre!.value as Vector3).copy(centre);
  }
  /** Before or after the skin, whichever lies behind. */
  drawBehindSkin(behind: boolean): void {
    this.group.children[0]!.renderOrder = behind ? 0 : 3;
  }
}

function geometryOf(shape: Shape): BufferGeometry {
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

function glass(endless: boolean): ShaderMaterial {
  return new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
    uniforms: {
      color: { value: new Color(palette.object) },
      centre: { value: new Vector3() },
      reach: { value: endless ? 62 : 1e6 },
    },
    vertexShader: /* glsl */ `
      varying vec3 vWorld;
      varying vec3 vLocal;
      varying vec3 vLocalNormal;
      varying vec3 vWorldNormal;
      void main() {
        vec4 world = modelMatrix * vec4(position, 1.0);
        vWorld = world.xyz;
        vLocal = position;
        vLocalNormal = normal;
        vWorldNormal = mat3(modelMatrix) * normal;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      uniform vec3 centre;
      uniform float reach;
      varying vec3 vWorld;
      varying vec3 vLocal;
      varying vec3 vLocalNormal;
      varying vec3 vWorldNormal;
      float lines(float x) {
        float at = abs(fract(x / 5.0 - 0.5) - 0.5) * 5.0;
        float width = fwidth(x);
        return (1.0 - smoothstep(0.0, 1.4 * width, at)) * clamp(0.6 / width, 0.0, 1.0);
      }
      void main() {
        vec3 toEye = normalize(cameraPosition - vWorld);
        vec3 n = normalize(vWorldNormal);
        if (dot(n, toEye) < 0.0) n = -n;
        float rim = pow(1.0 - dot(n, toEye), 2.5);
        float light = 0.75 + 0.25 * n.z;
        vec3 m = abs(normalize(vLocalNormal));
        float grid = max(max(lines(vLocal.x) * (1.0 - m.x), lines(vLocal.y) * (1.0 - m.y)),
                         lines(vLocal.z) * (1.0 - m.z));
        float fade = 1.0 - smoothstep(0.35 * reach, reach, distance(vWorld, centre));
        float alpha = (0.07 + 0.42 * rim + 0.16 * grid) * fade;
        gl_FragColor = vec4(color * (light + 0.5 * rim + 0.3 * grid), alpha);
        #include <colorspace_fragment>
      }`,
  });
}
