import { PerspectiveCamera, Quaternion, type Scene, Vector3, type WebGLRenderer } from "three";
import { kWorldInRoom } from "./placement";
import type { View } from "./stage";

const kNear = 0.02; // m
const kFar = 20;

/** Draws a view's scene into a headset: at true scale, up where up is, from where the wearer looks. */
export class Room {
  private readonly camera = new PerspectiveCamera(50, 1, kNear, kFar);

  constructor(private readonly renderer: WebGLRenderer, private readonly view: View) {}

  /** From now on the headset draws. Returns the space in which it tells where it is. */
  async open(session: XRSession): Promise<XRReferenceSpace> {
    this.renderer.xr.enabled = true;
    this.renderer.xr.setReferenceSpaceType("local");
    await this.renderer.xr.setSession(session);
    this.view.scene.scale.setScalar(1e-3);
    this.view.scene.quaternion.copy(kWorldInRoom);
    return this.renderer.xr.getReferenceSpace()!;
  }

  /** The space whose origin is the scene's. */
  lay(space: XRReferenceSpace): void {
    this.renderer.xr.setReferenceSpace(space);
  }

  close(): void {
    this.view.scene.scale.setScalar(1);
    this.view.scene.quaternion.copy(new Quaternion());
  }

  /** The hands, and before them the scene where it has its place: its skin and glass are clear. */
  draw(placed: boolean, hands: Scene): void {
    this.renderer.render(hands, this.camera);
    if (!placed) return;
    this.renderer.autoClear = false;
    this.renderer.render(this.view.scene, this.camera);
    this.renderer.autoClear = true;
  }

  /** In the world, mm. */
  eye(): Vector3 {
    return this.view.scene.worldToLocal(this.renderer.xr.getCamera().getWorldPosition(new Vector3()));
  }
}
