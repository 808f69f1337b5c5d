// screenshot.mjs PROGRAM SCENE OUT.png [FLAGS...]: the live page while the pad is pressed, for the documents.
import { openPage, startProgram } from "./live_program.mjs";

const [program, scene, out, ...flags] = process.argv.slice(2);
const running = await startProgram(program, ["run", scene, "--repeat", "--port", "0", ...flags]);
const browser = await openPage(`${running.url}/?quality=high`, { width: 1600, height: 1000 });
const { page } = browser;
try {
  // In the middle of the script, with plots half full; without graphics hardware a picture takes seconds.
  await page.waitForFunction(() => {
    const time = Number(document.body.dataset.time);
    return time > 2.4 && time < 3 && Number(document.body.dataset.contacts) > 2;
  }, null, { polling: 20 });
  await page.screenshot({ path: out });
} finally {
  await browser.close();
  await running.stop();
}
