// Colours shared by the drawings, the plots and the style sheet.
export const palette = {
  contact: "#ff3b3f",
  free: "#3f86ff",
  skin: "#f2b79d",
  nail: "#f7d9cc",
  cut: "#a8604f",
  bone: "#efe6d2",
  object: "#9fb4d6",
  device: "#35d0bf",
  membrane: "#f2b84b",
  metal: "#aab4c3",
  cable: "#d7dde6",
  servo: "#3b4759",
  force: "#ff7a59",
  friction: "#9fb4d6",
  area: "#f2b84b",
  twin: "#35d0bf",
  pitch: "#35d0bf",
  roll: "#7aa7ff",
  travel: "#c792ea",
  step: "#8bd17c",
  match: "#e6db74",
  text: "#97a3b4",
  faint: "#8592a6",
  line: "#232b37",
  fingers: ["#ff7a59", "#f2b84b", "#8bd17c", "#7aa7ff", "#c792ea"],
  // Pressure from none to the most.
  pressure: ["#74243a", "#c2323c", "#ff7a45", "#ffe08a"],
} as const;

/** Between two colours as #rrggbb. */
export function mixed(from: string, to: string, share: number): string {
  const part = Math.max(0, Math.min(1, share));
  const parts = [1, 3, 5].map((k) => {
    const [a, b] = [from, to].map((color) => parseInt(color.slice(k, k + 2), 16));
    return Math.round(a! + (b! - a!) * part);
  });
  return `rgb(${parts.join(" ")})`;
}
