// screenshot.mjs PROGRAM SCENE OUT.png [FLAGS...]: the live page while the pad is pressed, for the documents.
import { openPage, startProgram } from "./live_program.mjs";

const [program, scene, out, ...flags] = process.argv.slice(2);
const running = await startProgram(program, ["run", scene, "--repeat", "--port", "0", ...flags]);
const browser = await openPage(`${running.url}/?quality=high`, { width: 1600, height: 1000 });
const { page } = browser;
try {
  // Late enough that the plots are full, and at the firm part of a press.
  let firmest = 0;
  await page.waitForFunction(() => Number(document.body.dataset.time) > 5, null, { polling: 50 });
  await page.waitForTimeout(500);
  for (let i = 0; i < 40; ++i) {
    firmest = Math.max(firmest, Number(await browser.data("contacts")));
    await page.waitForTimeout(50);
  }
  await page.waitForFunction(
    (most) => Number(document.body.dataset.contacts) >= Math.max(3, 0.7 * most) &&
      Number(document.body.dataset.time) > 5 &&
      Number(document.getElementById("plot-force").dataset.points) > 100,
    firmest, { polling: 20 });
  await page.screenshot({ path: out });
} finally {
  await browser.close();
  await running.stop();
}
