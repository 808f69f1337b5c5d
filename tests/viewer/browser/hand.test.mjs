// A person without a tracker: keys and pointer move the finger on the page of the real program.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve, dirname } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { openPage, startProgram, releaseDevice } from "./live_program.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SOFTFINGER_PROGRAM ?? resolve(root, "build/softfinger");
const scene = process.env.SOFTFINGER_SCENE ?? resolve(root, "scenes/sphere.toml");

test("keys and pointer bring the finger to the sphere and away", { timeout: 300_000 }, async () => {
  const running = await startProgram(program, ["run", scene, "--tracker", "page", "--no-twin", "--port", "0"]);
  const browser = await openPage(running.url, { width: 1100, height: 700 });
  const { page } = browser;
  const touching = () => page.waitForFunction(() => Number(document.body.dataset.contacts) > 3);
  const free = () => page.waitForFunction(() => document.body.dataset.contacts === "0");
  try {
    assert.ok(await page.locator("#hand-hint").isVisible());
    await free();
    await page.keyboard.down("s");
    await touching();
    await page.keyboard.up("s");
    await page.waitForFunction(() => document.body.dataset.device === "rendering");
    // Whatever it touches, it leaves when somebody says stop, and stays away until released.
    await page.keyboard.press("Escape");
    await page.waitForFunction(() => document.body.dataset.device === "retracting");
    await page.waitForFunction(() => document.body.dataset.stopConfirmed === "true");
    // However often it is pressed.
    await page.locator("#stop").dblclick({ delay: 75 });
    await page.locator("#stop").press("Space");
    await page.waitForTimeout(500);
    assert.equal(await browser.data("stopped"), "true");
    assert.equal(await browser.data("device"), "retracting");
    await releaseDevice(page);
    await page.waitForFunction(() => document.body.dataset.device === "rendering");
    await page.keyboard.down("w");
    await free();
    await page.keyboard.up("w");

    // By its middle, which the view keeps in the middle of the pane, down and up again.
    const box = await page.locator("#virtual").boundingBox();
    const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
    await page.waitForTimeout(1500); // the view has followed
    await page.mouse.move(middle.x, middle.y);
    await page.mouse.down();
    // Where drawing is slow, the finger that is grabbed may still have been under way.
    for (let depth = 0.1; depth < 0.45; depth += 0.02) {
      await page.mouse.move(middle.x, middle.y + depth * box.height, { steps: 3 });
      await page.waitForTimeout(200);
      if (await page.evaluate(() => Number(document.body.dataset.contacts) > 3)) break;
    }
    await touching();
    await page.mouse.move(middle.x, middle.y - 0.1 * box.height, { steps: 10 });
    await free();
    await page.mouse.up();
    assert.deepEqual(browser.complaints, []);
  } finally {
    await browser.close();
    assert.equal(await running.stop(), 0);
  }
});

const kBallScene = `
[[finger]]
name = "index"
model = "${dirname(scene)}/../fingers/index.toml"
tracker = "page"
[[finger.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 36.0]
[[object]]
name = "ball"
shape = "sphere"
radius_mm = 12.0
motion = "dynamic"
mass_g = 20.0
position_mm = [0.0, 0.0, 12.0]
[[object]]
name = "table"
shape = "plane"
`;

test("the pointer takes a ball from the table, lifts it and drops it", { timeout: 300_000 }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "softfinger-ball-"));
  writeFileSync(join(folder, "ball.toml"), kBallScene);
  const running = await startProgram(program, ["run", join(folder, "ball.toml"), "--port", "0"]);
  const browser = await openPage(running.url, { width: 1100, height: 700 });
  const { page } = browser;
  const holds = (name) => page.waitForFunction((wanted) => (document.body.dataset.holds ?? "") === wanted, name);
  try {
    assert.ok(await page.locator("#object-hint").isVisible());
    const box = await page.locator("#virtual").boundingBox();
    const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
    await page.waitForTimeout(1500); // the view has followed
    // The ball is below the finger.
    let depth = 0.46;
    for (; depth > 0.2; depth -= 0.02) {
      await page.mouse.move(middle.x, middle.y + depth * box.height);
      await page.mouse.down();
      if ((await browser.data("holds")) === "ball") break;
      await page.mouse.up();
    }
    await holds("ball");
    // Past the fingertip, then up.
    await page.mouse.move(middle.x + 0.4 * box.width, middle.y + depth * box.height, { steps: 20 });
    await page.mouse.move(middle.x + 0.4 * box.width, middle.y + 0.1 * box.height, { steps: 20 });
    await page.waitForTimeout(1500);
    await page.waitForFunction(() => document.getElementById("events").children.length === 0); // it hangs still
    await page.mouse.up();
    await holds("");
    await page.waitForFunction(() => document.getElementById("events").innerText.includes("impact ball and table"));
    assert.deepEqual(browser.complaints, []);
  } finally {
    await browser.close();
    assert.equal(await running.stop(), 0);
    rmSync(folder, { recursive: true, force: true });
  }
});

const kKnobScene = kBallScene.slice(0, kBallScene.indexOf("[[object]]")) + `
[[object]]
name = "knob"
shape = "cylinder"
radius_mm = 14.0
length_mm = 20.0
position_mm = [0.0, 0.0, 10.0]
motion = "dynamic"
mass_g = 40.0
[object.joint]
kind = "hinge"
axis = [0.0, 0.0, 1.0]
friction_N_mm = 0.5
[object.joint.detents]
count = 24
torque_N_mm = 4.0
[[object]]
name = "table"
shape = "plane"
`;

test("the pointer turns a knob, click by click", { timeout: 300_000 }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "softfinger-knob-"));
  writeFileSync(join(folder, "knob.toml"), kKnobScene);
  const running = await startProgram(program, ["run", join(folder, "knob.toml"), "--port", "0"]);
  const browser = await openPage(running.url, { width: 1100, height: 700 });
  const { page } = browser;
  try {
    const box = await page.locator("#virtual").boundingBox();
    const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
    await page.waitForTimeout(1500); // the view has followed
    let depth = 0.46;
    for (; depth > 0.2; depth -= 0.02) {
      await page.mouse.move(middle.x, middle.y + depth * box.height);
      await page.mouse.down();
      if ((await browser.data("holds")) === "knob") break;
      await page.mouse.up();
    }
    await page.waitForFunction(() => document.body.dataset.holds === "knob");
    await page.mouse.move(middle.x + 0.3 * box.width, middle.y + depth * box.height, { steps: 20 });
    await page.waitForFunction(() => document.getElementById("events").innerText.includes("detent knob"));
    await page.mouse.up();
    assert.deepEqual(browser.complaints, []);
  } finally {
    await browser.close();
    assert.equal(await running.stop(), 0);
    rmSync(folder, { recursive: true, force: true });
  }
});
