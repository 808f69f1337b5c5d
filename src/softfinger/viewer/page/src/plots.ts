import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { palette } from "./palette";
import type { Snapshot } from "./wire";

const kWindow = 10; // s of simulated time shown
const kCapacity = 1500;

interface Curve {
  label: string;
  unit: string;
  color: string;
  digits: number;
  scale?: "right";
  filled?: boolean;
  value(snapshot: Snapshot): number;
}
interface PlotDescription {
  id: string;
  title: string;
  curves: Curve[];
  /** The scale always shows at least this range. */
  range: [number, number];
  rightRange?: [number, number];
}

const q = (index: number) => (s: Snapshot) => s.fingers[0]?.configuration[index] ?? 0;

const kCurveColors = [palette.pitch, palette.roll, palette.travel];

/** Pitch and roll share the left scale, travel has the right one. */
function configurationCurves(names: string[]): Curve[] {
  return names.slice(0, 3).map((name, i) => {
    const [, label, unit] = /^(.*?)_(deg|mm)$/.exec(name) ?? [name, name, ""];
    return {
      label: label!, unit: unit === "deg" ? "°" : unit!, color: kCurveColors[i]!,
      digits: unit === "deg" ? 1 : 2, scale: unit === "mm" ? "right" : undefined, value: q(i),
    };
  });
}

function descriptions(names: string[]): PlotDescription[] {
  return [
    {
      id: "force", title: "Force", range: [0, 1],
      curves: [
        { label: "normal", unit: "N", color: palette.force, digits: 2, filled: true,
          value: (s) => s.fingers[0]?.normal_force_N ?? 0 },
        { label: "friction", unit: "N", color: palette.friction, digits: 2,
          value: (s) => s.fingers[0]?.tangential_force_N ?? 0 },
      ],
    },
    {
      id: "area", title: "Contact area", range: [0, 40],
      curves: [{ label: "", unit: "mm²", color: palette.area, digits: 0, filled: true,
                 value: (s) => s.fingers[0]?.contact_area_mm2 ?? 0 }],
    },
    {
      id: "configuration", title: "Configuration q", range: [-6, 6], rightRange: [0, 4],
      curves: configurationCurves(names),
    },
    {
      id: "step", title: "Computing time", range: [0, 0.25],
      curves: [
        { label: "step", unit: "ms", color: palette.step, digits: 3, value: (s) => s.step_ms },
        { label: "match", unit: "ms", color: palette.match, digits: 3, value: (s) => s.match_ms },
      ],
    },
  ];
}

/** The strip of live plots below the views. */
export class Plots {
  private plots: LivePlot[] = [];

  constructor(private readonly parent: HTMLElement) {}

  reset(configurationNames: string[]): void {
    for (const plot of this.plots) plot.dispose();
    this.plots = descriptions(configurationNames).map((d) => new LivePlot(this.parent, d));
  }
  add(snapshot: Snapshot): void {
    for (const plot of this.plots) plot.add(snapshot);
  }
  draw(): void {
    for (const plot of this.plots) plot.draw();
  }
}

class LivePlot {
  private readonly element = document.createElement("article");
  private readonly box = document.createElement("div");
  private readonly values: HTMLElement[] = [];
  private readonly data: number[][];
  private readonly plot: uPlot;
  private readonly observer: ResizeObserver;
  private changed = false;

  constructor(parent: HTMLElement, private readonly description: PlotDescription) {
    this.data = [[], ...description.curves.map(() => [])];
    this.element.className = description.curves.length > 2 ? "plot many" : "plot";
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

  add(snapshot: Snapshot): void {
    const times = this.data[0]!;
    if (times.length > 0 && snapshot.time_s <= times[times.length - 1]!) return;
    times.push(snapshot.time_s);
    this.description.curves.forEach((curve, i) => this.data[i + 1]!.push(curve.value(snapshot)));
    if (times.length > kCapacity) for (const column of this.data) column.splice(0, kCapacity / 3);
    this.changed = true;
  }

  draw(): void {
    if (!this.changed) return;
    this.changed = false;
    this.plot.setData(this.data as uPlot.AlignedData);
    this.description.curves.forEach((curve, i) => {
      const column = this.data[i + 1]!;
      const value = column[column.length - 1]!;
      const text = value.toFixed(curve.digits);
      this.values[i]!.textContent = /^-0\.?0*$/.test(text) ? text.slice(1) : text;
    });
    this.element.dataset.points = String(this.data[0]!.length);
    this.element.dataset.last = String(this.data[0]![this.data[0]!.length - 1]);
  }

  private makeHeader(): HTMLElement {
    const header = document.createElement("header");
    const title = document.createElement("h2");
    title.textContent = this.description.title;
    header.append(title);
    for (const curve of this.description.curves) {
      const item = document.createElement("span");
      item.className = "value";
      const key = document.createElement("i");
      key.style.background = curve.color;
      const value = document.createElement("b");
      value.textContent = "–";
      this.values.push(value);
      item.title = `${curve.label || this.description.title} (${curve.unit})`;
      item.append(key, span("label", curve.label && `${curve.label} `), value,
        span("unit", curve.unit === "°" ? curve.unit : ` ${curve.unit}`));
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
      padding: [6, hasRight ? 0 : 18, 0, 0],
      scales: {
        x: { time: false, range: (_, __, max) => [Math.max(0, (max ?? 0) - kWindow), Math.max(kWindow, max ?? 0)] },
        y: { range: atLeast(this.description.range) },
        ...(hasRight ? { right: { range: atLeast(this.description.rightRange!) } } : {}),
      },
      axes: [
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
          stroke: curve.color, width: 1.75, points: { show: false },
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
