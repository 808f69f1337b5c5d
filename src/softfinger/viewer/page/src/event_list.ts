import type { Events } from "softfinger-client";

const kStays = 4000; // ms
const kMost = 5;

/** What happened to objects last, each for a while. */
export class EventList {
  constructor(private readonly list: HTMLElement) {}

  add({ kind, object, other, impulse_N_s }: Events["events"][number]): void {
    const item = document.createElement("li");
    const word = document.createElement("b");
    word.textContent = kind;
    const strength = impulse_N_s === null ? "" : `, ${(1e3 * impulse_N_s).toPrecision(2)} mN s`;
    item.append(word, ` ${other === null ? object : `${object} and ${other}`}${strength}`);
    this.list.append(item);
    while (this.list.children.length > kMost) this.list.firstElementChild?.remove();
    setTimeout(() => item.remove(), kStays);
  }
}
