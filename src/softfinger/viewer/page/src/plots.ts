import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { FingerDescription, FingerSnapshot, Scene, Snapshot, Twin } from "softfinger-client";
import { LatencyView } from "./latency_view";
import { palette } from "./palette";
import { fingerColor } from "./hand_table";
import { kHand, type Shown } from "./shown";
import { behindNumber, quantityOf } from "./units";

const kWindow = 10; // s of simulated time shown
const kCapacity = 1500;

interface Curve {
  label: string;
  unit: string;
  color: string;
  digits: number;
  scale?: "right";
  filled?: boolean;
  dashed?: boolean; // and without a value of its own in the header
  value(finger: FingerSnapshot, snapshot: Snapshot): number;
}
interface PlotDescription {
  id: string;
  title: string;
  curves: Curve[];
  /** The scale always shows at least this range. */
  range: [number, number];
  rightRange?: [number, number];
  /** Too small for axes. */
  small?: boolean;
}

const q = (index: number) => (finger: FingerSnapshot) => finger.configuration[index] ?? 0;
const actual = (index: number) => (finger: FingerSnapshot) => finger.actual[index] ?? NaN;

const kCurveColors = [palette.pitch, palette.roll, palette.travel];
const kMostAxes = 6; // more are told by their extremes

/** Three axes, or the extremes of many. Angles have the left scale, lengths beside them the right. */
function configurationPlot({ configuration_names: names, workspace }: FingerDescription): PlotDescription {
  const plot = { id: "configuration", title: "Configuration q" };
  if (names.length > kMostAxes) {
    const among = (choose: (...values: number[]) => number) => (finger: FingerSnapshot) =>
      choose(...finger.configuration);
    const mean = (...values: number[]) => values.reduce((a, b) => a + b, 0) / values.length;
    const curve = (label: string, color: string, value: Curve["value"]): Curve =>
      ({ label, unit: "mm", color, digits: 2, value });
    return { ...plot, range: [0, 1], curves: [
      curve("highest", palette.pitch, among(Math.max)), curve("mean", palette.roll, among(mean)),
      curve("lowest", palette.travel, among(Math.min))] };
  }
  const told = [workspace.pitch_axis, workspace.roll_axis, workspace.travel_axis].filter((k) => k >= 0);
  const axes = told.length > 0 ? told : names.slice(0, 3).map((_, k) => k);
  const hasAngles = axes.some((k) => quantityOf(names[k]!).unit === "°");
  const curves = axes.flatMap((k, i): Curve[] => {
    const { label, unit } = quantityOf(names[k]!);
    const commanded: Curve = {
      label, unit, color: kCurveColors[i]!,
      digits: unit === "°" ? 1 : 2, scale: hasAngles && unit === "mm" ? "right" : undefined, value: q(k),
    };
    return [commanded, { ...commanded, dashed: true, value: actual(k) }];
  });
  return hasAngles
    ? { ...plot, curves, range: [-6, 6], rightRange: [0, 4] } : { ...plot, curves, range: [0, 1] };
}

const twin = (value: (twin: Twin) => number) => (finger: FingerSnapshot) =>
  finger.twin ? value(finger.twin) : NaN;

/** What is drawn for the loop itself; the twin's force and area beside the virtual ones. */
function loopPlots(finger: FingerDescription): PlotDescription[] {
  const hasTwin = finger.twin;
  const force: Curve = { label: hasTwin ? "virtual" : "normal", unit: "N", color: palette.force, digits: 2,
    filled: true, value: (f) => f.normal_force_N };
  const area: Curve = { label: hasTwin ? "virtual" : "", unit: "mm²", color: palette.area, digits: 0,
    filled: true, value: (f) => f.contact_area_mm2 };
  const twins = (curve: Curve, value: (twin: Twin) => number): Curve[] =>
    hasTwin ? [{ ...curve, label: "twin", color: palette.twin, filled: false, value: twin(value) }] : [];
  return [
    {
      id: "force", title: "Force", range: [0, 1],
      curves: [
        force,
        ...twins(force, (t) => t.normal_force_N),
        { label: "friction", unit: "N", color: palette.friction, digits: 2,
          value: (f) => f.tangential_force_N },
      ],
    },
    {
      id: "area", title: "Contact area", range: [0, 40],
      curves: [area, ...twins(area, (t) => t.contact_area_mm2)],
    },
    configurationPlot(finger),
    kComputingTime,
  ];
}

const kComputingTime: PlotDescription = {
  id: "step", title: "Computing time", range: [0, 0.25],
  curves: [
    { label: "step", unit: "ms", color: palette.step, digits: 3, value: (_, s) => s.step_ms },
    { label: "match", unit: "ms", color: palette.match, digits: 3, value: (_, s) => s.match_ms },
  ],
};

/** A curve a finger, in the colours of the table beside the view. */
function handPlots(scene: Scene): PlotDescription[] {
  const each = (unit: string, digits: number, value: (finger: FingerSnapshot) => number): Curve[] =>
    scene.fingers.map(({ name }, i) => ({
      label: name, unit, color: fingerColor(i), digits,
      value: (_, snapshot) => (snapshot.fingers[i] ? value(snapshot.fingers[i]!) : NaN),
    }));
  return [
    { id: "force", title: "Force", range: [0, 1], curves: each("N", 2, (f) => f.normal_force_N) },
    { id: "area", title: "Contact area", range: [0, 40], curves: each("mm²", 0, (f) => f.contact_area_mm2) },
    { id: "deviation", title: "Deviation", range: [0, 1], curves: each("mm²", 2, (f) => f.deviation_mm2) },
    kComputingTime,
  ];
}

const kMeanings: Record<string, string> = {
  configuration: "As commanded; dashed, where the servos say they are",
  iou: "Area that both contacts have in common over the area that either has",
  centroid: "Shift between the centroids of the normal force",
  angle: "Angle between the mean normals",
  "force-error": "Difference of the normal forces over the virtual one",
  "tangential-error": "Difference of the tangential forces, as vectors, over the virtual normal force",
  "slip-error": "Difference of the slip ratios: tangential force over what friction bears",
};

/** How far what the device renders is from the virtual contact. */
function measurePlots(): PlotDescription[] {
  const small = (id: string, title: string, unit: string, color: string, digits: number,
    range: [number, number], value: (twin: Twin) => number): PlotDescription =>
    ({ id, title, range, small: true,
       curves: [{ label: "", unit, color, digits, filled: true, value: twin(value) }] });
  return [
    small("iou", "Overlap IoU", "", palette.step, 2, [0, 1], (t) => t.iou),
    small("centroid", "Centroid", "mm", palette.travel, 2, [0, 1], (t) => t.centroid_shift_mm),
    small("angle", "Normal", "°", palette.roll, 1, [0, 5], (t) => t.normal_angle_deg),
    small("force-error", "Force error", "%", palette.force, 0, [0, 20], (t) => 100 * t.normal_force_error),
    small("tangential-error", "Shear error", "%", palette.force, 0, [0, 50], (t) => 100 * t.tangential_force_error),
    small("slip-error", "Slip error", "", palette.roll, 2, [0, 1], (t) => t.slip_ratio_error),
  ];
}

/** The live plots: the loop's in a strip below the views, the twin's measures beside them. */
export class Plots {
  private plots: LivePlot[] = [];
  private latency: LatencyView | null = null;
  private finger = 0; // of the scene's

  constructor(private readonly strip: HTMLElement, private readonly measures: HTMLElement) {}

  /** Begins anew with what is shown of a scene. */
  reset(scene: Scene, shown: Shown): void {
    const focused = this.strip.querySelector(".turn:focus") !== null;
    this.build(scene, shown);
    if (focused) this.strip.querySelector<HTMLElement>(".turn")?.focus();
  }

  private build(scene: Scene, shown: Shown): void {
    for (const plot of this.plots) plot.dispose();
    this.plots = [];
    this.latency = null;
    this.finger = shown === kHand ? 0 : shown;
    const finger = scene.fingers[this.finger];
    if (!finger) return;
    if (shown === kHand) {
      this.plots = handPlots(scene).map((d) => new LivePlot(this.strip, d));
      return;
    }
    this.plots = loopPlots(finger).map((d) => new LivePlot(this.strip, d));
    const last = this.plots[this.plots.length - 1]!;
    this.latency = finger.device_kind ? new LatencyView(last.element, scene.latency_stages) : null;
    if (finger.twin) this.plots.push(...measurePlots().map((d) => new LivePlot(this.measures, d)));
  }
  add(snapshot: Snapshot): void {
    const finger = snapshot.fingers[this.finger];
    if (!finger) return;
    for (const plot of this.plots) plot.add(finger, snapshot);
    this.latency?.add(finger);
  }
  draw(): void {
    for (const plot of this.plots) plot.draw();
    this.latency?.draw();
  }
}

class LivePlot {
  readonly element = document.createElement("article");
  private readonly box = document.createElement("div");
  private readonly values: (HTMLElement | null)[] = []; // null: has none
  private readonly data: (number | null)[][];
  private readonly plot: uPlot;
  private readonly observer: ResizeObserver;
  private changed = false;

  constructor(parent: HTMLElement, private readonly description: PlotDescription) {
    this.data = [[], ...description.curves.map(() => [])];
    const told = description.curves.filter((curve) => !curve.dashed);
    this.element.className = description.small ? "plot small" : told.length > 3 ? "plot most" : told.length > 2 ? "plot many" : "plot";
    this.element.id = `plot-${description.id}`;
    this.element.append(this.makeHeader(), this.box);
    this.box.className = "plot-box";
    parent.append(this.element);
    this.plot = new uPlot(this.options(), this.data as uPlot.AlignedData, this.box);
    this.observer = new ResizeObserver(() => this.fit());
    this.observer.observe(this.box);
    this.fit();
  }

  dispose(): void {
    this.observer.disconnect();
    this.plot.destroy();
    this.element.remove();
  }

  add(finger: FingerSnapshot, snapshot: Snapshot): void {
    const times = this.data[0]!;
    if (times.length > 0 && snapshot.time_s <= times[times.length - 1]!) return;
    times.push(snapshot.time_s);
    this.description.curves.forEach((curve, i) => {
      const value = curve.value(finger, snapshot);
      this.data[i + 1]!.push(Number.isFinite(value) ? value : null); // null: a gap
    });
    if (times.length > kCapacity) for (const column of this.data) column.splice(0, kCapacity / 3);
    this.changed = true;
  }

  draw(): void {
    if (!this.changed) return;
    this.changed = false;
    this.plot.setData(this.data as uPlot.AlignedData);
    this.description.curves.forEach((curve, i) => {
      const column = this.data[i + 1]!;
      const text = column[column.length - 1]?.toFixed(curve.digits) ?? "–";
      const shown = this.values[i];
      if (shown) shown.textContent = /^-0\.?0*$/.test(text) ? text.slice(1) : text;
    });
    this.element.dataset.points = String(this.data[0]!.length);
    this.element.dataset.last = String(this.data[0]![this.data[0]!.length - 1]);
  }

  private makeHeader(): HTMLElement {
    const header = document.createElement("header");
    const title = document.createElement("h2");
    title.textContent = this.description.title;
    header.append(title);
    header.title = kMeanings[this.description.id] ?? "";
    for (const curve of this.description.curves) {
      if (curve.dashed) {
        this.values.push(null);
        continue;
      }
      const item = document.createElement("span");
      item.className = "value";
      const key = document.createElement("i");
      key.style.background = curve.color;
      const value = document.createElement("b");
      value.textContent = "–";
      this.values.push(value);
      if (!this.description.small) item.title = `${curve.label || this.description.title} (${curve.unit})`;
      item.append(key, span("label", curve.label && `${curve.label} `), value,
        span("unit", behindNumber(curve.unit)));
      header.append(item);
    }
    return header;
  }

  private options(): uPlot.Options {
    const axis = (scale: string, side: 1 | 3, size: number, grid: boolean): uPlot.Axis => ({
      scale, side, size, gap: 4, font: "11px Inter Variable", stroke: palette.text,
      grid: { show: grid, stroke: palette.line, width: 1 }, ticks: { show: false }, space: 28,
    });
    const hasRight = this.description.rightRange !== undefined;
    const atLeast = ([low, high]: [number, number]) =>
      (_: uPlot, min: number | null, max: number | null): uPlot.Range.MinMax => {
        const a = Math.min(low, min ?? low);
        const b = Math.max(high, max ?? high);
        const margin = 0.06 * (b - a);
        return [a < low ? a - margin : low, b > high ? b + margin : high];
      };
    return {
      width: 200, height: 100, legend: { show: false }, cursor: { show: false }, pxAlign: false,
      padding: this.description.small ? [2, 0, 2, 0] : [6, hasRight ? 0 : 18, 0, 0],
      scales: {
        x: { time: false, range: () => {
          const newest = this.data[0]![this.data[0]!.length - 1] ?? 0;
          return [Math.max(0, newest - kWindow), Math.max(kWindow, newest)];
        } },
        y: { range: atLeast(this.description.range) },
        ...(hasRight ? { right: { range: atLeast(this.description.rightRange!) } } : {}),
      },
      axes: this.description.small ? [{ show: false }, { show: false }] : [
        { font: "11px Inter Variable", stroke: palette.text, size: 24, gap: 2, space: 56,
          grid: { stroke: palette.line, width: 1 }, ticks: { show: false },
          values: (_, splits) => splits.map((s) => `${s} s`) },
        axis("y", 3, 38, true),
        ...(hasRight ? [axis("right", 1, 30, false)] : []),
      ],
      series: [
        {},
        ...this.description.curves.map((curve): uPlot.Series => ({
          scale: curve.scale === "right" && hasRight ? "right" : "y",
          stroke: curve.color, width: curve.dashed ? 1.25 : 1.75, points: { show: false },
          dash: curve.dashed ? [4, 3] : undefined,
          fill: curve.filled ? `${curve.color}26` : undefined,
        })),
      ],
    };
  }

  private fit(): void {
    const { clientWidth, clientHeight } = this.box;
    if (clientWidth > 0 && clientHeight > 0) {
      this.plot.setSize({ width: clientWidth, height: clientHeight });
    }
  }
}

function span(name: string, text: string): HTMLElement {
  const element = document.createElement("span");
  element.className = name;
  element.textContent = text;
  return element;
}
