// A person in a headset, emulated: the hand that it sees moves the finger of the real program.
import assert from "node:assert/strict";
import { dirname, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { openPage, startProgram } from "./live_program.mjs";
import { countColors, differingPixels } from "./pixels.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SOFTFINGER_PROGRAM ?? resolve(root, "build/softfinger");
const scene = process.env.SOFTFINGER_SCENE ?? resolve(root, "scenes/sphere.toml");
// Small: every frame of a headset is drawn, here by the processor.
const viewport = { width: 560, height: 360 };
const isModel = (url) => String(url).endsWith(".glb");
const handsAre = (page, kinds) => page.waitForFunction((wanted) => document.body.dataset.hands === wanted, kinds);

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
    assert.deepEqual(browser.requests.filter(isModel), [], "no model before anybody wears a headset");
    // By the keyboard: the pointer stays where it is.
    await page.mouse.move((at.x = 280), (at.y = 100));
    await page.locator("#enter-headset").press("Enter");
    await headsetIs("placed");
    await deviceIs("ready");
    await free();
    // Both hands are models; the fingertip that the scene simulates is left out.
    await handsAre(page, "right model, left model");
    assert.equal(await browser.data("stumps"), "1");
    assert.equal(browser.requests.filter(isModel).length, 2);
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

test("capsules stand in for a hand's model until it is there, and it closes as the hand does", { timeout: 300_000 }, async () => {
  const running = await startProgram(program, ["run", scene, "--no-twin", "--repeat", "--port", "0"]);
  const wide = { width: 1000, height: 260 }; // the left hand is in sight
  const browser = await openPage(`${running.url}/?emulate-headset`, wide);
  const { page } = browser;
  const enter = () => page.locator("#enter-headset").press("Enter");
  const picture = () => page.screenshot();
  /** Two pictures in a row that are the same and have hands: those are drawn a frame after they are there. */
  const still = async () => {
    let skin = 0;
    for (let last = await picture(), looked = 0; looked < 60; ++looked) {
      await page.waitForTimeout(500);
      const next = await picture();
      ({ skin } = countColors(next));
      if (skin > 5_000 && differingPixels(last, next) === 0) return next;
      last = next;
    }
    throw new Error(`the picture never stands still with hands: ${skin} pixels of them`);
  };
  try {
    await page.click("#pause"); // what moves is a hand
    await page.waitForFunction(() => document.body.dataset.state === "paused");
    await page.route(isModel, (route) => route.abort());
    await enter();
    await handsAre(page, "right capsules, left capsules");
    await still();
    assert.equal(await browser.data("stumps"), "0");

    await page.keyboard.press("Escape");
    await page.unroute(isModel);
    await enter();
    await handsAre(page, "right model, left model");
    const open = await still();
    await page.keyboard.down("p");
    let moved = 0;
    for (let looked = 0; moved < 1000 && looked < 60; ++looked) {
      await page.waitForTimeout(500);
      moved = differingPixels(open, await picture());
    }
    assert.ok(moved >= 1000, `${moved} pixels differ where a hand closes`);
    assert.deepEqual(browser.complaints.filter((text) => !text.includes("ERR_FAILED")), []);
  } finally {
    await browser.close();
    await running.stop();
  }
});

test("a hand in a headset is drawn where the world holds it", { timeout: 300_000 }, async () => {
  const bottle = resolve(dirname(scene), "bottle.toml");
  const running = await startProgram(program, ["run", bottle, "--tracker", "webxr", "--no-twin", "--port", "0"]);
  const browser = await openPage(`${running.url}/?emulate-headset`, viewport);
  const { page } = browser;
  const heldBack = (such) => page.waitForFunction(([most, least]) => {
    const { bones, heldBack: back } = document.body.dataset;
    return bones === "19" && Number(back) <= most && Number(back) >= least; // 14 of palm and phalanges, five tips
  }, such);
  try {
    // It begins with its thumb in the table.
    await page.mouse.move(280, 340);
    await page.locator("#enter-headset").press("Enter");
    await page.waitForFunction(() => document.body.dataset.headset === "placed");
    await handsAre(page, "right model, left model");
    await page.mouse.move(280, 40, { steps: 25 }); // 60 mm up
    await heldBack([1, 0]);
    await page.mouse.move(280, 340, { steps: 25 }); // the table holds it, the person goes on
    await heldBack([60, 15]);
    assert.deepEqual(browser.complaints, []);
  } finally {
    await browser.close();
    await running.stop();
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
