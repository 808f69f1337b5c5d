import type { FingerSnapshot, LatencyStage } from "softfinger-client";
import { palette } from "./palette";
import { clearedContext, redrawOnResize } from "./sharp_canvas";

const kKept = 600; // device ticks
const kLeast = 0.01; // ms, of the axis
const kDecades = 5;
const kBins = 50;
const kLabelWidth = 58; // px
const kValueWidth = 62;
const kAxisHeight = 15;

/** A plot's other side: how long each stage takes from the finger to the servos, as histograms of the last ticks. */
export class LatencyView {
  private static shown = false; // kept from scene to scene
  private readonly canvas = document.createElement("canvas");
  private readonly times: number[][];
  private tick = -1;

  constructor(private readonly plot: HTMLElement, private readonly stages: LatencyStage[]) {
    this.times = stages.map(() => []);
    const title = plot.querySelector("h2")!;
    const turn = document.createElement("button");
    turn.className = "turn";
    const show = (latency: boolean) => {
      LatencyView.shown = latency;
      plot.dataset.shows = latency ? "latency" : "time";
      turn.textContent = latency ? "Latency by stage" : "Computing time";
      turn.title = latency
        ? stages.map(({ name, words }) => `${name}: ${words}`).join("\n") : "Show latency by stage";
    };
    turn.onclick = () => show(!LatencyView.shown);
    title.replaceChildren(turn);
    this.canvas.className = "stages";
    plot.append(this.canvas);
    redrawOnResize(this.canvas, () => this.draw());
    show(LatencyView.shown);
  }

  add(finger: FingerSnapshot): void {
    if (finger.tick === this.tick) return;
    this.tick = finger.tick;
    finger.stages_ms.forEach((time, i) => {
      if (Number.isNaN(time)) return;
      const kept = this.times[i]!;
      kept.push(time);
      if (kept.length > kKept) kept.shift();
    });
    this.plot.dataset.stages = this.stages.filter((_, i) => this.times[i]!.length > 0).map(({ name }) => name).join(" ");
  }

  draw(): void {
    if (!LatencyView.shown) return;
    const context = clearedContext(this.canvas);
    if (!context) return;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const row = (height - kAxisHeight) / this.stages.length;
    const left = kLabelWidth;
    const span = width - kLabelWidth - kValueWidth;
    context.font = "11px Inter Variable, sans-serif";
    context.textBaseline = "middle";
    this.drawAxis(context, left, span, height);
    this.stages.forEach(({ name: stage }, i) => {
      const bottom = (i + 1) * row;
      const times = [...this.times[i]!].sort((a, b) => a - b);
      context.fillStyle = palette.text;
      context.textAlign = "left";
      context.fillText(stage, 4, bottom - row / 2);
      context.textAlign = "right";
      const median = times[Math.floor(times.length / 2)];
      context.fillText(median === undefined ? "–" : `${shortened(median)} ms`, width - 6, bottom - row / 2);
      context.fillStyle = stage === "match" ? palette.match : palette.step;
      drawBins(context, times, { left, span, bottom, height: row - 3 });
    });
  }

  private drawAxis(context: CanvasRenderingContext2D, left: number, span: number, height: number): void {
    context.fillStyle = palette.faint;
    context.strokeStyle = palette.line;
    context.lineWidth = 1;
    for (let decade = 0; decade <= kDecades; ++decade) {
      const x = left + (span * decade) / kDecades;
      context.beginPath();
      context.moveTo(x, 0);
      context.lineTo(x, height - kAxisHeight);
      context.stroke();
      context.textAlign = "center";
      if (decade % 2 === 1 || span > 180) {
        context.fillText(String(Number((kLeast * 10 ** decade).toPrecision(1))), x, height - kAxisHeight / 2);
      }
    }
  }
}

function drawBins(context: CanvasRenderingContext2D, times: number[],
  box: { left: number; span: number; bottom: number; height: number }): void {
  const bins = new Array<number>(kBins).fill(0);
  for (const time of times) {
    const place = Math.floor((kBins * Math.log10(Math.max(time, kLeast) / kLeast)) / kDecades);
    ++bins[Math.min(place, kBins - 1)]!;
  }
  const most = Math.max(...bins);
  const width = box.span / kBins;
  bins.forEach((count, i) => {
    if (count === 0) return;
    const height = Math.max(1, box.height * Math.sqrt(count / most)); // a lone outlier is seen too
    context.fillRect(box.left + i * width, box.bottom - height, Math.max(1, width - 0.5), height);
  });
}

function shortened(time: number): string {
  return time >= 10 ? time.toFixed(0) : time >= 1 ? time.toFixed(1) : time.toFixed(2);
}
