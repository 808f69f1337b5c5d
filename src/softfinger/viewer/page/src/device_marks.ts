import type { Notice, Scene, Snapshot } from "softfinger-client";

const kHeld = 600; // ms that a mark stays after what it tells has ended: long enough to be read

/** What a person must know beside a device's state: what is wrong with it, and what holds it back now. */
export class DeviceMarks {
  private notices: Notice[] = [];
  private limited: number[] = []; // ms, when each finger's device was last held back

  begin(scene: Scene): void {
    this.notices = scene.notices;
    this.limited = scene.fingers.map(() => -Infinity);
  }

  see(snapshot: Snapshot, now: number): void {
    snapshot.fingers.forEach((finger, i) => {
      if (finger.force_limited) this.limited[i] = now;
    });
  }

  isLimited(finger: number, now: number): boolean {
    return now - (this.limited[finger] ?? -Infinity) < kHeld;
  }

  of(finger: number): Notice[] {
    return this.notices.filter((notice) => notice.finger === finger);
  }
}

/** Lines of notices; `whose` names a finger where there are several. */
export function noticeLines(notices: Notice[], whose: (finger: number) => string): HTMLElement[] {
  return notices.map(({ finger, kind, text }) => {
    const item = document.createElement("li");
    item.dataset.kind = kind;
    const title = document.createElement("b");
    const words = [whose(finger), kind.replaceAll("_", " ")].filter((part) => part !== "").join(", ");
    title.textContent = words.charAt(0).toUpperCase() + words.slice(1);
    item.append(title, `: ${text}`);
    return item;
  });
}

/** The sign that there are notices. */
export function showWarning(mark: HTMLElement, notices: Notice[]): void {
  mark.hidden = notices.length === 0;
  mark.textContent = notices.length === 0 ? "" : notices.length > 1 ? `⚠ ${notices.length} warnings` : "⚠ warning";
  mark.title = notices.map(({ text }) => text).join("\n");
}
