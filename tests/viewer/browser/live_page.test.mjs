// The live page of the real program in a browser. SOFTFINGER_PROGRAM is the program (or
// fake_feed_server, which takes no arguments), SOFTFINGER_SCENE the scene to run.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { basename, dirname, resolve } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { openPage, pauseInContact, startProgram } from "./live_program.mjs";
import { countColors, differingPixels } from "./pixels.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SOFTFINGER_PROGRAM ?? resolve(root, "build/softfinger");
const scene = process.env.SOFTFINGER_SCENE ?? resolve(root, "scenes/sphere.toml");
const isFake = basename(program).startsWith("fake_feed_server");

let running;
let browser;
let page;

before(async () => {
  running = await startProgram(program, isFake ? [] : ["run", scene, "--repeat", "--port", "0"]);
  browser = await openPage(running.url, { width: 1100, height: 680 });
  page = browser.page;
}, { timeout: 300_000 });

after(async () => {
  await browser?.close();
  await running?.stop();
});

const data = (name) => browser.data(name);
/** Where a script begins anew its plots are made anew: then there is none for a moment. */
const picture = async (selector) => {
  for (let looks = 0; looks < 50; ++looks) {
    const clip = await page.locator(selector).boundingBox();
    if (clip) return page.screenshot({ clip });
    await page.waitForTimeout(100);
  }
  throw new Error(`${selector} is not shown`);
};

test("shows the scene, live", async () => {
  assert.equal(await data("connection"), "live");
  assert.equal(await data("scene"), "sphere");
  const scenes = await page.locator("#scenes button").allTextContents();
  assert.ok(scenes.includes("sphere") && scenes.includes("plane") && scenes.includes("edge"), String(scenes));
  assert.ok(Number(await data("samples")) > 50);
});

test("the picture moves", async () => {
  const clip = await page.locator("#virtual").boundingBox();
  const first = await page.screenshot({ clip });
  const time = Number(await data("time"));
  await page.waitForFunction((from) => Math.abs(Number(document.body.dataset.time) - from) > 0.5, time);
  const pixels = differingPixels(first, await page.screenshot({ clip }));
  assert.ok(pixels > 500, `${pixels} pixels differ`);
});

test("snapshots keep coming", async () => {
  const [from, start] = [Number(await data("frames")), Date.now()];
  await page.waitForTimeout(3000);
  const rate = (Number(await data("frames")) - from) / ((Date.now() - start) / 1000);
  // A browser that was busy catches up with what waited for it.
  assert.ok(rate > 5 && rate < 100, `${rate.toFixed(1)} a second; 60 on an idle machine`);
});

test("plots advance", async () => {
  for (const id of ["force", "area", "configuration", "step"]) {
    const last = await page.locator(`#plot-${id}`).getAttribute("data-last");
    await page.waitForFunction(([name, from]) => {
      const dataset = document.getElementById(`plot-${name}`)?.dataset;
      return Number(dataset?.points) > 10 && dataset.last !== from;
    }, [id, last], { polling: 50 });
  }
  const { colored } = countColors(await picture("#plots"));
  assert.ok(colored > 300, `${colored} coloured pixels in the plots`);
});

test("samples in contact are red, the others blue, on both sides; pause holds", async () => {
  await pauseInContact(page, 4);
  const time = await data("time");
  for (const pane of ["#virtual", "#rendered"]) {
    const colors = countColors(await picture(pane));
    assert.ok(colors.red > 30, `${pane}: ${colors.red} red pixels`);
    assert.ok(colors.blue > 200, `${pane}: ${colors.blue} blue pixels`);
  }
  await page.waitForTimeout(500);
  assert.equal(await data("time"), time);
  assert.equal(await page.locator("#notice").textContent(), "Paused");
  await page.keyboard.press("Space");
  await page.waitForFunction((held) => document.body.dataset.time !== held, time);
  assert.equal(await data("state"), "running");
});

test("the twin touches as well, and is judged", async () => {
  await page.waitForFunction(() => Number(document.body.dataset.twinContacts) > 3 &&
    Number(document.body.dataset.iou) > 0.2);
  assert.equal(await data("twin"), "on");
  for (const id of ["iou", "centroid", "angle", "force-error", "tangential-error", "slip-error"]) {
    await page.waitForFunction((name) =>
      /^\d+(\.\d+)?$/.test(document.querySelector(`#plot-${name} b`)?.textContent ?? ""), id);
  }
  await pauseInContact(page, 4);
  for (const patch of ["#patch-virtual", "#patch-twin"]) {
    const { colored } = countColors(await picture(patch));
    assert.ok(colored > 60, `${patch}: ${colored} coloured pixels`);
  }
  await page.keyboard.press("Space");
});

test("the workspace shows where the device is", async () => {
  const { teal } = countColors(await picture("#workspace"));
  assert.ok(teal > 100, `${teal} teal pixels`);
});

test("says what leads the device, and changes it", async () => {
  const choice = page.locator("#objective");
  const names = await choice.locator("option").evaluateAll((options) => options.map(({ value }) => value));
  assert.ok(names.includes("surface") && names.includes("surface_and_force"), String(names));
  for (const name of [...names.slice(1), names[0]]) {
    await choice.selectOption(name);
    await page.waitForFunction((wanted) => document.body.dataset.objective === wanted, name);
  }
  // Keys of the list are its own; the script may come to its end meanwhile.
  await choice.press("ArrowDown");
  assert.match(await data("state"), /^(running|finished)$/);
  await page.waitForFunction((first) => document.body.dataset.objective !== first, names[0]);
});

test("latency by stage is behind the title of the computing times", { skip: isFake }, async () => {
  await page.evaluate(() => document.querySelector("#plot-step .turn").click());
  await page.waitForFunction(() =>
    document.getElementById("plot-step").dataset.stages === "step match send servo");
  // They fill as ticks come, and begin anew with each repetition of the script.
  let colored = 0;
  for (let looks = 0; looks < 40 && colored <= 100; ++looks) {
    await page.waitForTimeout(300);
    ({ colored } = countColors(await picture("#plot-step .stages")));
  }
  assert.ok(colored > 100, `${colored} coloured pixels`);
  await page.evaluate(() => document.querySelector("#plot-step .turn").click());
  assert.ok(await page.locator("#plot-step .plot-box").isVisible());
});

test("restart begins again", async () => {
  await page.waitForFunction(() => Number(document.body.dataset.time) > 1);
  const generation = Number(await data("generation"));
  await page.click("#restart");
  await page.waitForFunction((old) => Number(document.body.dataset.generation) > old, generation);
  assert.equal(await data("scene"), "sphere");
});

test("another scene can be chosen", async () => {
  await page.click('[data-scene="plane"]');
  await page.waitForFunction(() => document.body.dataset.scene === "plane");
  assert.equal(await page.locator('[aria-checked="true"]').textContent(), "plane");
  const time = await data("time");
  await page.waitForFunction((old) => document.body.dataset.time !== old, time);
  assert.match(await page.title(), /plane/);
});

test("dragging turns both views", async () => {
  await page.keyboard.press("Space");
  await page.waitForFunction(() => document.body.dataset.state === "paused");
  await page.waitForTimeout(500);
  const before = await picture("#rendered");
  const box = await page.locator("#virtual").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 120, box.y + box.height / 2 + 20, { steps: 4 });
  await page.mouse.up();
  await page.waitForTimeout(1000);
  assert.ok(differingPixels(before, await picture("#rendered")) > 1000);
  await page.keyboard.press("Space");
});

test("asks nobody but its own program, and has no complaints", () => {
  for (const url of browser.requests) assert.ok(url.startsWith(running.url), url);
  assert.deepEqual(browser.complaints, []);
});

test("a port in use is one clear line, status 2", () => {
  const port = new URL(running.url).port;
  const args = isFake ? [port] : ["run", scene, "--port", port];
  const second = spawnSync(program, args, { encoding: "utf8", timeout: 60_000 });
  assert.equal(second.status, 2);
  assert.match(second.stderr.trim(), new RegExp(`^\\S+: --port ${port}: already in use; .*$`));
});

test("the page tells what the terminal is told", { skip: isFake }, async () => {
  const children = readFileSync(`/proc/${running.pid}/task/${running.pid}/children`, "utf8").trim().split(" ");
  const guard = children.find((pid) => readFileSync(`/proc/${pid}/comm`, "utf8").startsWith("softfinger"));
  process.kill(Number(guard), "SIGKILL");
  await page.locator("#notifications li", { hasText: "guards port" }).waitFor();
  if (process.env.SOFTFINGER_PICTURE) await page.screenshot({ path: process.env.SOFTFINGER_PICTURE });
});

test("the page says when the program has ended", async () => {
  assert.equal(await running.stop(), 0);
  await page.waitForFunction(() => document.body.dataset.connection === "lost");
  assert.equal(await page.locator("#connection").textContent(), "no connection");
});
