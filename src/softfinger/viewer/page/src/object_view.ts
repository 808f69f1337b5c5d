import { Group, Mesh, type ShaderMaterial, Vector3 } from "three";
import type { SceneObject } from "softfinger-client";
import { glass } from "./glass";
import { palette } from "./palette";
import { geometryOf } from "./shape_geometry";
import { SoftSurface } from "./soft_surface";

const kPlaneReach = 62; // mm; farther away a plane has faded

/**
 * A virtual object as thin glass with a 5 mm grid, which deforms with it, so that the pad is seen through it; a bone of a
 * hand in the colour of skin.
 */
export class ObjectView {
  readonly group = new Group();
  private readonly material: ShaderMaterial;
  private readonly fades: boolean;
  private readonly soft: SoftSurface | null;

  constructor({ shape, hand }: SceneObject) {
    this.material = glass({
      ...(hand ? { color: palette.skin, body: 0.2, rim: 0.5, grid: 0 } : { color: palette.object, body: 0.07, rim: 0.42, grid: 5 }),
      reach: shape.kind === "plane" ? kPlaneReach : Infinity,
      deforms: shape.kind === "soft",
    });
    this.fades = shape.kind === "plane";
    this.soft = shape.kind === "soft" ? new SoftSurface(shape.positions_mm, shape.triangles) : null;
    const geometry = shape.kind === "soft" ? this.soft!.geometry : geometryOf(shape);
    const mesh = new Mesh(geometry, this.material);
    mesh.frustumCulled = this.soft === null; // its bounds change with every frame
    mesh.renderOrder = 3;
    this.group.add(mesh);
  }

  dispose(): void {
    this.material.dispose();
    (this.group.children[0] as Mesh).geometry.dispose();
  }

  /** Something soft: points of its surface as they stand, in its frame. */
  deform(positions_mm: ArrayLike<number>): void {
    this.soft?.update(positions_mm);
  }

  /** Where the object's grid fades around, in the world, mm: a finger, or fingers that far apart. */
  lookAround(centre: Vector3, spread = 0): void {
    if (this.fades) this.material.uniforms.reach!.value = kPlaneReach + 1.5 * spread;
    (this.material.uniforms.centre!.value as Vector3).copy(centre).sub(this.group.position)
      .applyQuaternion(this.group.quaternion.clone().invert());
  }
  /** Before or after the skin, whichever lies behind. */
  drawBehindSkin(behind: boolean): void {
    this.group.children[0]!.renderOrder = behind ? 0 : 3;
  }
}
