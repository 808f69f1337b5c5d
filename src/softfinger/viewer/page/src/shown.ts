// What of a scene is shown, kept in the page's address so that a reload shows it again: #hand, #finger=thumb.
import type { Scene } from "softfinger-client";

export const kHand = "hand";

/** The number of a finger, or all of them: what several are shown as unless the address says otherwise. */
export type Shown = number | typeof kHand;

export function shownByAddress(scene: Scene): Shown {
  const several = scene.fingers.length > 1;
  const [, name] = /^#finger=(.*)$/.exec(location.hash) ?? [];
  const finger = name === undefined ? -1 : scene.fingers.findIndex((one) => one.name === decoded(name));
  if (finger >= 0) return finger;
  return several ? kHand : 0;
}

export function keepInAddress(scene: Scene, shown: Shown): void {
  const hash = shown === kHand ? "#hand" : `#finger=${encodeURIComponent(scene.fingers[shown]!.name)}`;
  history.replaceState(null, "", location.pathname + location.search + hash);
}

function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}
