// Devices of other kinds than the first: drawn, moving, with their workspace and their twin.
import assert from "node:assert/strict";
import { dirname, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { openPage, pauseInContact, startProgram } from "./live_program.mjs";
import { countColors, differingPixels } from "./pixels.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SOFTFINGER_PROGRAM ?? resolve(root, "build/softfinger");
const scene = process.env.SOFTFINGER_SCENE ?? resolve(root, "scenes/sphere.toml");
const devices = resolve(dirname(scene), "../devices");

/** Runs `check` on the page of a device. */
function onPage(name, kind, check) {
  test(name, { timeout: 300_000 }, async () => {
    const running = await startProgram(program,
      ["run", scene, "--device", resolve(devices, `${name}.toml`), "--repeat", "--port", "0"]);
    const browser = await openPage(running.url, { width: 1200, height: 760 });
    try {
      const { page } = browser;
      const picture = async (selector) =>
        page.screenshot({ clip: await page.locator(selector).boundingBox() });
      assert.equal(await browser.data("deviceKind"), kind);
      await check(page, picture);
      assert.deepEqual(browser.complaints, []);
    } finally {
      await browser.close();
      await running.stop();
    }
  });
}

/** The device is seen, and seen elsewhere when it touches than when it does not. */
async function seenMoving(page, picture) {
  const polling = 50;
  await page.waitForFunction(() => document.body.dataset.contacts === "0", null, { polling });
  const before = await picture("#rendered");
  const reach = await picture("#workspace");
  let moved, there;
  // On a busy machine a touch may be paused at before the device has begun to follow.
  for (let attempt = 0; attempt < 5 && !(moved > 300 && there > 10); ++attempt) {
    if (attempt > 0) await page.keyboard.press("Space");
    await pauseInContact(page, 4);
    const after = await picture("#rendered");
    const { teal } = countColors(after);
    assert.ok(teal > 400, `${teal} pixels of the device's colour`);
    moved = differingPixels(before, after);
    there = differingPixels(reach, await picture("#workspace"));
  }
  assert.ok(moved > 300, `${moved} pixels differ`);
  assert.ok(there > 10, `${there} pixels of the workspace differ`);
  await page.keyboard.press("Space");
}

/** On both sides, in parts of the same skin. */
async function twinTouches(page, overlap) {
  await page.waitForFunction((least) => Number(document.body.dataset.twinContacts) > 2 &&
    Number(document.body.dataset.iou) > least, overlap);
}

onPage("pins-wagner-6x6", "pin_array", async (page, picture) => {
  await seenMoving(page, picture);
  await twinTouches(page, 0.02);  // tips of a millimetre
  assert.match(await page.locator("#plot-configuration").textContent(), /highest.*mean.*lowest/);
});

onPage("cable-prattichizzo", "cable_platform", async (page, picture) => {
  await seenMoving(page, picture);
  await twinTouches(page, 0.1);
});
