import type { FingerDescription, Skin } from "softfinger-client";
import { mixed, palette } from "./palette";
import { clearedContext, redrawOnResize } from "./sharp_canvas";

const kPieces = 4; // a triangle's side is cut into so many
const kScales = [5, 10, 20, 50, 100, 200, 500, 1000]; // kPa; what the colours may reach to
const kTypical = 0.85; // share of the samples in contact whose pressure the colours tell apart
const kMemory = 2; // s; how long a scale outlives the pressure that wanted it

/**
 * The finger pad from below, fingertip up, at rest: where the skin touches, in the colour of its
 * pressure. Several can share one drawing of the pad, and one scale of pressure.
 */
export class Pad {
  /** Points of the picture, mm, right and up; one a sample. */
  readonly points: [number, number][];
  readonly triangles: [number, number, number][];
  readonly low: [number, number] = [Infinity, Infinity];
  readonly high: [number, number] = [-Infinity, -Infinity];
  /** Pressure of the last colour, kPa: a round number above all but a few there were lately. */
  most = kScales[0]!;
  private peak = 0;

  constructor({ skin_positions_mm: p, skin_triangles: t }: FingerDescription) {
    // Seen from below with x up, y goes to the right.
    this.points = Array.from({ length: p.length / 3 }, (_, i) => [p[3 * i + 1]!, p[3 * i]!]);
    this.triangles = [];
    for (let k = 0; k < t.length; k += 3) {
      const [a, b, c] = [t[k]!, t[k + 1]!, t[k + 2]!];
      if (this.facesDown(a, b, c)) this.triangles.push([a, b, c]);
    }
    for (const i of this.triangles.flat()) {
      for (const axis of [0, 1] as const) {
        this.low[axis] = Math.min(this.low[axis], this.points[i]![axis]);
        this.high[axis] = Math.max(this.high[axis], this.points[i]![axis]);
      }
    }
  }

  /** Adapts the scale to what is shown `elapsed` s after the last. */
  notice(skins: Skin[], elapsed: number): void {
    this.peak *= Math.exp(-Math.max(0, elapsed) / kMemory);
    for (const skin of skins) {
      const pressures = skin.pressures_kPa.filter((_, i) => skin.in_contact[i]).sort();
      const typical = pressures[Math.floor(kTypical * pressures.length)] ?? 0;
      this.peak = Math.max(this.peak, typical);
    }
    this.most = kScales.find((scale) => scale >= this.peak) ?? this.peak;
  }

  /** Outward triangles are counter-clockwise from outside, so mirrored here they are as well. */
  private facesDown(a: number, b: number, c: number): boolean {
    const [ax, ay] = this.points[a]!, [bx, by] = this.points[b]!, [cx, cy] = this.points[c]!;
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0;
  }
}

export class PatchView {
  private drawn: { pad: Pad; skin: Skin | null } | null = null;

  constructor(private readonly canvas: HTMLCanvasElement) {
    redrawOnResize(canvas, () => this.drawn && this.draw(this.drawn.pad, this.drawn.skin));
  }

  draw(pad: Pad, skin: Skin | null): void {
    this.drawn = { pad, skin };
    const context = clearedContext(this.canvas);
    if (!context) return;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const [w, h] = [pad.high[0] - pad.low[0], pad.high[1] - pad.low[1]];
    const scale = Math.min((width - 8) / w, (height - 8) / h);
    const left = (width - scale * w) / 2 - scale * pad.low[0];
    const bottom = (height + scale * h) / 2 + scale * pad.low[1];
    const at = pad.points.map(([x, y]): [number, number] => [left + scale * x, bottom - scale * y]);

    context.lineJoin = "round";
    fill(context, "#3a2f2e", pad.triangles.map((corners) => corners.map((i) => at[i]!)));
    if (skin && skin.in_contact.length === at.length) this.drawContact(context, pad, skin, at);
  }

  private drawContact(
    context: CanvasRenderingContext2D, pad: Pad, skin: Skin, at: [number, number][],
  ): void {
    for (const corners of pad.triangles) {
      if (corners.some((i) => skin.in_contact[i])) {
        drawPressure(context, corners.map((i) => at[i]!),
          corners.map((i) => (skin.in_contact[i] ? skin.pressures_kPa[i]! / pad.most : 0)),
          corners.map((i) => (skin.in_contact[i] ? 1 : 0)));
      }
    }
    const shown = new Set(pad.triangles.flat());
    for (const i of shown) {
      const touching = skin.in_contact[i] !== 0;
      context.beginPath();
      context.arc(at[i]![0], at[i]![1], touching ? 2.6 : 1.1, 0, 2 * Math.PI);
      context.fillStyle = touching ? pressureColor(skin.pressures_kPa[i]! / pad.most) : palette.free;
      context.fill();
      if (!touching) continue;
      context.strokeStyle = "#fff";
      context.lineWidth = 0.9;
      context.stroke();
    }
  }
}

/** Colour of a pressure as a share of the most. */
export function pressureColor(share: number): string {
  const stops = palette.pressure;
  const place = Math.max(0, Math.min(1, share)) * (stops.length - 1);
  const first = Math.min(Math.floor(place), stops.length - 2);
  return mixed(stops[first]!, stops[first + 1]!, place - first);
}

function fill(context: CanvasRenderingContext2D, color: string, shapes: [number, number][][]): void {
  context.beginPath();
  for (const shape of shapes) {
    shape.forEach(([x, y], k) => (k === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
    context.closePath();
  }
  context.fillStyle = context.strokeStyle = color;
  context.lineWidth = 0.8; // hides the seams
  context.fill();
  context.stroke();
}

/** One triangle in small ones, each of one colour; `share` and `contact` at its corners. */
function drawPressure(
  context: CanvasRenderingContext2D, corners: [number, number][], share: number[], contact: number[],
): void {
  const mix = (values: number[], u: number, v: number) =>
    values[0]! * (1 - u - v) + values[1]! * u + values[2]! * v;
  const point = (i: number, j: number): [number, number] => [0, 1].map((axis) =>
    mix(corners.map((corner) => corner[axis]!), i / kPieces, j / kPieces)) as [number, number];
  const one = (a: [number, number], b: [number, number], c: [number, number]) => {
    const [u, v] = [(a[0] + b[0] + c[0]) / 3 / kPieces, (a[1] + b[1] + c[1]) / 3 / kPieces];
    if (mix(contact, u, v) < 0.5) return; // nearer to a free sample
    fill(context, pressureColor(mix(share, u, v)), [[point(...a), point(...b), point(...c)]]);
  };
  for (let i = 0; i < kPieces; ++i) {
    for (let j = 0; j < kPieces - i; ++j) {
      one([i, j], [i + 1, j], [i, j + 1]);
      if (i + j < kPieces - 1) one([i + 1, j], [i + 1, j + 1], [i, j + 1]);
    }
  }
}
