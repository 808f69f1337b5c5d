const element = (id: string) => document.getElementById(id)!;

/** A dialog that leads through steps, of which one is seen. It keeps the focus until it is closed. */
export class GuidedDialog<Step extends string> {
  private readonly dialog: HTMLElement;
  private now: Step | null = null; // null: closed
  private before: Element | null = null; // what had the focus

  /**
   * Of the element `id`, opened by the button `name`; the steps are the elements `name`-STEP, each with what gets the
   * focus first. What is typed in it is no command to the page, but Escape stops the device from everywhere; here it is
   * `escape` too.
   */
  constructor(id: string, private readonly name: string, private readonly first: Record<Step, string>, escape: (step: Step) => void) {
    this.dialog = element(id);
    this.dialog.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.now) return escape(this.now);
      if (event.key === "Tab") this.keepFocus(event);
      event.stopPropagation();
    });
  }

  get step(): Step | null {
    return this.now;
  }

  show(step: Step): void {
    if (this.now === step) return;
    if (this.now === null) this.before = document.activeElement;
    this.now = step;
    this.dialog.hidden = false;
    for (const each of Object.keys(this.first)) element(`${this.name}-${each}`).hidden = each !== step;
    element(this.first[step]).focus();
  }

  hide(): void {
    if (this.now === null) return;
    this.now = null;
    this.dialog.hidden = true;
    const opener = element(this.name);
    const back = this.before instanceof HTMLElement && this.before.isConnected && this.before !== document.body
      ? this.before : opener.hidden ? element("stop") : opener;
    back.focus();
  }

  /** Tab goes round within. */
  private keepFocus(event: KeyboardEvent): void {
    const inside = [...this.dialog.querySelectorAll<HTMLElement>("input, button")].filter((one) => one.offsetParent !== null);
    const [first, last] = [inside[0], inside[inside.length - 1]];
    const at = document.activeElement;
    if (event.shiftKey ? at === first || at === this.dialog : at === last) {
      event.preventDefault();
      (event.shiftKey ? last : first)?.focus();
    }
  }
}

export function setText(id: string, text: string): void {
  const node = element(id);
  if (node.textContent !== text) node.textContent = text;
}
