import type { Request, Scene, Skin, Snapshot } from "./wire";

const element = (id: string) => document.getElementById(id)!;
const kDeviceNames: Record<string, string> = {
  platform_3rrs: "3-RRS thimble",
  plate_2dof: "2-DoF plate",
  cable_platform: "cable-driven platform",
  pin_array: "pin array",
  delta_tactor: "delta tactor",
  membrane: "membrane",
  roller: "roller",
  mechanism: "mechanism",
};

/** Everything on the page that is neither a drawing nor a plot. */
export class Panel {
  private scene: Scene | null = null;
  private finger = 0; // shown, of the scene's
  private paused = false;
  private stopped = false;
  private received = 0;
  private readonly history: { wall_ms: number; step: number }[] = [];

  constructor(
    private readonly actions: {
      send(request: Request): void;
      resetView(): void;
      chooseFinger(number: number): void;
    },
  ) {
    element("pause").onclick = () => this.togglePause();
    element("stop").onclick = () => actions.send({ request: this.stopped ? "release" : "stop" });
    element("restart").onclick = () => actions.send({ request: "restart" });
    element("reset-view").onclick = () => actions.resetView();
    window.addEventListener("keydown", (event) => {
      // Nothing keeps this key from stopping, and it never releases.
      if (event.key === "Escape") return actions.send({ request: "stop" });
      if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
      if (event.target instanceof HTMLButtonElement && event.key === " ") return;
      if (event.key === " ") this.togglePause();
      else if (event.key === "r") actions.send({ request: "restart" });
      else if (event.key === "Home") actions.resetView();
      else return;
      event.preventDefault();
    });
  }

  showConnection(state: "connecting" | "live" | "lost"): void {
    document.body.dataset.connection = state;
    element("connection").textContent =
      state === "live" ? "live" : state === "lost" ? "no connection" : "connecting";
    if (state !== "live") this.history.length = 0;
  }

  /** A scene, and the number of its finger that is shown. */
  showScene(scene: Scene, number: number): void {
    this.scene = scene;
    this.finger = number;
    this.history.length = 0;
    element("scenes").replaceChildren(...scene.scenes.map((name) =>
      choice("scene", name, name === scene.scene, () => this.actions.send({ request: "scene", scene: name }))));
    const several = scene.fingers.length > 1;
    element("fingers").hidden = !several;
    element("fingers").replaceChildren(...(several ? scene.fingers : []).map(({ name }, i) =>
      choice("finger", name, i === number, () => this.actions.chooseFinger(i))));
    const finger = scene.fingers[number];
    document.body.dataset.scene = scene.scene;
    document.body.dataset.finger = finger?.name ?? "";
    document.body.dataset.generation = String(scene.generation);
    document.body.dataset.contacts = document.body.dataset.twinContacts = "0";
    element("twin").hidden = !finger?.twin;
    document.body.dataset.twin = finger?.twin ? "on" : "off";
    document.body.dataset.deviceKind = finger?.device_kind ?? "";
    document.title = `softfinger · ${scene.scene}`;
    element("virtual-what").textContent =
      `${finger?.name ?? "finger"} · ${scene.objects.map((object) => object.name).join(", ")}`;
    element("rendered-what").textContent = finger?.device_kind
      ? `${finger.name} · ${kDeviceNames[finger.device_kind] ?? finger.device_kind}`
      : "no device";
  }

  /** Called for every snapshot received, drawn or not. */
  count(snapshot: Snapshot): void {
    document.body.dataset.frames = String(++this.received);
    this.history.push({ wall_ms: snapshot.wall_ms, step: snapshot.step });
    if (this.history.length > 120) this.history.shift();
  }

  showSnapshot(snapshot: Snapshot): void {
    const finger = snapshot.fingers[this.finger];
    const duration = this.scene?.duration_s ?? 0;
    element("time").textContent = snapshot.time_s.toFixed(2);
    element("duration").textContent = duration > 0 ? ` / ${duration.toFixed(1)} s` : " s";
    element("progress").style.transform =
      `scaleX(${duration > 0 ? Math.min(1, snapshot.time_s / duration) : 0})`;
    element("rate").textContent = this.stepRate(snapshot);
    element("misses").textContent = String(snapshot.deadline_misses);
    element("misses-item").hidden = snapshot.deadline_misses === 0;

    this.paused = snapshot.paused;
    const state = snapshot.finished ? "finished" : snapshot.paused ? "paused" : "running";
    document.body.dataset.state = state;
    this.stopped = snapshot.stopped;
    document.body.dataset.stopped = String(snapshot.stopped);
    element("stop-label").textContent = snapshot.stopped ? "Release" : "Stop device";
    element("pause-label").textContent = snapshot.paused ? "Resume" : "Pause";
    element("notice").textContent =
      snapshot.stopped ? "Device stopped" : state === "paused" ? "Paused" : state === "finished" ? "End of the script" : "";

    if (!finger) return;
    element("device-state").textContent = finger.device_state || "no device";
    document.body.dataset.device = finger.device_state;
    const contacts = contactCount(finger);
    document.body.dataset.contacts = String(contacts);
    document.body.dataset.samples = String(finger.in_contact.length);
    document.body.dataset.time = snapshot.time_s.toFixed(3);
    if (finger.twin) {
      const twinContacts = contactCount(finger.twin);
      document.body.dataset.twinContacts = String(twinContacts);
      document.body.dataset.iou = finger.twin.iou.toFixed(3);
      element("press").textContent = finger.twin.press_ms.toFixed(1);
      element("patch-virtual-count").textContent = `${contacts}`;
      element("patch-twin-count").textContent = `${twinContacts}`;
    }
    element("contacts").textContent = `${contacts}`;
    element("samples").textContent = `of ${finger.in_contact.length}`;
    element("stuck").textContent = contacts > 0 ? (100 * finger.stuck_fraction).toFixed(0) : "–";
    element("slip").textContent = contacts > 0 ? finger.slip_ratio.toFixed(2) : "–";
    element("deviation").textContent = finger.deviation_mm2.toFixed(3);
    element("joints").textContent =
      jointText(finger.joint_values, this.scene?.fingers[this.finger]?.joint_unit ?? "deg");
  }

  private togglePause(): void {
    this.actions.send({ request: this.paused ? "resume" : "pause" });
  }

  /** Steps a second of wall time over about the last second. */
  private stepRate(snapshot: Snapshot): string {
    const first = this.history[0];
    const last = this.history[this.history.length - 1];
    const passed = first && last ? (last.wall_ms - first.wall_ms) >>> 0 : 0; // ms
    if (snapshot.paused || snapshot.finished || !first || !last || passed < 200) return "–";
    const rate = (1000 * (last.step - first.step)) / passed;
    return rate >= 0 ? (Math.round(rate / 10) * 10).toLocaleString("en").replace(",", "\u202f") : "–";
  }
}

/** A button of a radio group; `kind` names what is chosen, for style and tests. */
function choice(kind: string, name: string, checked: boolean, choose: () => void): HTMLButtonElement {
  const button = document.createElement("button");
  button.textContent = name;
  button.dataset[kind] = name;
  button.setAttribute("role", "radio");
  button.setAttribute("aria-checked", String(checked));
  button.onclick = choose;
  return button;
}

function contactCount(skin: Skin): number {
  let count = 0;
  for (const touching of skin.in_contact) count += touching;
  return count;
}

/** The first joints' values; a field of pins has too many to show. */
function jointText(values: Float32Array, unit: "deg" | "mm"): string {
  const shown = Array.from(values.slice(0, unit === "deg" ? 6 : 3),
    (value) => (unit === "deg" ? `${value.toFixed(0)}°` : `${value.toFixed(1)} mm`));
  return shown.join("  ") + (values.length > shown.length ? " …" : "");
}
