import { type Object3D, Plane, Quaternion, Raycaster, Vector2, Vector3 } from "three";
import type { Request, Scene } from "softfinger-client";
import type { ObjectView } from "./object_view";
import type { View } from "./stage";

const kInterval = 25; // ms between requests; the program takes no more than 50 a second
const kFarthest = 990; // mm from the origin, of a coordinate; the program takes no more than 1000

/** What the pointer has taken, and where: the plane that it is drawn along, and from its frame to the grip. */
interface Grip {
  pointer: number;
  name: string;
  plane: Plane;
  toGrip: Vector3; // mm, W
  position: Vector3; // X_WO wanted, mm
  rotation: Quaternion;
}

/** Takes objects that move by forces with the pointer, carries them along the picture, and lets them go. */
export class ObjectHold {
  private scene: Scene | null = null;
  private views: readonly ObjectView[] = [];
  private grip: Grip | null = null;
  private sinceSent = 0;

  constructor(private readonly view: View, private readonly send: (request: Request) => void) {
    // Before the view's own controls, which turn the picture; after the hand, which is nearer.
    view.pane.addEventListener("pointerdown", (event) => this.take(event), { capture: true });
    view.pane.addEventListener("pointermove", (event) => this.carry(event), { capture: true });
    for (const end of ["pointerup", "pointercancel"] as const) {
      view.pane.addEventListener(end, (event) => this.letGo(event), { capture: true });
    }
  }

  /** Whether the pointer has hold of one. */
  get holds(): boolean {
    return this.grip !== null;
  }

  /** `views` are those of the scene's objects. */
  begin(scene: Scene, views: readonly ObjectView[]): void {
    this.scene = scene;
    this.views = views;
    this.grip = null;
    this.showGrip();
    document.getElementById("object-hint")!.hidden = !scene.objects.some(({ holdable }) => holdable);
  }

  /** After `elapsed` ms: says again where it is held. */
  advance(elapsed: number): void {
    if (!this.grip) return;
    this.sinceSent += elapsed;
    if (this.sinceSent >= kInterval) this.say(this.grip);
  }

  private showGrip(): void {
    this.view.pane.style.cursor = this.grip ? "grabbing" : "";
    document.body.dataset.holds = this.grip?.name ?? "";
  }

  private say({ name, position: p, rotation: q }: Grip): void {
    this.sinceSent = 0;
    this.send({ request: "hold", object: name, position_mm: [p.x, p.y, p.z], quaternion: [q.w, q.x, q.y, q.z] });
  }

  private ray(event: PointerEvent): Raycaster {
    const box = this.view.pane.getBoundingClientRect();
    const raycaster = new Raycaster();
    raycaster.setFromCamera(
      new Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height),
      this.view.camera);
    return raycaster;
  }

  private take(event: PointerEvent): void {
    const holdable = (this.scene?.objects ?? []).flatMap((object, i) => (object.holdable ? [{ object, group: this.views[i]!.group }] : []));
    if (event.button !== 0 || holdable.length === 0) return;
    // Through whatever cannot be taken: it is glass.
    const hit = this.ray(event).intersectObjects(holdable.map(({ group }): Object3D => group))[0];
    const taken = holdable.find(({ group }) => group === hit?.object.parent);
    if (!hit || !taken) return;
    const { object, group } = taken;
    const facing = this.view.camera.getWorldDirection(new Vector3());
    this.grip = {
      pointer: event.pointerId,
      name: object.name,
      plane: new Plane().setFromNormalAndCoplanarPoint(facing, hit.point),
      toGrip: hit.point.clone().sub(group.position),
      position: group.position.clone(),
      rotation: group.quaternion.clone(),
    };
    this.view.pane.setPointerCapture(event.pointerId);
    this.showGrip();
    this.say(this.grip);
    event.stopImmediatePropagation();
    event.preventDefault();
  }

  private carry(event: PointerEvent): void {
    const grip = this.grip;
    if (!grip || event.pointerId !== grip.pointer) return;
    event.stopImmediatePropagation();
    const at = this.ray(event).ray.intersectPlane(grip.plane, new Vector3());
    if (at) grip.position.copy(at).sub(grip.toGrip).clampScalar(-kFarthest, kFarthest);
  }

  private letGo(event: PointerEvent): void {
    if (!this.grip || event.pointerId !== this.grip.pointer) return;
    this.send({ request: "let_go", object: this.grip.name });
    this.grip = null;
    this.showGrip();
    event.stopImmediatePropagation();
  }
}
