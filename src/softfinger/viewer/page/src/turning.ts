import { Spherical } from "three";
import type { View } from "./stage";

const kTurn = 0.12; // rad a key
const kNearer = 0.9; // of the distance

/** Turns a view by keys, for whom Tab has brought to it; who clicked it means other things by arrow keys. */
export function turnByKeys(view: View, reset: () => void): void {
  const { pane } = view;
  let byKeyboard = false;
  pane.addEventListener("focus", () => (byKeyboard = pane.matches(":focus-visible")));
  pane.addEventListener("pointerdown", () => (byKeyboard = false));
  pane.addEventListener("keydown", (event) => {
    if (!byKeyboard || event.ctrlKey || event.metaKey || event.altKey) return;
    const angles = view.angles();
    const [theta, phi, nearer] = {
      ArrowLeft: [-kTurn, 0, 1], ArrowRight: [kTurn, 0, 1], ArrowUp: [0, -kTurn, 1], ArrowDown: [0, kTurn, 1],
      "+": [0, 0, kNearer], "=": [0, 0, kNearer], "-": [0, 0, 1 / kNearer],
    }[event.key] ?? [0, 0, 0];
    if (event.key === "Home") reset();
    else if (nearer === 0) return;
    else view.lookFrom(new Spherical(angles.radius * nearer!, Math.min(Math.max(angles.phi + phi!, 0.05), Math.PI - 0.05), angles.theta + theta!));
    event.preventDefault();
    event.stopPropagation();
  });
}

