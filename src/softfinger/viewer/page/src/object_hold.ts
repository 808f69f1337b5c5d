import { type Object3D, Plane, Quaternion, Vector3 } from "three";
import type { Request, Scene } from "softfinger-client";
import type { ObjectView } from "./object_view";
import type { View } from "./stage";

const kInterval = 25; // ms between requests; the program takes no more than 50 a second
const kLeastArm = 1; // mm from its middle that something is turned by
const kFarthest = 990; // mm from the origin, of a coordinate; the program takes no more than 1000

/** What the pointer has taken, and where: the plane that it is drawn along, and from its frame to the grip. */
interface Grip {
  pointer: number;
  name: string;
  group: Object3D; // where it is
  turns: boolean; // by a joint, which keeps it from being carried
  plane: Plane;
  toGrip: Vector3; // mm, W, as it was taken
  taken: Quaternion; // its rotation then
  position: Vector3; // X_WO wanted, mm
  rotation: Quaternion;
}

/** Takes objects that move by forces with the pointer, carries them along the picture, and lets them go. */
export class ObjectHold {
  private scene: Scene | null = null;
  private views: readonly ObjectView[] = [];
  private grip: Grip | null = null;
  private saying: number | undefined; // the timer that says it again, however slowly the page draws

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
    this.end();
    document.getElementById("object-hint")!.hidden = !scene.objects.some(({ holdable }) => holdable);
  }

  private showGrip(): void {
    this.view.pane.style.cursor = this.grip ? "grabbing" : "";
    document.body.dataset.holds = this.grip?.name ?? "";
  }

  private end(): void {
    window.clearInterval(this.saying);
    this.grip = null;
    this.showGrip();
  }

  private say({ name, position: p, rotation: q }: Grip): void {
    this.send({ request: "hold", object: name, position_mm: [p.x, p.y, p.z], quaternion: [q.w, q.x, q.y, q.z] });
  }

  private take(event: PointerEvent): void {
    const holdable = (this.scene?.objects ?? []).flatMap((object, i) => (object.holdable ? [{ object, group: this.views[i]!.group }] : []));
    if (event.button !== 0 || holdable.length === 0) return;
    // Through whatever cannot be taken: it is glass.
    const hit = this.view.under(event).intersectObjects(holdable.map(({ group }): Object3D => group))[0];
    const taken = holdable.find(({ group }) => group === hit?.object.parent);
    if (!hit || !taken) return;
    const { object, group } = taken;
    const facing = this.view.camera.getWorldDirection(new Vector3());
    const grip = {
      pointer: event.pointerId,
      name: object.name,
      group,
      turns: object.joint === "hinge" || object.joint === "ball",
      plane: new Plane().setFromNormalAndCoplanarPoint(facing, hit.point),
      toGrip: hit.point.clone().sub(group.position),
      taken: group.quaternion.clone(),
      position: group.position.clone(),
      rotation: group.quaternion.clone(),
    };
    this.view.pane.setPointerCapture(event.pointerId);
    this.grip = grip;
    this.showGrip();
    this.say(grip);
    this.saying = window.setInterval(() => this.say(grip), kInterval);
    event.stopImmediatePropagation();
    event.preventDefault();
  }

  private carry(event: PointerEvent): void {
    const grip = this.grip;
    if (!grip || event.pointerId !== grip.pointer) return;
    event.stopImmediatePropagation();
    const at = this.view.under(event).ray.intersectPlane(grip.plane, new Vector3());
    if (!at) return;
    grip.position.copy(at).sub(grip.toGrip).clampScalar(-kFarthest, kFarthest);
    if (grip.turns) turn(grip, at);
  }

  private letGo(event: PointerEvent): void {
    if (!this.grip || event.pointerId !== this.grip.pointer) return;
    this.send({ request: "let_go", object: this.grip.name });
    this.end();
    event.stopImmediatePropagation();
  }
}

/** A knob or a dial follows the pointer around its middle: from where it was taken to where the pointer is. */
function turn(grip: Grip, at: Vector3): void {
  const middle = grip.group.position;
  const to = at.clone().sub(middle);
  if (grip.toGrip.length() < kLeastArm || to.length() < kLeastArm) return;
  grip.position.copy(middle);
  grip.rotation.setFromUnitVectors(grip.toGrip.clone().normalize(), to.normalize()).multiply(grip.taken);
}
