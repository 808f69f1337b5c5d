import type { FingerSnapshot, Scene, Skin, Snapshot } from "softfinger-client";
import { type DeviceMarks, noticeLines, showWarning } from "./device_marks";
import { palette } from "./palette";

interface Row {
  force: HTMLElement;
  contacts: HTMLElement;
  state: HTMLElement;
  limited: HTMLElement;
}

/** What stands beside the view of all fingers: what each touches, and how its device is. */
export class HandTable {
  private rows: Row[] = [];
  private told = ""; // what the rows stand for
  private scene: Scene | null = null;

  constructor(
    private readonly body: HTMLElement, private readonly notices: HTMLElement,
    private readonly choose: (finger: number) => void,
  ) {}

  /** The same fingers keep their rows, and with them the focus. */
  begin(scene: Scene, marks: DeviceMarks): void {
    this.scene = scene;
    const told = JSON.stringify([scene.fingers.map(({ name }) => name), scene.notices]);
    if (told === this.told) return;
    this.told = told;
    this.rows = [];
    this.body.replaceChildren(...scene.fingers.map(({ name }, i) => this.row(name, i, marks)));
    this.notices.replaceChildren(...scene.fingers.flatMap((_, i) =>
      noticeLines(marks.of(i), (finger) => scene.fingers[finger]?.name ?? "")));
  }

  show(snapshot: Snapshot, marks: DeviceMarks, now: number): void {
    this.rows.forEach((row, i) => {
      const finger = snapshot.fingers[i];
      if (!finger) return;
      row.force.textContent = finger.normal_force_N.toFixed(2);
      row.contacts.textContent = `${contactCount(finger)} of ${finger.in_contact.length}`;
      row.state.textContent = stateOf(finger);
      row.state.dataset.tone = toneOf(finger.device_state, this.scene);
      row.limited.hidden = !marks.isLimited(i, now);
    });
  }

  private row(name: string, index: number, marks: DeviceMarks): HTMLElement {
    const make = (tag: string, className = "") => Object.assign(document.createElement(tag), { className });
    const row = make("tr");
    row.dataset.row = name;
    const heading = make("th") as HTMLTableCellElement;
    heading.scope = "row";
    const button = make("button") as HTMLButtonElement;
    button.title = `Show the ${name} alone`;
    button.onclick = () => this.choose(index);
    const key = make("i");
    key.style.background = fingerColor(index);
    button.append(key, name);
    heading.append(button);
    const touch = make("td");
    const device = make("td");
    const cells = { force: make("b"), contacts: make("span"), state: make("span", "chip"), limited: make("span", "mark") };
    cells.limited.textContent = "force limit";
    cells.limited.title = "The device would advance further but for its limit of force";
    cells.limited.hidden = true;
    touch.append(cells.force, " N", make("br"), cells.contacts);
    const warning = make("span", "mark warning");
    showWarning(warning, marks.of(index));
    device.append(cells.state, cells.limited, warning);
    row.append(heading, touch, device);
    this.rows.push(cells);
    return row;
  }
}

export function fingerColor(index: number): string {
  return palette.fingers[index % palette.fingers.length]!;
}

export function contactCount(skin: Skin): number {
  let count = 0;
  for (const touching of skin.in_contact) count += touching;
  return count;
}

export function stateOf(finger: FingerSnapshot): string {
  return finger.device_state || "no device";
}

/** How much a state asks of a person; "" of a finger without a device. */
export function toneOf(state: string, scene: Scene | null): string {
  return scene?.device_states.find(({ name }) => name === state)?.tone ?? "";
}

/** Of several devices the state to know first, and how many are in it. */
export function commonState(fingers: FingerSnapshot[], scene: Scene | null): { state: string; text: string } {
  const states = fingers.map((finger) => finger.device_state).filter((state) => state !== "");
  if (states.length === 0) return { state: "", text: "no device" };
  const state = scene?.device_states.find(({ name }) => states.includes(name))?.name ?? states[0]!;
  const count = states.filter((other) => other === state).length;
  return { state, text: states.length > 1 ? `${count} of ${states.length} ${state}` : state };
}
