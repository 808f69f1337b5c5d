const kStays = 15_000; // ms
const kMost = 4;

/** The last lines that people were told, each for a while. */
export class Notifications {
  constructor(private readonly list: HTMLElement) {}

  add(line: string): void {
    const item = document.createElement("li");
    item.textContent = line;
    this.list.append(item);
    while (this.list.children.length > kMost) this.list.firstElementChild?.remove();
    setTimeout(() => item.remove(), kStays);
  }
}
