/** A 2D canvas with one unit a CSS pixel, as sharp as the screen is, cleared; null while it has no size. */
export function clearedContext(canvas: HTMLCanvasElement): CanvasRenderingContext2D | null {
  const { clientWidth: width, clientHeight: height } = canvas;
  if (width < 1 || height < 1) return null;
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d")!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

const redraws = new WeakMap<Element, () => void>();
const observer = new ResizeObserver((entries) => entries.forEach(({ target }) => redraws.get(target)?.()));

/** Calls `draw`, and no earlier one of that canvas, when its size changes: also where nothing new comes to draw. */
export function redrawOnResize(canvas: HTMLCanvasElement, draw: () => void): void {
  redraws.set(canvas, draw);
  observer.observe(canvas);
}
