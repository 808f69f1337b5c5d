import type { FingerSnapshot, Request, Scene, Snapshot } from "softfinger-client";
import { type DeviceMarks, noticeLines, showWarning } from "./device_marks";
import { commonState, contactCount, HandTable, stateOf, toneOf } from "./hand_table";
import { ObjectiveChoice } from "./objective_choice";
import { RadioGroup } from "./radio_group";
import { kHand, type Shown } from "./shown";
import { Stopping } from "./stopping";

const element = (id: string) => document.getElementById(id)!;
const kSilence = 1000; // ms, of who leads the servos
const kSoon = 250; // ms; what is loaded sooner is not told

/** Everything on the page that is neither a drawing nor a plot. */
export class Panel {
  private scene: Scene | null = null;
  private shown: Shown = 0;
  private paused = false;
  private stopped = { asked: false, confirmed: false, silence_ms: 0 };
  private state = ""; // running, paused, finished
  private connection = "connecting";
  private device = { state: "", text: "", limited: false }; // as last drawn
  private loading = "";
  private loadingSoon = 0; // a timer
  private received = 0;
  private readonly history: { wall_ms: number; step: number }[] = [];
  private readonly scenes: RadioGroup;
  private readonly fingers: RadioGroup;
  private readonly table: HandTable;
  private readonly stopping: Stopping;
  private readonly objective: ObjectiveChoice;

  constructor(
    private readonly marks: DeviceMarks,
    private readonly actions: {
      send(request: Request): void;
      stop(): void;
      resetView(): void;
      choose(shown: Shown): void;
    },
  ) {
    this.scenes = new RadioGroup(element("scenes"), "scene", (i) => {
      const name = this.scene?.scenes[i];
      if (name !== undefined) actions.send({ request: "scene", scene: name });
    });
    this.fingers = new RadioGroup(element("fingers"), "finger", (i) => actions.choose(i === 0 ? kHand : i - 1));
    this.table = new HandTable(element("hand-fingers"), element("hand-notices"), (finger) => {
      actions.choose(finger);
      element("fingers").querySelector<HTMLElement>('[aria-checked="true"]')?.focus(); // the table is gone
    });
    element("pause").onclick = () => this.togglePause();
    this.stopping = new Stopping(actions);
    this.objective = new ObjectiveChoice((request) => actions.send(request));
    element("restart").onclick = () => actions.send({ request: "restart" });
    element("reset-view").onclick = () => actions.resetView();
    window.addEventListener("keydown", (event) => {
      // Nothing keeps this key from stopping, and it never releases.
      if (event.key === "Escape") return this.stopping.stop();
      if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
      if (event.target instanceof HTMLSelectElement) return; // its own keys
      // Space presses a button, but for one that is chosen already.
      const button = event.target instanceof HTMLButtonElement ? event.target : null;
      if (button && event.key === " " && button.getAttribute("aria-checked") !== "true") return;
      if (event.key === " ") this.togglePause();
      else if (event.key === "r") actions.send({ request: "restart" });
      else if (event.key === "Home") actions.resetView();
      else return;
      event.preventDefault();
    });
  }

  showConnection(state: "connecting" | "live" | "lost"): void {
    this.connection = state;
    document.body.dataset.connection = state;
    element("connection").textContent =
      state === "live" ? "live" : state === "lost" ? "no connection" : "connecting";
    if (state === "lost") {
      this.tellDevice();
      element("rate").textContent = "–";
      this.showLoading("");
    }
    if (state !== "live") this.history.length = 0;
    this.tell();
  }

  /** The name of a scene that is on its way; empty: none. */
  showLoading(scene: string): void {
    window.clearTimeout(this.loadingSoon);
    const show = (name: string) => {
      this.loading = name;
      document.body.dataset.loading = name;
      for (const button of element("scenes").querySelectorAll<HTMLElement>("button")) {
        button.toggleAttribute("data-loading", button.dataset.scene === name);
      }
      this.tell();
    };
    if (scene === "") show("");
    else this.loadingSoon = window.setTimeout(() => show(scene), kSoon);
  }

  /** A scene, and what of it is shown. */
  showScene(scene: Scene, shown: Shown): void {
    this.scene = scene;
    this.shown = shown;
    this.history.length = 0;
    const whole = shown === kHand;
    this.scenes.show(scene.scenes, scene.scenes.indexOf(scene.scene));
    const several = scene.fingers.length > 1;
    element("fingers").hidden = !several;
    this.fingers.show(several ? ["All fingers", ...scene.fingers.map(({ name }) => name)] : [], whole ? 0 : shown + 1);
    const finger = whole ? undefined : scene.fingers[shown];
    Object.assign(document.body.dataset, {
      scene: scene.scene, finger: finger?.name ?? "", view: whole ? "hand" : "finger", device: "",
      generation: String(scene.generation), contacts: "0", twinContacts: "0",
      twin: finger?.twin ? "on" : "off", deviceKind: finger?.device_kind ?? "",
    });
    element("hand").hidden = !whole;
    element("twin").hidden = !finger?.twin;
    element(finger?.twin ? "side" : "rendered-foot").append(element("workspace"));
    document.title = `softfinger · ${scene.scene}`;
    const things = scene.objects.map(({ name, hand }) => (hand ? `${hand} hand` : name)); // its bones count as one
    const objects = [...new Set(things)].join(", ");
    element("virtual-what").textContent =
      `${whole ? `${scene.fingers.length} fingers` : finger?.name ?? "finger"} · ${objects}`;
    element("rendered-what").textContent = finger?.device_kind
      ? `${finger.name} · ${finger.device_kind_words}`
      : "no device";
    const notices = whole ? scene.notices : this.marks.of(shown);
    showWarning(element("device-warning"), notices);
    element("device-notices").replaceChildren(...(whole ? [] : noticeLines(notices, () => "")));
    element("device-limited").hidden = true;
    this.table.begin(scene, this.marks);
    this.objective.begin(scene, whole ? -1 : shown);
  }

  /** Called for every snapshot received, drawn or not. */
  count(snapshot: Snapshot): void {
    document.body.dataset.frames = String(++this.received);
    this.history.push({ wall_ms: snapshot.wall_ms, step: snapshot.step });
    if (this.history.length > 120) this.history.shift();
  }

  showSnapshot(snapshot: Snapshot, now: number): void {
    const duration = this.scene?.duration_s ?? 0;
    element("time").textContent = snapshot.time_s.toFixed(2);
    element("duration").textContent = duration > 0 ? ` / ${duration.toFixed(1)} s` : " s";
    element("progress").style.transform =
      `scaleX(${duration > 0 ? Math.min(1, snapshot.time_s / duration) : 0})`;
    element("rate").textContent = this.connection === "lost" ? "–" : this.stepRate(snapshot);
    element("misses").textContent = String(snapshot.deadline_misses);
    document.body.dataset.time = snapshot.time_s.toFixed(3);

    this.paused = snapshot.paused;
    this.stopped = {
      asked: snapshot.stopped,
      confirmed: snapshot.stop_confirmed,
      silence_ms: Math.max(0, ...snapshot.fingers.map(({ device_said_ms }) => device_said_ms || 0)),
    };
    this.stopping.show(snapshot);
    this.state = snapshot.finished ? "finished" : snapshot.paused ? "paused" : "running";
    document.body.dataset.state = this.state;
    element("pause-label").textContent = snapshot.paused ? "Resume" : "Pause";
    this.tell();

    if (this.shown === kHand) {
      this.showHand(snapshot, now);
    } else {
      const finger = snapshot.fingers[this.shown];
      if (finger) this.showFinger(finger, this.shown, now);
    }
  }

  private showHand(snapshot: Snapshot, now: number): void {
    const { state, text } = commonState(snapshot.fingers, this.scene);
    this.showDevice(state, text, snapshot.fingers.some((_, i) => this.marks.isLimited(i, now)));
    this.table.show(snapshot, this.marks, now);
    const counts = snapshot.fingers.map(contactCount);
    const samples = snapshot.fingers.map((finger) => finger.in_contact.length);
    this.showContacts(sum(counts), sum(samples));
  }

  private showFinger(finger: FingerSnapshot, number: number, now: number): void {
    this.showDevice(finger.device_state, stateOf(finger), this.marks.isLimited(number, now));
    const contacts = contactCount(finger);
    this.showContacts(contacts, finger.in_contact.length);
    if (finger.twin) {
      const twinContacts = contactCount(finger.twin);
      document.body.dataset.twinContacts = String(twinContacts);
      document.body.dataset.iou = finger.twin.iou.toFixed(3);
      element("press").textContent = finger.twin.press_ms.toFixed(1);
      element("patch-virtual-count").textContent = `${contacts}`;
      element("patch-twin-count").textContent = `${twinContacts}`;
    }
    element("stuck").textContent = contacts > 0 ? (100 * finger.stuck_fraction).toFixed(0) : "–";
    element("normal").textContent = finger.normal_force_N.toFixed(2);
    element("normal-sum").textContent = finger.normal_force_sum_N.toFixed(2);
    element("slip").textContent = contacts > 0 ? finger.slip_ratio.toFixed(2) : "–";
    this.objective.show(finger);
    element("deviation").textContent = finger.deviation_mm2.toFixed(3);
    element("joints").textContent =
      jointText(finger.joint_values, this.scene?.fingers[number]?.joint_unit ?? "deg");
  }

  private showDevice(state: string, text: string, limited: boolean): void {
    this.device = { state, text, limited };
    document.body.dataset.device = state;
    document.body.dataset.limited = String(limited);
    this.tellDevice();
  }

  /** What is drawn late, or chosen after the program has gone, tells nothing of a device any more. */
  private tellDevice(): void {
    const known = this.connection !== "lost";
    element("device-state").textContent = known ? this.device.text : "unknown";
    element("device-state").dataset.tone = known ? toneOf(this.device.state, this.scene) : "";
    element("device-limited").hidden = !known || !this.device.limited;
  }

  private showContacts(contacts: number, samples: number): void {
    document.body.dataset.contacts = String(contacts);
    document.body.dataset.samples = String(samples);
    element("contacts").textContent = `${contacts}`;
    element("samples").textContent = `of ${samples}`;
  }

  /** One line over the views, which a screen reader reads as it changes. */
  private tell(): void {
    const line =
      this.connection === "lost" ? "No connection: the program has ended, or cannot be reached"
      : this.loading !== "" ? `Loading ${this.loading} …`
      : this.stopped.silence_ms > kSilence ? "Nothing is heard of the device: it may still press. Take it off"
      : this.stopped.asked && !this.stopped.confirmed ? "Stopping the device …"
      : this.stopped.asked ? (this.paused ? "Device stopped, run paused" : "Device stopped")
      : this.state === "paused" ? "Paused"
      : this.state === "finished" ? "End of the script"
      : "";
    setText(element("notice"), line);
    // That it goes on is seen; who does not see it has to be told.
    setText(element("announcer"), line === "" && this.state === "running" ? "Running" : "");
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

/** Unchanged, a live region stays silent. */
function setText(node: HTMLElement, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

const sum = (values: number[]) => values.reduce((a, b) => a + b, 0);

/** The first joints' values; a field of pins has too many to show. */
function jointText(values: Float32Array, unit: "deg" | "mm"): string {
  const shown = Array.from(values.slice(0, unit === "deg" ? 6 : 3),
    (value) => (unit === "deg" ? `${value.toFixed(0)}°` : `${value.toFixed(1)} mm`));
  return shown.join("  ") + (values.length > shown.length ? " …" : "");
}
