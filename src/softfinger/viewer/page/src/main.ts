import "./style.css";
import { Vector3 } from "three";
import { Connection } from "./connection";
import { DeviceView } from "./device_view";
import { FingerView, place } from "./finger_view";
import { ObjectView } from "./object_view";
import { Panel } from "./panel";
import { Plots } from "./plots";
import { Stage, View } from "./stage";
import type { Scene, Snapshot } from "./wire";

const element = (id: string) => document.getElementById(id)!;

const virtual = new View({ pane: element("virtual"), distance: 76, target: new Vector3(0, 0, 0) });
const rendered = new View({ pane: element("rendered"), distance: 104, target: new Vector3(0, 0, 1) });
const stage = new Stage(element("stage") as HTMLCanvasElement, [virtual, rendered]);
const plots = new Plots(element("plots"));

let objects: ObjectView[] = [];
let fingers: FingerView[] = []; // in the virtual scene
let wearer: FingerView | null = null; // on the device
let device: DeviceView | null = null;
let newest: Snapshot | null = null;
let drawn: Snapshot | null = null;
let arrived = false; // the view has jumped to the finger

function build(scene: Scene): void {
  for (const view of objects) view.dispose();
  for (const view of fingers) view.dispose();
  wearer?.dispose();
  for (const node of [...objects, ...fingers]) virtual.scene.remove(node.group);
  if (wearer) rendered.scene.remove(wearer.group);
  if (device) rendered.scene.remove(device.group);

  objects = scene.objects.map((object) => new ObjectView(object.shape));
  fingers = scene.fingers.map((finger) => new FingerView(finger));
  for (const node of [...objects, ...fingers]) virtual.scene.add(node.group);
  const first = scene.fingers[0];
  wearer = first ? new FingerView(first) : null;
  device = first && first.device_kind ? new DeviceView(first) : null;
  if (wearer) rendered.scene.add(wearer.group);
  if (device) rendered.scene.add(device.group);
  newest = drawn = null;
  arrived = false;
}

function show(snapshot: Snapshot): void {
  objects.forEach((view, i) => snapshot.X_WO[i] && place(view.group, snapshot.X_WO[i]));
  fingers.forEach((view, i) => {
    const finger = snapshot.fingers[i];
    if (!finger) return;
    view.update(finger);
    place(view.group, finger.X_WF);
  });
  const first = snapshot.fingers[0];
  if (!first) return;
  wearer?.update(first);
  device?.update(first);
}

/** Keeps the virtual finger in sight and the glass sorted against the skin. */
function followFinger(): void {
  const finger = fingers[0];
  if (!finger) return;
  virtual.follow(finger.group.position.clone().add(new Vector3(0, 0, -1.5)), arrived ? 0.08 : 1);
  arrived = true;
  const below = virtual.camera.position.z < finger.group.position.z - 5;
  for (const object of objects) {
    object.lookAround(finger.group.position);
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

const connection = new Connection({
  onScene: (scene) => {
    build(scene);
    plots.reset(scene.fingers[0]?.configuration_names ?? []);
    panel.showScene(scene);
  },
  onSnapshot: (snapshot) => {
    newest = snapshot;
    plots.add(snapshot);
    panel.count(snapshot);
  },
  onState: (state) => panel.showConnection(state),
});

function frame(): void {
  requestAnimationFrame(frame);
  if (newest && newest !== drawn) {
    drawn = newest;
    show(newest);
    panel.showSnapshot(newest);
    plots.draw();
  }
  followFinger();
  stage.render();
}
requestAnimationFrame(frame);
