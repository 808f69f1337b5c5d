import type { Registration, Request, Scene } from "softfinger-client";
import { GuidedDialog, setText } from "./guided_dialog";
import { kHand, type Shown } from "./shown";

const element = (id: string) => document.getElementById(id)!;
const input = (id: string) => element(id) as HTMLInputElement;

type Step = "ask" | "run" | "end";

/** The dialog that guides through a registration of the finger shown. */
export class RegistrationDialog {
  private readonly dialog = new GuidedDialog<Step>("registration", "register",
    { ask: "register-length", run: "register-cancel", end: "register-done" },
    (step) => (step === "ask" ? this.dialog.hide() : this.cancel()));
  private finger = 0; // of the scene's

  constructor(private readonly send: (request: Request) => void) {
    element("register").onclick = () => this.show("ask");
    element("register-ask").onsubmit = (event) => {
      event.preventDefault();
      this.start();
    };
    element("register-cancel").onclick = () => this.cancel();
    element("register-close").onclick = () => this.dialog.hide();
    element("register-done").onclick = () => this.cancel();
  }

  begin(scene: Scene, shown: Shown): void {
    this.finger = shown === kHand ? -1 : shown;
    element("register").hidden = shown === kHand || !scene.fingers[shown]?.registrable;
  }

  update(state: Registration): void {
    document.body.dataset.registration = state.state;
    if (state.state === "running") {
      this.show("run");
      element("registration").dataset.posture = state.posture;
      setText("register-step", `${Math.min(state.held + 1, state.of)} of ${state.of}`);
      setText("register-posture", `${state.words} Hold still.`);
      element("register-progress").style.transform = `scaleX(${state.progress})`;
    } else if (state.state === "idle") {
      this.dialog.hide();
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
    this.dialog.hide();
  }

  private show(step: Step): void {
    setText("registration-title", step === "ask" ? "Register this finger" : "Registration");
    this.dialog.show(step);
  }
}
