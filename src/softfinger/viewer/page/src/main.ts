import "./style.css";
import { type Group, Vector3 } from "three";
import { type FingerSnapshot, open, type Scene, type Snapshot } from "softfinger-client";
import { DeviceMarks } from "./device_marks";
import { DeviceView } from "./device_view";
import { emulateHeadset } from "./emulated_headset";
import { EventList } from "./event_list";
import { FingerLabel } from "./finger_label";
import { FingerView, place } from "./finger_view";
import { FitDialog } from "./fitting";
import { Hand } from "./hand";
import { fingerColor, stateOf, toneOf } from "./hand_table";
import { Headset } from "./headset";
import { Notifications } from "./notifications";
import { ObjectHold } from "./object_hold";
import { ObjectView } from "./object_view";
import { Pad, PatchView } from "./patch_view";
import { Panel } from "./panel";
import { Plots } from "./plots";
import { RegistrationDialog } from "./registration";
import { Room } from "./room";
import { keepInAddress, kHand, type Shown, shownByAddress } from "./shown";
import { kBeforeTips, kHome, Stage, View } from "./stage";
import { WorkspaceView } from "./workspace_view";

const element = (id: string) => document.getElementById(id)!;
const kNear = 68; // mm, from which one finger is seen
const kFarther = 2.0; // mm more for each mm that fingers are apart
const canvas = (id: string) => element(id) as HTMLCanvasElement;

const virtual = new View({ pane: element("virtual-view"), distance: kNear, target: new Vector3(0, 0, 0) });
const rendered = new View({ pane: element("rendered-view"), distance: 92, target: new Vector3(0.5, 0, 4.5) });
const stage = new Stage(canvas("stage"), [virtual, rendered]);
const plots = new Plots(element("plots"), element("measures"));
const patches = { virtual: new PatchView(canvas("patch-virtual")), twin: new PatchView(canvas("patch-twin")) };
const marks = new DeviceMarks();

let objects: ObjectView[] = [];
let fingers: FingerView[] = [];
let fingersInWorld: Group[] = []; // in the virtual scene
let labels: FingerLabel[] = []; // of all fingers, where they are shown together
let scene: Scene | null = null;
let shown: Shown = 0; // what is followed; of one finger the device is drawn
let twin: FingerView | null = null; // of that finger
let wearer: Group | null = null; // on the device: the twin, or without one that finger
let pad: Pad | null = null; // of that finger
let workspace: WorkspaceView | null = null;
let device: DeviceView | null = null;
let newest: Snapshot | null = null;
let drawn: Snapshot | null = null;
let arrived = false; // the view has jumped to what is followed

function build(scene: Scene): void {
  for (const view of [...objects, ...fingers, ...labels, ...(twin ? [twin] : [])]) view.dispose();
  virtual.scene.remove(...objects.map((view) => view.group), ...fingersInWorld);
  if (wearer) rendered.scene.remove(wearer);
  if (device) rendered.scene.remove(device.group);

  objects = scene.objects.map((object) => new ObjectView(object));
  fingers = scene.fingers.map((finger) => new FingerView(finger));
  fingersInWorld = fingers.map((view) => view.show());
  virtual.scene.add(...objects.map((view) => view.group), ...fingersInWorld);
  labels = shown === kHand ? scene.fingers.map(({ name }, i) => new FingerLabel(name, fingerColor(i))) : [];
  labels.forEach((label, i) => fingersInWorld[i]!.add(label.sprite));
  const finger = shown === kHand ? undefined : scene.fingers[shown];
  twin = finger?.twin ? new FingerView(finger) : null;
  pad = finger?.twin ? new Pad(finger) : null;
  wearer = shown === kHand ? null : (twin ?? fingers[shown])?.show() ?? null;
  device = finger && finger.device_kind ? new DeviceView(finger) : null;
  if (wearer) rendered.scene.add(wearer);
  if (device) rendered.scene.add(device.group);
  const hasWorkspace = finger !== undefined && WorkspaceView.has(finger);
  element("workspace").hidden = !hasWorkspace;
  workspace = hasWorkspace ? new WorkspaceView(canvas("workspace-drawing"), finger) : null;
  newest = drawn = null;
  arrived = false;
}

/** Draws a scene anew, or something else of it. */
function begin(next: Scene, wanted: Shown): void {
  scene = next;
  shown = wanted;
  marks.begin(next);
  build(next);
  hand.begin(next, shown);
  objectHold.begin(next, objects);
  plots.reset(next, shown);
  panel.showScene(next, shown);
  registration.begin(next, shown);
  fitting.begin(next, shown);
}

function show(snapshot: Snapshot): void {
  objects.forEach((view, i) => snapshot.X_WO[i] && place(view.group, snapshot.X_WO[i]));
  for (const { object, positions_mm } of snapshot.soft_objects) objects[object]?.deform(positions_mm);
  fingers.forEach((view, i) => {
    const finger = snapshot.fingers[i];
    if (!finger) return;
    view.update(finger);
    place(fingersInWorld[i]!, finger.X_WF);
  });
  labels.forEach((label, i) => {
    const finger = snapshot.fingers[i];
    if (!finger) return;
    label.write(stateOf(finger), toneOf(finger.device_state, scene), marks.of(i).length > 0 || marks.isLimited(i, performance.now()));
  });
  const finger = shown === kHand ? undefined : snapshot.fingers[shown];
  if (!finger) return;
  device?.update(finger);
  const surroundings = device?.surroundings();
  if (surroundings) rendered.frame(surroundings.middle, surroundings.distance);
  workspace?.draw(finger.configuration);
  if (finger.twin) twin?.update(finger.twin);
  if (pad) showPatches(pad, finger, snapshot.time_s);
}

let patchTime = 0; // s, of the patches shown

function showPatches(pad: Pad, finger: FingerSnapshot, time: number): void {
  pad.notice(finger.twin ? [finger, finger.twin] : [finger], time - patchTime);
  patchTime = time;
  patches.virtual.draw(pad, finger);
  patches.twin.draw(pad, finger.twin);
  element("pressure-most").textContent = pad.most.toFixed(0);
}

/** Middle of what is shown in the world, and how far from it the fingers are, mm. */
function whereabouts(): { middle: Vector3; spread: number } | null {
  const followed = shown === kHand ? fingersInWorld : fingersInWorld.slice(shown, shown + 1);
  if (followed.length === 0) return null;
  const middle = new Vector3();
  for (const { position } of followed) middle.addScaledVector(position, 1 / followed.length);
  return { middle, spread: Math.max(...followed.map(({ position }) => position.distanceTo(middle))) };
}

/** After `elapsed` ms: keeps the virtual fingers in sight and the glass sorted against the skin, seen from `eye`. */
function follow(elapsed: number, eye: Vector3): void {
  const at = drawn && whereabouts();
  if (!at) return;
  const { middle, spread } = at;
  const sight = middle.clone().add(new Vector3(0, 0, -2.5));
  if (!arrived) virtual.frame(sight, kNear + kFarther * spread, shown === kHand ? kBeforeTips : kHome);
  if (!hand.holds && !objectHold.holds) virtual.follow(sight, arrived ? 1 - Math.exp(-elapsed / 180) : 1);
  arrived = true;
  const below = eye.z < middle.z - 5;
  for (const object of objects) {
    object.lookAround(middle, spread);
    object.drawBehindSkin(!below);
  }
}

const panel = new Panel(marks, {
  send: (request) => client.send(request),
  stop: () => client.stop(),
  resetView: () => {
    stage.reset();
    arrived = false;
  },
  choose: (wanted) => {
    if (!scene) return;
    const kept = newest; // also where nothing newer comes
    begin(scene, wanted);
    newest = kept;
    keepInAddress(scene, wanted);
  },
});

const hand = new Hand(virtual, (request) => client.send(request));
const objectHold = new ObjectHold(virtual, (request) => client.send(request));
const notifications = new Notifications(element("notifications"));
const events = new EventList(element("events"));
const registration = new RegistrationDialog((request) => client.send(request));
const fitting = new FitDialog((request) => client.send(request), () => client.stop());
const room = new Room(stage.renderer, virtual);
const headset = new Headset(room, (side, joints, time) => client.hand(side, joints, time));
const wantsEmulation = new URLSearchParams(location.search).has("emulate-headset");
void (wantsEmulation ? emulateHeadset() : Promise.resolve()).then(() => headset.offer());

const client = open(location.origin);
client.on("scene", (next) => {
  begin(next, shownByAddress(next));
  headset.begin(next);
});
client.on("snapshot", (snapshot) => {
  newest = snapshot;
  marks.see(snapshot, performance.now());
  plots.add(snapshot);
  panel.count(snapshot);
});
client.on("registration", (state) => registration.update(state));
client.on("fit", (state) => fitting.update(state));
client.on("notifications", ({ lines }) => lines.forEach((line) => notifications.add(line)));
client.on("events", ({ events: happened }) => happened.forEach((event) => events.add(event)));
client.on("loading", ({ scene: name }) => panel.showLoading(name));
client.on("state", (state, why) => {
  panel.showConnection(state === "closed" ? "lost" : state);
  if (state === "closed") notifications.add(why); // a page of another version than the program
});

// Without graphics hardware drawing takes the processor from the simulation: then seldomer. What a
// headset shows it wants drawn in every frame.
const kLeastInterval = stage.isPlain ? 90 : 0; // ms
let lastFrame = 0;
let lastMove = 0;

function frame(now: number, worn: XRFrame | undefined): void {
  if (newest) hand.see(newest.fingers);
  hand.advance(now - lastMove);
  lastMove = now;
  if (worn) headset.follow(worn, newest);
  objects.forEach((view, i) => (view.group.visible = !(worn && headset.draws(i))));
  for (const label of labels) label.sprite.visible = !worn;
  if (!worn && now - lastFrame < kLeastInterval) return;
  const elapsed = now - lastFrame;
  lastFrame = now;
  if (newest && newest !== drawn) {
    if (!drawn?.paused || !newest.paused) stage.touch();
    drawn = newest;
    show(newest);
    panel.showSnapshot(newest, now);
    if (!worn) plots.draw(); // nobody sees them
  }
  follow(elapsed, worn ? room.eye() : virtual.camera.position);
  if (worn) headset.draw();
  else stage.render();
}
stage.animate(frame);
