import { Plane, Quaternion, Sphere, Vector3 } from "three";
import type { FingerSnapshot, Request, Scene } from "softfinger-client";
import type { View } from "./stage";
import { kHand, type Shown } from "./shown";

const kReach = 13; // mm about the finger's middle that the pointer takes hold of
const kMiddle = new Vector3(0, 0, -2); // of the finger, in F, mm
const kSpeed = 25; // mm/s, of a key
const kTurnSpeed = Math.PI / 4; // rad/s, of a key
const kTurnByDrag = 0.008; // rad a pixel
const kInterval = 25; // ms between poses; the program takes no more than 50 a second

/** Keys, and what each does: along or about right, away and up of the picture. */
const kSlides: Record<string, [number, number, number]> = {
  arrowleft: [-1, 0, 0], arrowright: [1, 0, 0], arrowup: [0, 1, 0], arrowdown: [0, -1, 0],
  w: [0, 0, 1], s: [0, 0, -1],
};
const kTurns: Record<string, [number, number, number]> = {
  a: [0, -1, 0], d: [0, 1, 0], q: [1, 0, 0], e: [-1, 0, 0], z: [0, 0, 1], x: [0, 0, -1],
};

/**
 * Moves the finger shown with pointer and keys, where the program lets the page. Goes on saying where the
 * finger is while the page is in sight: the program takes silence for a hand that is gone.
 */
export class Hand {
  private active = false;
  private finger = 0; // of the scene's
  private known = false;
  private readonly position = new Vector3(); // X_WFt, mm
  private readonly rotation = new Quaternion();
  private readonly held = new Set<string>();
  private grip: { pointer: number; plane: Plane; last: Vector3; x: number; y: number } | null = null;
  private sinceSent = 0;

  constructor(private readonly view: View, private readonly send: (request: Request) => void) {
    // Before the view's own controls, which turn the picture.
    view.pane.addEventListener("pointerdown", (event) => this.take(event), { capture: true });
    view.pane.addEventListener("pointermove", (event) => this.drag(event), { capture: true });
    for (const end of ["pointerup", "pointercancel"] as const) {
      view.pane.addEventListener(end, (event) => this.release(event), { capture: true });
    }
    window.addEventListener("keydown", (event) => {
      const key = event.key.toLowerCase();
      if (event.target instanceof HTMLSelectElement) return; // its own keys
      if (!this.active || event.ctrlKey || event.metaKey || event.altKey) return;
      if (!(key in kSlides) && !(key in kTurns)) return;
      this.held.add(key);
      event.preventDefault();
    });
    window.addEventListener("keyup", (event) => this.held.delete(event.key.toLowerCase()));
    window.addEventListener("blur", () => this.held.clear());
  }

  /** Whether the pointer has hold of the finger. */
  get holds(): boolean {
    return this.grip !== null;
  }

  /** Of all fingers the first that may be moved. */
  begin(scene: Scene, shown: Shown): void {
    this.finger = shown === kHand ? scene.fingers.findIndex((finger) => finger.moved_here) : shown;
    const finger = scene.fingers[this.finger];
    this.active = finger?.moved_here ?? false;
    document.getElementById("moved-finger")!.textContent = shown === kHand && finger ? finger.name : "finger";
    this.known = false;
    this.grip = null;
    this.held.clear();
    document.getElementById("hand-hint")!.hidden = !this.active;
  }

  /** Where the finger is before anyone moved it. */
  see(fingers: FingerSnapshot[]): void {
    const finger = fingers[this.finger];
    if (!this.active || this.known || !finger) return;
    const pose = finger.X_WFt;
    this.position.set(pose[0]!, pose[1]!, pose[2]!);
    this.rotation.set(pose[3]!, pose[4]!, pose[5]!, pose[6]!);
    this.known = true;
  }

  /** After `elapsed` ms. */
  advance(elapsed: number): void {
    if (!this.active || !this.known) return;
    this.followKeys(Math.min(elapsed, 100) / 1000);
    this.sinceSent += elapsed;
    if (this.sinceSent < kInterval) return;
    this.sinceSent = 0;
    const { position: p, rotation: q } = this;
    this.send({ request: "pose", finger: this.finger, position_mm: [p.x, p.y, p.z], quaternion: [q.w, q.x, q.y, q.z] });
  }

  private followKeys(seconds: number): void {
    const { right, away, up } = this.directions();
    const along = (amounts: [number, number, number], length: number) =>
      new Vector3().addScaledVector(right, amounts[0] * length).addScaledVector(away, amounts[1] * length)
        .addScaledVector(up, amounts[2] * length);
    for (const key of this.held) {
      const slide = kSlides[key];
      const turn = kTurns[key];
      if (slide) this.position.add(along(slide, kSpeed * seconds));
      if (turn) this.turn(along(turn, 1).normalize(), kTurnSpeed * seconds);
    }
    this.stayNear();
  }

  /** Horizontal right and away of the picture, and up. */
  private directions(): { right: Vector3; away: Vector3; up: Vector3 } {
    const up = new Vector3(0, 0, 1);
    const away = this.view.controls.target.clone().sub(this.view.camera.position).setZ(0).normalize();
    return { right: away.clone().cross(up), away, up };
  }

  private turn(axis: Vector3, angle: number): void {
    this.rotation.premultiply(new Quaternion().setFromAxisAngle(axis, angle)).normalize();
  }

  /** The program takes no pose further from the origin than a metre. */
  private stayNear(): void {
    this.position.clampScalar(-500, 500);
  }

  private take(event: PointerEvent): void {
    if (!this.active || !this.known || event.button !== 0) return;
    const middle = kMiddle.clone().applyQuaternion(this.rotation).add(this.position);
    const raycaster = this.view.under(event);
    if (!raycaster.ray.intersectsSphere(new Sphere(middle, kReach))) return;
    const facing = this.view.camera.getWorldDirection(new Vector3());
    const plane = new Plane().setFromNormalAndCoplanarPoint(facing, middle);
    const last = raycaster.ray.intersectPlane(plane, new Vector3());
    if (!last) return;
    this.grip = { pointer: event.pointerId, plane, last, x: event.clientX, y: event.clientY };
    this.view.pane.setPointerCapture(event.pointerId);
    event.stopImmediatePropagation();
    event.preventDefault();
  }

  private drag(event: PointerEvent): void {
    const grip = this.grip;
    if (!grip || event.pointerId !== grip.pointer) return;
    event.stopImmediatePropagation();
    const at = this.view.under(event).ray.intersectPlane(grip.plane, new Vector3());
    if (event.shiftKey) {
      const { right, up } = this.directions();
      this.turn(up, (event.clientX - grip.x) * kTurnByDrag);
      this.turn(right, (event.clientY - grip.y) * kTurnByDrag);
    } else if (at) {
      this.position.add(at.clone().sub(grip.last));
      this.stayNear();
    }
    if (at) grip.last = at;
    [grip.x, grip.y] = [event.clientX, event.clientY];
  }

  private release(event: PointerEvent): void {
    if (!this.grip || event.pointerId !== this.grip.pointer) return;
    this.grip = null;
    event.stopImmediatePropagation();
  }
}
