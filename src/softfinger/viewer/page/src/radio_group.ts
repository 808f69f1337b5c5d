/** Buttons of which one is chosen; arrow keys move through them, Tab comes to one alone. */
export class RadioGroup {
  private names: string[] = [];
  private buttons: HTMLButtonElement[] = [];

  /** `kind` names what is chosen, for style and tests: data-KIND of each button. */
  constructor(
    private readonly group: HTMLElement, private readonly kind: string,
    private readonly choose: (index: number) => void,
  ) {
    group.addEventListener("keydown", (event) => this.move(event));
    new ResizeObserver(() => this.reveal()).observe(group);
  }

  /** The same names keep their buttons, and with them the focus. */
  show(names: string[], checked: number): void {
    if (names.length !== this.names.length || names.some((name, i) => name !== this.names[i])) {
      this.names = [...names];
      this.buttons = names.map((name, i) => this.button(name, i));
      this.group.replaceChildren(...this.buttons);
    }
    this.buttons.forEach((button, i) => {
      button.setAttribute("aria-checked", String(i === checked));
      button.tabIndex = i === Math.max(checked, 0) ? 0 : -1;
    });
    this.reveal();
  }

  private button(name: string, index: number): HTMLButtonElement {
    const button = document.createElement("button");
    button.textContent = name;
    button.dataset[this.kind] = name;
    button.setAttribute("role", "radio");
    button.onclick = () => button.getAttribute("aria-checked") !== "true" && this.choose(index);
    return button;
  }

  private move(event: KeyboardEvent): void {
    const at = this.buttons.indexOf(event.target as HTMLButtonElement);
    if (at < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
    const last = this.buttons.length - 1;
    const to = {
      ArrowRight: at + 1, ArrowDown: at + 1, ArrowLeft: at - 1, ArrowUp: at - 1, Home: 0, End: last,
    }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    event.stopPropagation(); // the same keys move the finger
    const next = to < 0 ? last : to > last ? 0 : to;
    this.buttons[next]!.focus();
    this.choose(next);
  }

  /** Where there are more than fit, the one chosen is in sight. */
  private reveal(): void {
    const checked = this.buttons.find((button) => button.getAttribute("aria-checked") === "true");
    if (!checked || this.group.scrollWidth <= this.group.clientWidth) return;
    this.group.scrollLeft = checked.offsetLeft - this.group.offsetLeft - (this.group.clientWidth - checked.offsetWidth) / 2;
  }
}
