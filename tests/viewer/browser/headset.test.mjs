// A person in a headset, emulated: the hand that it sees moves the finger of the real program.
import assert from "node:assert/strict";
import { dirname, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { openPage, startProgram } from "./live_program.mjs";
import { countColors } from "./pixels.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SOFTFINGER_PROGRAM ?? resolve(root, "build/softfinger");
const scene = process.env.SOFTFINGER_SCENE ?? resolve(root, "scenes/sphere.toml");
// Small: every frame of a headset is drawn, here by the processor.
const viewport = { width: 560, height: 360 };

test("a hand in a headset brings the finger to the sphere and away", { timeout: 300_000 }, async () => {
  const running = await startProgram(program, ["run", scene, "--tracker", "webxr", "--no-twin", "--port", "0"]);
  const browser = await openPage(`${running.url}/?emulate-headset`, viewport);
  const { page } = browser;
  const headsetIs = (state) => page.waitForFunction((s) => document.body.dataset.headset === s, state);
  const deviceIs = (state) => page.waitForFunction((s) => document.body.dataset.device === s, state);
  const touching = () => page.waitForFunction(() => Number(document.body.dataset.contacts) > 3);
  const free = () => page.waitForFunction(() => document.body.dataset.contacts === "0");
  /** The hand follows the pointer, 0.2 mm a pixel; 14 mm lead from the start to the sphere. */
  const moveBy = async (dy) => {
    await page.mouse.move(at.x, at.y);
    await page.mouse.move(at.x, (at.y += dy), { steps: 20 });
  };
  /** The colours of a picture, as soon as they are such; a processor that draws takes its time for a frame. */
  const colorsOnce = async (such) => {
    let colors = countColors(await page.screenshot());
    for (let looked = 0; !such(colors) && looked < 60; ++looked) {
      await page.waitForTimeout(500);
      colors = countColors(await page.screenshot());
    }
    return colors;
  };
  const at = { x: 0, y: 0 };
  try {
    // By the keyboard: the pointer stays where it is.
    await page.mouse.move((at.x = 280), (at.y = 100));
    await page.locator("#enter-headset").press("Enter");
    await headsetIs("placed");
    await deviceIs("ready");
    await free();
    // It is drawn a frame after it is placed.
    const { red, skin } = await colorsOnce((colors) => colors.skin > 10_000);
    assert.ok(skin > 10_000, `${skin} pixels of the hand's skin`);

    await moveBy(100);
    await touching();
    await deviceIs("rendering");
    // The finger in the headset is pressed: samples in contact are red.
    const pressed = await colorsOnce((colors) => colors.red > red + 5);
    assert.ok(pressed.red > red + 5, `${red} red pixels before, ${pressed.red} in contact`);

    await moveBy(-100);
    await free();
    await deviceIs("ready");

    // A pinch of the other hand places the scene anew by where the hand is now: free again.
    await moveBy(100);
    await touching();
    await page.keyboard.down("p");
    await free();
    await page.keyboard.up("p");

    // Nobody wears it any more: tracking is lost.
    await page.keyboard.press("Escape");
    await headsetIs("left");
    await deviceIs("retracting");
    assert.ok(await page.locator("#enter-headset").isVisible());
    assert.deepEqual(browser.complaints, []);
  } finally {
    await browser.close();
    assert.equal(await running.stop(), 0);
  }
});

test("without a headset there is no button", { timeout: 300_000 }, async () => {
  const running = await startProgram(program, ["run", scene, "--no-twin", "--repeat", "--port", "0"]);
  const browser = await openPage(running.url, viewport);
  try {
    assert.equal(await browser.page.locator("#enter-headset").isVisible(), false);
    assert.deepEqual(browser.complaints, []);
  } finally {
    await browser.close();
    await running.stop();
  }
});
