import "./style.css";
import "./study.css";

/** What /progress.json says. */
interface Progress {
  title: string;
  kind: string;
  state: string;
  evaluations: number;
  done: number;
  designs: number;
  not_feasible: number;
  evaluations_per_s: number;
  left_s: number | null;
  best: { objective: string; value: number; design: number }[];
  report: number;
}

const kPeriod = 1000; // ms

function element(id: string): HTMLElement {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found;
}

function say(id: string, words: string): void {
  const place = element(id);
  if (place.textContent !== words) place.textContent = words;
}

function timeOf(seconds: number): string {
  if (seconds < 100) return `${Math.ceil(seconds)} s`;
  if (seconds < 6000) return `${Math.ceil(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

function showBest(best: Progress["best"]): void {
  element("best").replaceChildren(
    ...best.map(({ objective, value, design }) => {
      const item = document.createElement("div");
      const name = document.createElement("dt");
      name.textContent = `best ${objective} so far`;
      const number = document.createElement("b");
      number.textContent = value.toPrecision(4);
      const whose = document.createElement("dd");
      whose.append(number, ` design ${design}`);
      item.append(name, whose);
      return item;
    }),
  );
}

function show(progress: Progress): void {
  const contacts = progress.kind === "contacts";
  document.title = `${progress.title} – softfinger study`;
  say("title", `${progress.title} (${progress.kind})`);
  say("unit", contacts ? "presses" : "evaluations");
  say("done", String(progress.done));
  say("evaluations", String(progress.evaluations));
  say("designs", contacts ? "–" : String(progress.designs));
  say("not-feasible", contacts ? "–" : String(progress.not_feasible));
  say("rate", progress.evaluations_per_s.toPrecision(3));
  say("left", progress.state === "running" && progress.left_s !== null ? timeOf(progress.left_s) : "–");
  say("state", progress.state);
  showBest(progress.best);
  const done = progress.evaluations > 0 ? progress.done / progress.evaluations : 0;
  const bar = element("progress");
  bar.style.transform = `scaleX(${done})`;
  bar.setAttribute("aria-valuenow", String(Math.floor(100 * done)));
}

let shown = 0; // the report that is
let ended = false;

async function look(): Promise<void> {
  try {
    const progress = (await (await fetch("/progress.json")).json()) as Progress;
    show(progress);
    if (progress.report !== shown) {
      element("report").innerHTML = await (await fetch("/report.html")).text();
      shown = progress.report;
    }
    ended = progress.state !== "running";
    document.body.dataset.connection = ended ? "connecting" : "live";
  } catch {
    document.body.dataset.connection = "lost";
    if (!ended) say("state", "no longer there");
  }
}

async function watch(): Promise<void> {
  await look();
  window.setTimeout(() => void watch(), kPeriod);
}
void watch();
