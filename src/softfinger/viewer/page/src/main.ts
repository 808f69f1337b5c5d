import "./style.css";
import { type Group, Vector3 } from "three";
import { Connection } from "./connection";
import { DeviceView } from "./device_view";
import { FingerView, place } from "./finger_view";
import { Hand } from "./hand";
import { ObjectView } from "./object_view";
import { Pad, PatchView } from "./patch_view";
import { Panel } from "./panel";
import { Plots } from "./plots";
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
let twin: FingerView | null = null; // of the first finger
let wearer: Group | null = null; // on the device: the twin, or without one the first finger
let pad: Pad | null = null; // of the first finger
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
  const first = scene.fingers[0];
  twin = first?.twin ? new FingerView(first) : null;
  pad = first?.twin ? new Pad(first) : null;
  wearer = (twin ?? fingers[0])?.show() ?? null;
  device = first && first.device_kind ? new DeviceView(first) : null;
  if (wearer) rendered.scene.add(wearer);
  if (device) rendered.scene.add(device.group);
  const hasWorkspace = first !== undefined && WorkspaceView.has(first);
  element("workspace").hidden = !hasWorkspace;
  workspace = hasWorkspace ? new WorkspaceView(canvas("workspace-drawing"), first) : null;
  newest = drawn = null;
  arrived = false;
}

function show(snapshot: Snapshot): void {
  objects.forEach((view, i) => snapshot.X_WO[i] && place(view.group, snapshot.X_WO[i]));
  fingers.forEach((view, i) => {
    const finger = snapshot.fingers[i];
    if (!finger) return;
    view.update(finger);
    place(fingersInWorld[i]!, finger.X_WF);
  });
  const first = snapshot.fingers[0];
  if (!first) return;
  device?.update(first);
  const surroundings = device?.surroundings();
  if (surroundings) rendered.frame(surroundings.middle, surroundings.distance);
  workspace?.draw(first.configuration);
  if (first.twin) twin?.update(first.twin);
  if (pad) showPatches(pad, first, snapshot.time_s);
}

let patchTime = 0; // s, of the patches shown

function showPatches(pad: Pad, finger: FingerSnapshot, time: number): void {
  pad.notice(finger.twin ? [finger, finger.twin] : [finger], time - patchTime);
  patchTime = time;
  patches.virtual.draw(pad, finger);
  patches.twin.draw(pad, finger.twin);
  element("pressure-most").textContent = pad.most.toFixed(0);
}

/** After `elapsed` ms: keeps the virtual finger in sight and the glass sorted against the skin. */
function followFinger(elapsed: number): void {
  const finger = fingersInWorld[0];
  if (!finger || !drawn) return;
  if (!hand.holds) {
    virtual.follow(finger.position.clone().add(new Vector3(0, 0, -2.5)), arrived ? 1 - Math.exp(-elapsed / 180) : 1);
  }
  arrived = true;
  const below = virtual.camera.position.z < finger.position.z - 5;
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
});

const hand = new Hand(virtual, (request) => connection.send(request));

const connection = new Connection({
  onScene: (scene) => {
    build(scene);
    hand.begin(scene);
    plots.reset(scene.fingers[0]);
    panel.showScene(scene);
  },
  onSnapshot: (snapshot) => {
    newest = snapshot;
    plots.add(snapshot);
    panel.count(snapshot);
  },
  onState: (state) => panel.showConnection(state),
});

// Without graphics hardware drawing takes the processor from the simulation: then seldomer.
const kLeastInterval = stage.isPlain ? 90 : 0; // ms
let lastFrame = 0;
let lastMove = 0;

function frame(now: number): void {
  requestAnimationFrame(frame);
  if (newest?.fingers[0]) hand.see(newest.fingers[0]);
  hand.advance(now - lastMove);
  lastMove = now;
  if (now - lastFrame < kLeastInterval) return;
  const elapsed = now - lastFrame;
  lastFrame = now;
  if (newest && newest !== drawn) {
    if (!drawn?.paused || !newest.paused) stage.touch();
    drawn = newest;
    show(newest);
    panel.showSnapshot(newest);
    plots.draw();
  }
  followFinger(elapsed);
  stage.render();
}
requestAnimationFrame(frame);
