import type { FingerSnapshot, Request, Scene } from "softfinger-client";

const kAnswered = 1500; // ms; by then the program has obeyed, or will not

/** What leads the device of the finger shown, and a choice of what else can. */
export class ObjectiveChoice {
  private readonly select = document.getElementById("objective") as HTMLSelectElement;
  private readonly row = document.getElementById("objective-row")!;
  private scene: Scene | null = null;
  private finger = -1;
  private asked = -Infinity; // when

  constructor(send: (request: Request) => void) {
    this.select.onchange = () => {
      this.asked = performance.now();
      send({ request: "objective", finger: this.finger, objective: this.select.value });
    };
  }

  /** A scene, and which of its fingers; -1: none alone. */
  begin(scene: Scene, finger: number): void {
    this.scene = scene;
    this.finger = finger;
    this.asked = -Infinity;
    const places = scene.fingers[finger]?.objectives ?? [];
    this.row.hidden = places.length === 0;
    document.body.dataset.objective = "";
    this.select.replaceChildren(...places.map((place) => {
      const { name, words } = scene.objectives[place]!;
      return new Option(words, name);
    }));
  }

  /** What is chosen stays so until the program says what it made of it. */
  show(snapshot: FingerSnapshot): void {
    const name = this.scene?.objectives[snapshot.objective]?.name;
    if (name === undefined || this.row.hidden) return;
    document.body.dataset.objective = name;
    if (name === this.select.value) this.asked = -Infinity;
    else if (performance.now() - this.asked > kAnswered) this.select.value = name;
  }
}
