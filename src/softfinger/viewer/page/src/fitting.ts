import type { Fit, Request, Scene } from "softfinger-client";
import { GuidedDialog, setText } from "./guided_dialog";
import { kHand, type Shown } from "./shown";

const element = (id: string) => document.getElementById(id)!;

type Step = "ask" | "run" | "end";

const kWaits: Partial<Record<Fit["state"], string>> = { waiting: "Soon", estimating: "Estimating" };

/** The dialog that leads through a fit of the shown finger's device to its wearer. */
export class FitDialog {
  private readonly dialog = new GuidedDialog<Step>("fitting", "fit", { ask: "fit-start", run: "fit-stop", end: "fit-done" },
    (step) => (step === "ask" ? this.dialog.hide() : this.cancel()));
  private finger = 0; // of the scene's

  /** `stop`: stops all devices. */
  constructor(private readonly send: (request: Request) => void, stop: () => void) {
    element("fit").onclick = () => this.dialog.show("ask");
    element("fit-ask").onsubmit = (event) => {
      event.preventDefault();
      this.start(false);
    };
    element("fit-again").onclick = () => this.start(true);
    element("fit-stop").onclick = stop;
    element("fit-felt").onclick = () => this.felt();
    element("fitting").addEventListener("keydown", (event) => {
      // On a button of its own the space bar presses that.
      if (event.key !== " " || this.dialog.step !== "run" || event.target instanceof HTMLButtonElement) return;
      event.preventDefault();
      this.felt();
    });
    element("fit-close").onclick = () => this.dialog.hide();
    element("fit-done").onclick = () => this.cancel();
  }

  begin(scene: Scene, shown: Shown): void {
    this.finger = shown === kHand ? -1 : shown;
    const finger = shown === kHand ? undefined : scene.fingers[shown];
    element("fit").hidden = !finger?.fittable;
    this.showHow(finger?.fits_by_touch ?? false);
  }

  update(state: Fit): void {
    const begins = state.state === "pressing" && document.body.dataset.fit !== "pressing";
    document.body.dataset.fit = state.state;
    if (state.state === "pressing") this.showHow(state.by_touch);
    if (state.state === "idle") {
      this.dialog.hide();
    } else if (state.state === "saved" || state.state === "refused") {
      this.dialog.show("end");
      setText("fit-result", (state.state === "saved" ? "Saved: " : "Nothing was saved. ") + state.message + ".");
    } else {
      this.dialog.show("run");
      setText("fit-press", kWaits[state.state] ?? (state.press > 0 ? `${state.by_touch ? "Touch" : "Press"} ${state.press} of ${state.of}` : "Zero"));
      setText("fit-words", state.words);
      setText("fit-force", state.force_N.toFixed(2));
      element("fit-progress").style.transform = `scaleX(${state.progress})`;
      // Where the space bar tells a touch.
      if (begins && state.by_touch) element("fit-felt").focus();
    }
  }

  private felt(): void {
    this.send({ request: "felt" });
  }

  /** By presses on a force sensor, or by touches that the wearer tells. */
  private showHow(byTouch: boolean): void {
    element("fitting").dataset.how = byTouch ? "touch" : "press";
  }

  private start(again: boolean): void {
    this.send({ request: "fit", finger: this.finger, again });
  }

  private cancel(): void {
    this.send({ request: "cancel_fit" });
    this.dialog.hide();
  }
}
