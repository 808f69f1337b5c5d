import type { Request, Snapshot } from "softfinger-client";

const element = (id: string) => document.getElementById(id)!;

/**
 * Stop and release, two controls. Stop only ever stops, however often it is pressed. Release asks, and names the stop
 * that was seen: one that came since stays.
 */
export class Stopping {
  private seen = { generation: 0, stops: 0 };
  private asked = false; // somebody wants to release

  constructor(private readonly actions: { stop(): void; send(request: Request): void }) {
    element("stop").onclick = () => this.stop();
    element("release").onclick = () => this.ask(true);
    element("release-keep").onclick = () => this.ask(false);
    element("release-now").onclick = () => {
      this.ask(false);
      actions.send({ request: "release", ...this.seen });
    };
    element("release-ask").addEventListener("keydown", (event) => {
      if (event.key !== "Escape") event.stopPropagation(); // no command to the page
    });
  }

  stop(): void {
    this.ask(false);
    this.actions.stop();
  }

  show(snapshot: Snapshot): void {
    // A stop that came since the question was put is not what the answer is about.
    if (this.asked && (snapshot.stops !== this.seen.stops || snapshot.generation !== this.seen.generation)) this.ask(false);
    this.seen = { generation: snapshot.generation, stops: snapshot.stops };
    const released = element("release").hidden;
    if (released !== !snapshot.stopped) {
      if (!snapshot.stopped) this.ask(false);
      if (document.activeElement === element("release")) element("stop").focus();
      element("release").hidden = !snapshot.stopped;
    }
    document.body.dataset.stopped = String(snapshot.stopped);
    document.body.dataset.stopConfirmed = String(snapshot.stopped && snapshot.stop_confirmed);
  }

  private ask(asked: boolean): void {
    if (this.asked === asked) return;
    this.asked = asked;
    element("release-ask").hidden = !asked;
    element(asked ? "release-keep" : "release").focus();
  }
}
