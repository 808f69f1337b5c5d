import type { Registration, Request, Scene } from "softfinger-client";
import { kHand, type Shown } from "./shown";

const element = (id: string) => document.getElementById(id)!;
const input = (id: string) => element(id) as HTMLInputElement;

type Step = "ask" | "run" | "end";
const kFirst: Record<Step, string> = { ask: "register-length", run: "register-cancel", end: "register-done" };

/** The dialog that guides through a registration of the finger shown. It keeps the focus until it is closed. */
export class RegistrationDialog {
  private readonly dialog = element("registration");
  private finger = 0; // of the scene's
  private step: Step | null = null; // null: closed
  private before: Element | null = null; // what had the focus

  constructor(private readonly send: (request: Request) => void) {
    element("register").onclick = () => this.show("ask");
    element("register-ask").onsubmit = (event) => {
      event.preventDefault();
      this.start();
    };
    element("register-cancel").onclick = () => this.cancel();
    element("register-close").onclick = () => this.hide();
    element("register-done").onclick = () => this.cancel();
    // What is typed here is no command to the page, but Escape stops the device from everywhere, and closes too.
    this.dialog.addEventListener("keydown", (event) => {
      if (event.key === "Escape") return this.step === "ask" ? this.hide() : this.cancel();
      if (event.key === "Tab") this.keepFocus(event);
      event.stopPropagation();
    });
  }

  begin(scene: Scene, shown: Shown): void {
    this.finger = shown === kHand ? -1 : shown;
    element("register").hidden = shown === kHand || !scene.fingers[shown]?.registrable;
  }

  update(state: Registration): void {
    document.body.dataset.registration = state.state;
    if (state.state === "running") {
      this.show("run");
      this.dialog.dataset.posture = state.posture;
      setText("register-step", `${Math.min(state.held + 1, state.of)} of ${state.of}`);
      setText("register-posture", `${state.words} Hold still.`);
      element("register-progress").style.transform = `scaleX(${state.progress})`;
    } else if (state.state === "idle") {
      this.hide();
    } else {
      this.show("end");
      setText("register-result", (state.state === "saved" ? "Saved: " : "Nothing was saved. ") + state.message + ".");
    }
  }

  private start(): void {
    const number = (id: string) => {
      const text = input(id).value.trim();
      return text === "" ? undefined : Number(text);
    };
    this.send({
      request: "register",
      finger: this.finger,
      length_mm: number("register-length"),
      breadth_mm: number("register-breadth"),
      depth_mm: number("register-depth"),
      table_mm: number("register-table"),
    });
  }

  private cancel(): void {
    this.send({ request: "cancel_registration" });
    this.hide();
  }

  private show(step: Step): void {
    if (this.step === step) return;
    if (this.step === null) this.before = document.activeElement;
    this.step = step;
    this.dialog.hidden = false;
    for (const each of ["ask", "run", "end"]) element(`register-${each}`).hidden = each !== step;
    setText("registration-title", step === "ask" ? "Register this finger" : "Registration");
    element(kFirst[step]).focus();
  }

  private hide(): void {
    if (this.step === null) return;
    this.step = null;
    this.dialog.hidden = true;
    const register = element("register");
    const back = this.before instanceof HTMLElement && this.before.isConnected && this.before !== document.body
      ? this.before : register.hidden ? element("stop") : register;
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

function setText(id: string, text: string): void {
  const node = element(id);
  if (node.textContent !== text) node.textContent = text;
}
