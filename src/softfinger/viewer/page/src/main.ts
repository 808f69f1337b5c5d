import "./style.css";
import { type Group, Vector3 } from "three";
import { Connection } from "./connection";
import { DeviceView } from "./device_view";
import { emulateHeadset } from "./emulated_headset";
import { FingerView, place } from "./finger_view";
import { Hand } from "./hand";
import { Headset } from "./headset";
import { Notifications } from "./notifications";
import { ObjectView } from "./object_view";
import { Pad, PatchView } from "./patch_view";
import { Panel } from "./panel";
import { Plots } from "./plots";
import { RegistrationDialog } from "./registration";
import { Room } from "./room";
import { Stage, View } from "./stage";
import { WorkspaceView } from "./workspace_view";
import type { FingerSnapshot, Scene, Snapshot } from "./wire";

const element = (id: string) => document.getElementById(id)!;
const canvas = (id: string) => element(id) as HTMLCanvasElement;

const virtual = new View({ pane: element("virtual"), distance: 68, target: new Vector3(0, 0, 0) });
const rendered = new View({ pane: element("rendered"), distance: 92, target: new Vector3(0.5, 0, 4.5) });
const stage = new Stage(canvas("stage"), [virtual, rendered]);
const plots = new Plots(element("plots"), element("measures"));
const patches = { virtual: new PatchView(canvas("patch-virtual")), twin: new PatchView(canvas("patch-twin")) };

let objects: ObjectView[] = [];
let fingers: FingerView[] = [];
let fingersInWorld: Group[] = []; // in the virtual scene
let scene: Scene | null = null;
let chosen = 0; // of the scene's fingers: the one that is followed, and its device drawn
let twin: FingerView | null = null; // of the chosen finger
let wearer: Group | null = null; // on the device: the twin, or without one the chosen finger
let pad: Pad | null = null; // of the chosen finger
let workspace: WorkspaceView | null = null;
let device: DeviceView | null = null;
let newest: Snapshot | null = null;
let drawn: Snapshot | null = null;
let arrived = false; // the view has jumped to the finger

function build(scene: Scene): void {
  for (const view of [...objects, ...fingers, ...(twin ? [twin] : [])]) view.dispose();
  virtual.scene.remove(...objects.map((view) => view.group), ...fingersInWorld);
  if (wearer) rendered.scene.remove(wearer);
  if (device) rendered.scene.remove(device.group);

  objects = scene.objects.map((object) => new ObjectView(object.shape));
  fingers = scene.fingers.map((finger) => new FingerView(finger));
  fingersInWorld = fingers.map((view) => view.show());
  virtual.scene.add(...objects.map((view) => view.group), ...fingersInWorld);
  const finger = scene.fingers[chosen];
  twin = finger?.twin ? new FingerView(finger) : null;
  pad = finger?.twin ? new Pad(finger) : null;
  wearer = (twin ?? fingers[chosen])?.show() ?? null;
  device = finger && finger.device_kind ? new DeviceView(finger) : null;
  if (wearer) rendered.scene.add(wearer);
  if (device) rendered.scene.add(device.group);
  const hasWorkspace = finger !== undefined && WorkspaceView.has(finger);
  element("workspace").hidden = !hasWorkspace;
  workspace = hasWorkspace ? new WorkspaceView(canvas("workspace-drawing"), finger) : null;
  newest = drawn = null;
  arrived = false;
}

/** Draws a scene anew, and another of its fingers where one is chosen. */
function begin(next: Scene, finger: number): void {
  scene = next;
  chosen = finger < next.fingers.length ? finger : 0;
  build(next);
  hand.begin(next, chosen);
  plots.reset(next.fingers[chosen], chosen);
  panel.showScene(next, chosen);
  registration.begin(next, chosen);
}

function show(snapshot: Snapshot): void {
  objects.forEach((view, i) => snapshot.X_WO[i] && place(view.group, snapshot.X_WO[i]));
  fingers.forEach((view, i) => {
    const finger = snapshot.fingers[i];
    if (!finger) return;
    view.update(finger);
    place(fingersInWorld[i]!, finger.X_WF);
  });
  const finger = snapshot.fingers[chosen];
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

/** After `elapsed` ms: keeps the virtual finger in sight and the glass sorted against the skin, seen from `eye`. */
function followFinger(elapsed: number, eye: Vector3): void {
  const finger = fingersInWorld[chosen];
  if (!finger || !drawn) return;
  if (!hand.holds) {
    virtual.follow(finger.position.clone().add(new Vector3(0, 0, -2.5)), arrived ? 1 - Math.exp(-elapsed / 180) : 1);
  }
  arrived = true;
  const below = eye.z < finger.position.z - 5;
  for (const object of objects) {
    object.lookAround(finger.position);
    object.drawBehindSkin(!below);
  }
}

const panel = new Panel({
  send: (request) => connection.send(request),
  resetView: () => {
    stage.reset();
    arrived = false;
  },
  chooseFinger: (number) => scene && begin(scene, number),
});

const hand = new Hand(virtual, (request) => connection.send(request));
const notifications = new Notifications(element("notifications"));
const registration = new RegistrationDialog((request) => connection.send(request));
const room = new Room(stage.renderer, virtual);
const headset = new Headset(room, (message) => connection.sendHand(message));
const wantsEmulation = new URLSearchParams(location.search).has("emulate-headset");
void (wantsEmulation ? emulateHeadset() : Promise.resolve()).then(() => headset.offer());

const connection = new Connection({
  onScene: (next) => {
    begin(next, chosen);
    headset.begin(next);
  },
  onSnapshot: (snapshot) => {
    newest = snapshot;
    plots.add(snapshot);
    panel.count(snapshot);
  },
  onRegistration: (state) => registration.update(state),
  onNotifications: (lines) => lines.forEach((line) => notifications.add(line)),
  onState: (state) => panel.showConnection(state),
});

// Without graphics hardware drawing takes the processor from the simulation: then seldomer. What a
// headset shows it wants drawn in every frame.
const kLeastInterval = stage.isPlain ? 90 : 0; // ms
let lastFrame = 0;
let lastMove = 0;

function frame(now: number, worn: XRFrame | undefined): void {
  const finger = newest?.fingers[chosen];
  if (finger) hand.see(finger);
  hand.advance(now - lastMove);
  lastMove = now;
  if (worn) headset.follow(worn);
  if (!worn && now - lastFrame < kLeastInterval) return;
  const elapsed = now - lastFrame;
  lastFrame = now;
  if (newest && newest !== drawn) {
    if (!drawn?.paused || !newest.paused) stage.touch();
    drawn = newest;
    show(newest);
    panel.showSnapshot(newest);
    if (!worn) plots.draw(); // nobody sees them
  }
  followFinger(elapsed, worn ? room.eye() : virtual.camera.position);
  if (worn) headset.draw();
  else stage.render();
}
stage.animate(frame);
