// A browser that looks at the live page of a running program.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

export { startProgram } from "./running_program.mjs";

const kPatience = 120_000; // ms; software rendering on a busy machine is slow
const kPictures_Hz = 5; // drawing is nearly all that a browser without a graphics card does

/** In the page: pictures at the browser's own times, but no more than `rate_Hz` of them. */
function drawSeldom(rate_Hz) {
  const draw = window.requestAnimationFrame.bind(window);
  const interval = 1000 / rate_Hz;
  window.requestAnimationFrame = (picture) => setTimeout(() => draw(picture), interval - (performance.now() % interval));
  window.cancelAnimationFrame = clearTimeout;
}

/** Opens `url` in a fresh headless Chromium; collects what the page complains about. */
export async function openPage(url, viewport) {
  const profile = mkdtempSync(join(tmpdir(), "softfinger-browser-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    viewport,
    args: [
      "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync",
    ],
  });
  context.setDefaultTimeout(kPatience);
  await context.addInitScript(drawSeldom, kPictures_Hz);
  const page = await context.newPage();
  const complaints = [];
  const requests = [];
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(url, { timeout: kPatience });
  await page.waitForFunction(() => document.body.dataset.time !== undefined);
  return {
    page,
    complaints,
    requests,
    data: (name) => page.evaluate((key) => document.body.dataset[key], name),
    async close() {
      await context.close();
      rmSync(profile, { recursive: true, force: true });
    },
  };
}

/** Pauses while at least `contacts` samples are in contact; the page then stands still. */
export async function pauseInContact(page, contacts) {
  const polling = 50;
  for (let attempt = 0; attempt < 8; ++attempt) {
    await page.waitForFunction((least) => {
      if (Number(document.body.dataset.contacts) < least) return false;
      document.getElementById("pause").click();
      return true;
    }, contacts, { polling });
    await page.waitForFunction(() => document.body.dataset.state === "paused", null, { polling });
    if (Number(await page.evaluate(() => document.body.dataset.contacts)) >= contacts) {
      await page.evaluate(() => new Promise((drawn) => { // the pictures that have it are over
        let left = 3;
        requestAnimationFrame(function next() { if (--left > 0) requestAnimationFrame(next); else drawn(); });
      }));
      return;
    }
    await page.click("#pause");
    await page.waitForFunction(() => document.body.dataset.state === "running", null, { polling });
  }
  throw new Error(`never paused with ${contacts} samples in contact`);
}

/** Through the question, as often as it takes until the device may be released. */
export async function releaseDevice(page) {
  for (let k = 0; k < 100; ++k) {
    if (await page.evaluate(() => document.body.dataset.stopped === "false")) return;
    try {
      await page.locator("#release").click({ timeout: 2000 });
      await page.locator("#release-now").click({ timeout: 2000 });
    } catch (error) {
      // What was asked before may have released it just now: then the button is gone.
      if (error.name !== "TimeoutError") throw error;
    }
    await page.waitForTimeout(200);
  }
  throw new Error("the device is not released");
}
