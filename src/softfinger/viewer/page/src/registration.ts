import type { Registration, Request, Scene } from "./wire";

const element = (id: string) => document.getElementById(id)!;
const input = (id: string) => element(id) as HTMLInputElement;

const kPostures: Record<string, string> = {
  pad: "Rest the pad flat on the table.",
  "left side": "Roll the finger onto its left side, as seen from above the nail.",
  "right side": "Roll it over onto its right side.",
  tip: "Stand it on its tip, straight up.",
};

/** The dialog that guides through a registration of the finger shown. */
export class RegistrationDialog {
  private finger = 0; // of the scene's

  constructor(private readonly send: (request: Request) => void) {
    element("register").onclick = () => this.show("ask");
    element("register-start").onclick = () => this.start();
    element("register-cancel").onclick = () => send({ request: "cancel_registration" });
    element("register-close").onclick = () => this.hide();
    element("register-done").onclick = () => send({ request: "cancel_registration" });
    // What is typed here is no command to the page, but Escape stops the device from everywhere.
    element("registration").addEventListener("keydown", (event) => {
      if (event.key !== "Escape") event.stopPropagation();
    });
  }

  begin(scene: Scene, number: number): void {
    this.finger = number;
    element("register").hidden = !scene.fingers[number]?.registrable;
  }

  update(state: Registration): void {
    document.body.dataset.registration = state.state;
    if (state.state === "running") {
      this.show("run");
      element("registration").dataset.posture = state.posture;
      element("register-step").textContent = `${Math.min(state.held + 1, state.of)} of ${state.of}`;
      element("register-posture").textContent = `${kPostures[state.posture] ?? ""} Hold still.`;
      element("register-progress").style.transform = `scaleX(${state.progress})`;
    } else if (state.state === "idle") {
      this.hide();
    } else {
      this.show("end");
      element("register-result").textContent =
        (state.state === "saved" ? "Saved: " : "Nothing was saved. ") + state.message + ".";
    }
  }

  private start(): void {
    const number = (id: string) => {
      const text = input(id).value.trim();
      return text === "" ? undefined : Number(text);
    };
    const request: Request = {
      request: "register",
      finger: this.finger,
      length_mm: number("register-length"),
      breadth_mm: number("register-breadth"),
      depth_mm: number("register-depth"),
      table_mm: number("register-table"),
    };
    const fields = ["register-length", "register-breadth", "register-depth", "register-table"];
    if (fields.every((id) => input(id).reportValidity())) this.send(request);
  }

  private show(step: "ask" | "run" | "end"): void {
    element("registration").hidden = false;
    for (const each of ["ask", "run", "end"]) element(`register-${each}`).hidden = each !== step;
  }

  private hide(): void {
    element("registration").hidden = true;
  }
}
