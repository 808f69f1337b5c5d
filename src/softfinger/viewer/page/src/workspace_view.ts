import type { FingerDescription, Workspace } from "softfinger-client";
import { mixed, palette } from "./palette";
import { clearedContext, redrawOnResize } from "./sharp_canvas";
import { behindNumber, quantityOf } from "./units";

const kTrail = 45; // past configurations shown
const kFont = "10.5px Inter Variable, sans-serif";
const kColumnWidth = 34; // of the travel's column, px
const kBarHeight = 36; // of one axis with its words, px

type Point = [number, number];
type Draw = (context: CanvasRenderingContext2D, box: Box, q: Float32Array, trail: Float32Array[]) => void;
interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** What the device reaches, and where in it the commanded configuration is. */
export class WorkspaceView {
  private readonly draws: Draw;
  private readonly trail: Float32Array[] = [];

  constructor(private readonly canvas: HTMLCanvasElement, { workspace, configuration_names }: FingerDescription) {
    if (workspace.pitch_axis >= 0 && workspace.roll_axis >= 0) this.draws = tilts(workspace);
    else if (workspace.tilt_layers.length > 0) this.draws = oneTilt(workspace);
    else this.draws = reaches(workspace, configuration_names);
    const bars = workspace.tilt_layers.length === 0 && !mapOf(configuration_names);
    canvas.parentElement!.style.height = bars ? `${kBarHeight * workspace.reaches.length}px` : "";
    redrawOnResize(canvas, () => this.redraw());
  }

  /** Whether there is anything to show. */
  static has({ workspace }: FingerDescription): boolean {
    return workspace.tilt_layers.length > 0 || workspace.reaches.length > 0;
  }

  draw(q: Float32Array): void {
    if (q.length === 0) return;
    this.trail.push(q.slice());
    if (this.trail.length > kTrail) this.trail.shift();
    this.redraw();
  }

  private redraw(): void {
    const q = this.trail[this.trail.length - 1];
    if (!q) return;
    const context = clearedContext(this.canvas);
    if (!context) return;
    context.font = kFont;
    context.lineJoin = "round";
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.draws(context, { left: 0, top: 0, width, height }, q, this.trail);
  }
}

/** Pitch to the right, roll up; the region is that of the present travel. */
function tilts(workspace: Workspace): Draw {
  const { pitch_axis, roll_axis, travel_axis, tilt_layers: layers } = workspace;
  const most = Math.max(1, ...layers.flatMap((layer) => layer.tilts_deg));
  const step = most > 24 ? 10 : most > 10 ? 5 : 2;
  return (context, box, q, trail) => {
    const size = Math.min(box.width - kColumnWidth, box.height);
    const left = box.left + (box.width - kColumnWidth - size) / 2;
    const [cx, cy] = [left + size / 2, box.top + box.height / 2];
    const scale = (size / 2 - 12) / most;
    const place = (pitch: number, roll: number): Point => [cx + scale * pitch, cy - scale * roll];
    context.lineWidth = 1;
    context.strokeStyle = palette.line;
    for (let tilt = step; tilt <= most + 0.01; tilt += step) circle(context, [cx, cy], scale * tilt);
    line(context, place(-most, 0), place(most, 0));
    line(context, place(0, -most), place(0, most));
    const region = layerAt(layers, q[travel_axis]!).map((tilt, k, all): Point => {
      const direction = (2 * Math.PI * k) / all.length;
      return place(tilt * Math.cos(direction), tilt * Math.sin(direction));
    });
    polygon(context, region);
    label(context, "pitch", [cx + scale * most - 4, cy - 4], "right");
    label(context, "roll", [cx + 4, cy - scale * most + 13], "left");
    label(context, `${step}°`, [cx + scale * step + 1, cy + 11], "center");
    drawTrail(context, trail.map((past) => place(past[pitch_axis]!, past[roll_axis]!)));
    const column = { ...box, left: left + size + 8, width: kColumnWidth - 8 };
    travelColumn(context, column, layers, q[travel_axis]!);
  };
}

/** One tilt to the right, travel up. */
function oneTilt(workspace: Workspace): Draw {
  const { pitch_axis, roll_axis, travel_axis, tilt_layers: layers } = workspace;
  const axis = pitch_axis >= 0 ? pitch_axis : roll_axis;
  const most = Math.max(1, ...layers.flatMap((layer) => layer.tilts_deg));
  const [low, high] = [layers[0]!.travel_mm, layers[layers.length - 1]!.travel_mm];
  return (context, box, _q, trail) => {
    const place = (tilt: number, travel: number): Point => [
      box.left + box.width / 2 + (tilt / most) * (box.width / 2 - 6),
      box.top + box.height - 16 - ((travel - low) / (high - low || 1)) * (box.height - 24)];
    const half = layers[0]!.tilts_deg.length / 2;
    polygon(context, [
      ...layers.map((layer) => place(layer.tilts_deg[0]!, layer.travel_mm)),
      ...[...layers].reverse().map((layer) => place(-layer.tilts_deg[half]!, layer.travel_mm))]);
    context.strokeStyle = palette.line;
    line(context, place(0, low), place(0, high));
    label(context, `${axis === pitch_axis ? "pitch" : "roll"} ±${most.toFixed(0)}°`,
      [box.left + box.width, box.top + box.height - 3], "right");
    label(context, `travel ${low.toFixed(1)} to ${high.toFixed(1)} mm`,
      [box.left, box.top + box.height - 3], "left");
    drawTrail(context, trail.map((past) => place(past[axis]!, past[travel_axis]!)));
  };
}

/** A bar an axis; axes that are alike share one, and are told in a map where their names number them. */
function reaches(workspace: Workspace, names: string[]): Draw {
  const bars = workspace.reaches.map((reach) => {
    const own = names.indexOf(reach.name);
    return { ...reach, axes: own >= 0 ? [own] : names.map((_, k) => k) };
  });
  const map = mapOf(names);
  return (context, box, q, trail) => {
    const mapped = map && bars.length === 1;
    const top = mapped ? box.top + box.height - kBarHeight : box.top;
    const each = (box.top + box.height - top) / bars.length;
    bars.forEach((bar, k) => drawBar(context, bar, q, trail, {
      left: box.left, width: box.width, top: top + k * each, height: each }));
    if (!mapped) return;
    const cell = Math.min((top - box.top - 4) / map.rows, box.width / map.columns);
    const left = box.left + (box.width - cell * map.columns) / 2;
    // As on the finger seen from below: x up, y to the right.
    map.places.forEach(([row, column], k) => {
      const share = (q[k]! - bars[0]!.min) / (bars[0]!.max - bars[0]!.min || 1);
      context.fillStyle = mixed("#1b2733", palette.device, share);
      const gap = cell > 6 ? 1.5 : 0.5;
      context.beginPath();
      context.roundRect(left + column * cell + gap / 2, box.top + (map.rows - 1 - row) * cell + gap / 2,
        cell - gap, cell - gap, Math.min(3, cell / 4));
      context.fill();
    });
  };
}

interface Bar {
  name: string;
  min: number;
  max: number;
  axes: number[];
}

function drawBar(
  context: CanvasRenderingContext2D, bar: Bar, q: Float32Array, trail: Float32Array[], box: Box,
): void {
  const quantity = quantityOf(bar.name);
  const suffix = behindNumber(quantity.unit);
  const values = bar.axes.map((k) => q[k]!);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const thick = 7;
  const y = box.top + box.height / 2 + 1;
  const x = (value: number) =>
    box.left + 3 + (Math.max(0, Math.min(1, (value - bar.min) / (bar.max - bar.min || 1)))) * (box.width - 6);
  const text = values.length > 1 ? `${low.toFixed(1)} to ${high.toFixed(1)}${suffix}` : `${low.toFixed(1)}${suffix}`;
  label(context, values.length > 1 ? `${quantity.label}, ${values.length}` : quantity.label, [box.left, y - 5], "left");
  label(context, text, [box.left + box.width, y - 5], "right", "#e8edf4");
  context.fillStyle = `${palette.device}30`;
  context.strokeStyle = `${palette.device}90`;
  context.lineWidth = 1;
  context.beginPath();
  context.roundRect(box.left + 0.5, y, box.width - 1, thick, 3);
  context.fill();
  context.stroke();
  if (values.length > 1) {
    context.fillStyle = palette.device;
    context.beginPath();
    context.roundRect(x(low) - 1.5, y, x(high) - x(low) + 3, thick, 2);
    context.fill();
  } else {
    drawTrail(context, trail.map((past): Point => [x(past[bar.axes[0]!]!), y + thick / 2]));
  }
  label(context, bar.min.toFixed(0), [box.left, y + thick + 10], "left", palette.faint);
  label(context, bar.max.toFixed(0), [box.left + box.width, y + thick + 10], "right", palette.faint);
}

/** Rows and columns of axes named height_ROW_COLUMN_mm; null where they are not. */
function mapOf(names: string[]): { rows: number; columns: number; places: [number, number][] } | null {
  const places: [number, number][] = [];
  for (const name of names) {
    const found = /_(\d+)_(\d+)_mm$/.exec(name);
    if (!found) return null;
    places.push([Number(found[1]), Number(found[2])]);
  }
  return {
    rows: 1 + Math.max(...places.map(([row]) => row)),
    columns: 1 + Math.max(...places.map(([, column]) => column)), places,
  };
}

/** Tilts between the two layers that the travel lies between. */
function layerAt(layers: Workspace["tilt_layers"], travel: number): number[] {
  const above = layers.findIndex((layer) => layer.travel_mm >= travel);
  if (above < 0) return layers[layers.length - 1]!.tilts_deg;
  if (above === 0) return layers[0]!.tilts_deg;
  const [a, b] = [layers[above - 1]!, layers[above]!];
  const part = (travel - a.travel_mm) / (b.travel_mm - a.travel_mm || 1);
  return a.tilts_deg.map((tilt, k) => tilt + part * (b.tilts_deg[k]! - tilt));
}

function travelColumn(
  context: CanvasRenderingContext2D, box: Box, layers: Workspace["tilt_layers"], travel: number,
): void {
  const [low, high] = [layers[0]!.travel_mm, layers[layers.length - 1]!.travel_mm];
  const [top, bottom] = [box.top + 15, box.top + box.height - 15];
  const x = box.left + box.width / 2;
  context.fillStyle = `${palette.travel}2a`;
  context.strokeStyle = `${palette.travel}90`;
  context.lineWidth = 1;
  context.beginPath();
  context.roundRect(x - 3.5, top, 7, bottom - top, 3);
  context.fill();
  context.stroke();
  const share = Math.max(0, Math.min(1, (travel - low) / (high - low || 1)));
  dot(context, [x, bottom - share * (bottom - top)], palette.travel);
  label(context, high.toFixed(1), [x, top - 5], "center");
  label(context, low.toFixed(1), [x, bottom + 12], "center");
}

function drawTrail(context: CanvasRenderingContext2D, points: Point[]): void {
  for (let k = 1; k < points.length; ++k) {
    context.globalAlpha = (0.7 * k) / points.length;
    context.strokeStyle = palette.device;
    context.lineWidth = 1.5;
    line(context, points[k - 1]!, points[k]!);
  }
  context.globalAlpha = 1;
  dot(context, points[points.length - 1]!, "#ffffff");
}

function polygon(context: CanvasRenderingContext2D, points: Point[]): void {
  context.beginPath();
  points.forEach(([x, y], k) => (k === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.closePath();
  context.fillStyle = `${palette.device}26`;
  context.strokeStyle = `${palette.device}b0`;
  context.lineWidth = 1.25;
  context.fill();
  context.stroke();
}

function line(context: CanvasRenderingContext2D, from: Point, to: Point): void {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}

function circle(context: CanvasRenderingContext2D, centre: Point, radius: number): void {
  context.beginPath();
  context.arc(...centre, radius, 0, 2 * Math.PI);
  context.stroke();
}

function dot(context: CanvasRenderingContext2D, at: Point, color: string): void {
  context.beginPath();
  context.arc(...at, 3.6, 0, 2 * Math.PI);
  context.fillStyle = color;
  context.fill();
  context.strokeStyle = "#0b0e13";
  context.lineWidth = 1;
  context.stroke();
}

function label(
  context: CanvasRenderingContext2D, text: string, at: Point, align: CanvasTextAlign,
  color: string = palette.text,
): void {
  context.fillStyle = color;
  context.textAlign = align;
  context.fillText(text, ...at);
}
