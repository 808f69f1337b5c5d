import type { Client, FollowedFinger, Scene, Snapshot } from "softfinger-client";
import { HeldHands } from "./held_hands";
import { placeByEyes, placeByFinger } from "./placement";
import type { Room } from "./room";
import { SeenHands } from "./seen_hands";
import { endsOf, readJoints, type Side } from "./xr_hand";

const kSettle = 1000; // ms that a hand has to be seen before the scene is placed by it
const kSides: Side[] = ["right", "left"];

/**
 * An immersive session: tells the program in every frame where the hands are that its fingers follow, in
 * the frame of the scene. The scene is placed where the leading finger, once it is seen, is at its start,
 * and anew at a pinch of a hand that no finger follows.
 */
export class Headset {
  private readonly button = document.getElementById("enter-headset")!;
  private readonly hands = new SeenHands();
  private readonly held = new HeldHands();
  private readonly shown = new Set<Side>(); // hands as the world holds them
  private session: XRSession | null = null;
  private room: XRReferenceSpace | null = null;
  private space: XRReferenceSpace | null = null; // with the scene's origin; null: not placed
  private seenSince: number | null = null; // ms
  private scene = "";
  private followed: FollowedFinger[] = [];

  constructor(private readonly drawing: Room, private readonly tell: Client["hand"]) {
    this.button.onclick = () => void (this.session ? this.session.end() : this.enter());
  }

  /** Shows the button where there is a headset. */
  async offer(): Promise<void> {
    const supported = await navigator.xr?.isSessionSupported("immersive-vr").catch(() => false);
    this.button.hidden = supported !== true;
  }

  begin(scene: Scene): void {
    this.followed = scene.fingers.flatMap((finger) => finger.headset ?? []);
    this.held.begin(scene);
    if (scene.scene !== this.scene) this.placeAnew();
    this.scene = scene.scene;
    this.say(this.followed.length === 0 ? "" : "Enter XR and hold the hand where it is to begin: after a second the " +
      "scene comes to the finger. A pinch of the other hand places it anew. Without a headset: ?emulate-headset");
  }

  /** Whether an object of the scene is part of a hand that is drawn whole. */
  draws(object: number): boolean {
    const side = this.held.sideOf(object);
    return this.session !== null && side !== undefined && this.shown.has(side);
  }

  /** In every frame of the headset; `newest` of the scene. */
  follow(frame: XRFrame, newest: Snapshot | null): void {
    if (!this.room || frame.session !== this.session) return;
    const time = performance.now();
    if (!this.space) this.place(frame, time);
    const space = this.space ?? this.room;
    const seen = new Map<Side, Float32Array>();
    for (const side of kSides) {
      const joints = this.joints(frame, side, space);
      if (joints) seen.set(side, joints);
      if (!this.followed.some((finger) => finger.hand === side)) continue;
      this.tell(side, this.space ? joints : null, time);
    }
    this.show(seen, newest);
    document.body.dataset.headset = this.space ? "placed" : "entered";
  }

  /** Where the world holds them, of those that it has. */
  private show(seen: Map<Side, Float32Array>, newest: Snapshot | null): void {
    this.shown.clear();
    let [bones, back] = [0, 0];
    this.hands.show([...seen].map(([side, joints]) => {
      const instead = this.drawnOf(side);
      const held = this.space && newest && this.held.asHeld(side, joints, newest);
      if (!held) return { side, joints, instead };
      this.shown.add(side);
      bones += held.count;
      back = Math.max(back, held.back);
      return { side, joints: held.joints, instead };
    }));
    document.body.dataset.bones = String(bones);
    document.body.dataset.heldBack = (1e3 * back).toFixed(1); // mm
  }

  draw(): void {
    this.drawing.draw(this.space !== null, this.hands.scene);
  }

  private async enter(): Promise<void> {
    const features = this.followed.length > 0 ? "requiredFeatures" : "optionalFeatures";
    try {
      const session = await navigator.xr!.requestSession("immersive-vr", { [features]: ["hand-tracking"] });
      this.session = session;
      session.addEventListener("end", () => this.leave());
      session.addEventListener("select", ({ inputSource }) => this.pinched(inputSource.handedness));
      this.space = null;
      this.seenSince = null;
      this.hands.load();
      this.room = await this.drawing.open(session);
      this.say("");
    } catch (error) {
      this.say(`The headset refuses: ${error instanceof Error ? error.message : String(error)}`);
    }
  }

  private leave(): void {
    for (const side of new Set(this.followed.map((finger) => finger.hand))) {
      this.tell(side, null);
    }
    this.session = this.room = this.space = null;
    this.drawing.close();
    document.body.dataset.headset = "left";
  }

  private pinched(hand: XRHandedness): void {
    const sides = new Set<XRHandedness>(this.followed.map((finger) => finger.hand));
    if (sides.has(hand) && sides.size < kSides.length) return;
    this.placeAnew();
    this.seenSince = -Infinity; // by what is seen now
  }

  private placeAnew(): void {
    this.space = this.seenSince = null;
    if (this.room) this.drawing.lay(this.room);
  }

  private place(frame: XRFrame, time: number): void {
    const leading = this.followed.find(({ finger }) => finger === "index") ?? this.followed[0];
    const where = leading ? this.placeOf(frame, time, leading) : this.placeAhead(frame);
    if (!where) return;
    this.space = this.room!.getOffsetReferenceSpace(where);
    this.drawing.lay(this.space);
  }

  private placeOf(frame: XRFrame, time: number, leading: FollowedFinger): XRRigidTransform | null {
    const joints = this.joints(frame, leading.hand, this.room!);
    if (!joints) {
      this.seenSince = null;
      return null;
    }
    this.seenSince ??= time;
    return time - this.seenSince < kSettle ? null : placeByFinger(joints, leading);
  }

  private placeAhead(frame: XRFrame): XRRigidTransform | null {
    const eyes = frame.getViewerPose(this.room!);
    return eyes ? placeByEyes(eyes.transform) : null;
  }

  private joints(frame: XRFrame, side: Side, space: XRReferenceSpace): Float32Array | null {
    for (const source of frame.session.inputSources) {
      if (source.handedness === side && source.hand) return readJoints(frame, source.hand, space);
    }
    return null;
  }

  /** The joints that the virtual fingers stand for. */
  private drawnOf(side: Side): Set<XRHandJoint> {
    return new Set(!this.space ? [] : this.followed.filter(({ hand }) => hand === side)
      .flatMap(({ finger }) => Object.values(endsOf(finger))));
  }

  private say(text: string): void {
    document.getElementById("headset-hint")!.textContent = text;
  }
}
