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

/** A run whose finger waits over this object, `name`, on a table; `check` begins once the pointer has taken the object. */
function onTaken(what, name, object, check) {
  test(what, { timeout: 300_000 }, async () => {
    const folder = mkdtempSync(join(tmpdir(), "softfinger-taken-"));
    writeFileSync(join(folder, "taken.toml"), `
[[finger]]
name = "index"
model = "${dirname(scene)}/../fingers/index.toml"
tracker = "page"
[[finger.waypoint]]
time_s = 0.0
position_mm = [0.0, 0.0, 36.0]
[[object]]
name = "${name}"
motion = "dynamic"
${object}
[[object]]
name = "table"
shape = "plane"
`);
    const running = await startProgram(program, ["run", join(folder, "taken.toml"), "--port", "0"]);
    const browser = await openPage(running.url, { width: 1100, height: 700 });
    const { page } = browser;
    const holds = (wanted) => page.waitForFunction((it) => (document.body.dataset.holds ?? "") === it, wanted);
    try {
      assert.ok(await page.locator("#object-hint").isVisible());
      const box = await page.locator("#virtual").boundingBox();
      const middle = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
      await page.waitForTimeout(1500); // the view has followed
      // It is below the finger.
      let depth = 0.46;
      for (; depth > 0.2; depth -= 0.02) {
        await page.mouse.move(middle.x, middle.y + depth * box.height);
        await page.mouse.down();
        if ((await browser.data("holds")) === name) break;
        await page.mouse.up();
      }
      await holds(name);
      // Both in parts of the pane, from its middle.
      const carry = (right, down) =>
        page.mouse.move(middle.x + right * box.width, middle.y + down * box.height, { steps: 20 });
      await check({ page, depth, carry, holds });
      assert.deepEqual(browser.complaints, []);
    } finally {
      await browser.close();
      assert.equal(await running.stop(), 0);
      rmSync(folder, { recursive: true, force: true });
    }
  });
}

const happened = (page, event) =>
  page.waitForFunction((words) => document.getElementById("events").innerText.includes(words), event);

onTaken("the pointer takes a ball from the table, lifts it and drops it", "ball", `
shape = "sphere"
radius_mm = 12.0
mass_g = 20.0
position_mm = [0.0, 0.0, 12.0]
`, async ({ page, depth, carry, holds }) => {
  // Past the fingertip, then up.
  await carry(0.4, depth);
  await carry(0.4, 0.1);
  await page.waitForTimeout(1500);
  await page.waitForFunction(() => document.getElementById("events").children.length === 0); // it hangs still
  await page.mouse.up();
  await holds("");
  await happened(page, "impact ball and table");
});

onTaken("the pointer turns a knob, click by click", "knob", `
shape = "cylinder"
radius_mm = 14.0
length_mm = 20.0
mass_g = 40.0
position_mm = [0.0, 0.0, 10.0]
[object.joint]
kind = "hinge"
axis = [0.0, 0.0, 1.0]
friction_N_mm = 0.5
[object.joint.detents]
count = 24
torque_N_mm = 4.0
`, async ({ page, depth, carry, holds }) => {
  await carry(0.3, depth);
  await happened(page, "detent knob");
  await page.mouse.up();
  await holds("");
});
