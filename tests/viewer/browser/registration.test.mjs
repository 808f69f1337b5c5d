// A person registers a finger on the page of the real program; the body on it is emulated over UDP.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createSocket } from "node:dgram";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { openPage, startProgram, releaseDevice } from "./live_program.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SOFTFINGER_PROGRAM ?? resolve(root, "build/softfinger");
const scene = process.env.SOFTFINGER_SCENE ?? resolve(root, "scenes/sphere.toml");

const kTable = 35; // mm
const kOffset = [3, 1, -14]; // mm, the finger's centre in the body; their axes are the same
const h = Math.SQRT1_2;

/** How the finger lies: rotation matrix rows and quaternion w, x, y, z, and how far the skin reaches down. */
function postures(min, max) {
  return {
    "pad": { rows: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], q: [1, 0, 0, 0], reach: -min[2] },
    "left side": { rows: [[1, 0, 0], [0, 0, 1], [0, -1, 0]], q: [h, -h, 0, 0], reach: max[1] },
    "right side": { rows: [[1, 0, 0], [0, 0, -1], [0, 1, 0]], q: [h, h, 0, 0], reach: -min[1] },
    "tip": { rows: [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], q: [h, 0, h, 0], reach: max[0] },
  };
}

function datagram(number, { rows, q, reach }) {
  const down = rows.map((row) => row[0] * kOffset[0] + row[1] * kOffset[1] + row[2] * kOffset[2]);
  const position = [-down[0], -down[1], kTable + reach - down[2]];
  const bytes = Buffer.alloc(80);
  bytes.write("SFPO", 0, "latin1");
  bytes.writeUInt32LE(1, 4);
  bytes.writeUInt32LE(number, 8);
  bytes.writeUInt32LE(1, 12);
  bytes.writeDoubleLE(performance.now() / 1000, 16);
  position.forEach((coordinate, i) => bytes.writeDoubleLE(coordinate / 1000, 24 + 8 * i));
  q.forEach((part, i) => bytes.writeDoubleLE(part, 48 + 8 * i));
  return bytes;
}

async function freePort() {
  const socket = createSocket("udp4");
  await new Promise((done) => socket.bind(0, "127.0.0.1", done));
  const { port } = socket.address();
  await new Promise((done) => socket.close(done));
  return port;
}

test("a finger is registered, saved, and the device stays away until released", { timeout: 300_000 }, async () => {
  const folder = mkdtempSync(join(tmpdir(), "softfinger-person-"));
  const person = join(folder, "anna.toml");
  const model = resolve(dirname(scene), "../fingers/index.toml");
  const mesh = JSON.parse(execFileSync(program, ["finger", "show", model, "--json"])).mesh_statistics;
  const held = postures(mesh.skin_min_mm, mesh.skin_max_mm);
  const port = await freePort();
  const running = await startProgram(program,
    ["run", scene, "--tracker", `udp:${port}`, "--person", person, "--no-twin", "--port", "0"]);
  const socket = createSocket("udp4");
  let posture = "pad";
  let number = 0;
  const sender = setInterval(() => socket.send(datagram(++number, held[posture]), port, "127.0.0.1"), 8);
  const browser = await openPage(running.url, { width: 1100, height: 700 });
  const { page } = browser;
  try {
    await page.locator("#register").click();
    await page.locator("#register-table").fill(String(kTable));
    await page.locator("#register-start").click();
    await page.waitForFunction(() => document.body.dataset.registration === "running");
    await page.waitForFunction(() => document.body.dataset.device === "retracting");
    assert.ok(await page.locator("#register-run").isVisible());
    if (process.env.SOFTFINGER_PICTURE) await page.screenshot({ path: process.env.SOFTFINGER_PICTURE });
    while (await browser.data("registration") === "running") {
      posture = await page.evaluate(() => document.getElementById("registration").dataset.posture);
      await page.waitForTimeout(50);
    }
    assert.equal(await browser.data("registration"), "saved", await page.locator("#register-result").textContent());
    assert.ok(existsSync(person));
    const [, ...found] = /translation_mm = \[([-\d.]+), ([-\d.]+), ([-\d.]+)\]/.exec(readFileSync(person, "utf8"));
    found.forEach((coordinate, i) => assert.ok(Math.abs(coordinate - kOffset[i]) < 0.05, `${found}`));

    await page.waitForFunction(() => document.body.dataset.generation === "2");
    await page.waitForFunction(() => document.body.dataset.device === "retracting");
    assert.ok(await page.locator("#release").isVisible());
    await page.locator("#register-done").click();
    await page.waitForFunction(() => document.body.dataset.registration === "idle");
    assert.ok(await page.locator("#registration").isHidden());
    await releaseDevice(page);
    assert.deepEqual(browser.complaints, []);
  } finally {
    clearInterval(sender);
    socket.close();
    await browser.close();
    assert.equal(await running.stop(), 0);
    rmSync(folder, { recursive: true, force: true });
  }
});
