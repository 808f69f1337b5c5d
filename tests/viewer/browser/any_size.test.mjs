// The page at any size and in any state: nothing cut, overprinted or out of reach, legible, to be used by keyboard and
// screen reader alone. A synthetic feed makes the states; one browser sees them all.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { openPage, startProgram } from "./live_program.mjs";
import { contrastFaults, layoutFaults } from "./page_checks.mjs";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SOFTFINGER_FAKE_FEED ?? resolve(root, "build/tests/viewer/browser/fake_feed_server");
const pictures = process.env.SOFTFINGER_PICTURES; // a folder to leave a picture of each case in
const sizes = [[1600, 1000], [1400, 900], [1024, 768], [390, 844]].map(([width, height]) => ({ width, height }));

let running;
let browser;
let page;

before(async () => {
  running = await startProgram(program, []);
  browser = await openPage(running.url, sizes[0]);
  page = browser.page;
  await moving(() => page.waitForFunction(() => Number(document.body.dataset.contacts) > 10));
}, { timeout: 300_000 });

after(async () => {
  await browser?.close();
  await running?.stop();
});

/** The feed stands still, and with it what is drawn, but until then. */
async function moving(happened) {
  running.tell("go on");
  await happened();
  running.tell("freeze");
}
const body = (name, value) => page.waitForFunction(([key, wanted]) => document.body.dataset[key] === wanted, [name, value], { polling: 30 });
const press = (selector) => page.evaluate((wanted) => document.querySelector(wanted).click(), selector);
const showScene = async (name) => {
  await press(`[data-scene="${name}"]`);
  await body("scene", name);
  await page.waitForFunction(() => Number(document.body.dataset.time) > 0 && document.body.dataset.device !== "", null, { polling: 30 });
};
const showFinger = async (name) => {
  await press(`[data-finger="${name}"]`);
  await body("finger", name === "All fingers" ? "" : name);
  await page.waitForFunction(() => document.body.dataset.device !== "", null, { polling: 30 });
};
/** Resize observers and a picture come after this. */
const settled = () => page.evaluate(() => new Promise((done) => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(done)), 60)));

/** Looks at the present state at every size. */
async function lookAtEverySize(state) {
  const faults = [];
  for (const size of sizes) {
    await page.setViewportSize(size);
    await settled();
    const at = `${state}, ${size.width} x ${size.height}`;
    for (const check of [layoutFaults, contrastFaults]) faults.push(...(await page.evaluate(check)).map((fault) => `${at}: ${fault}`));
    if (pictures) {
      mkdirSync(pictures, { recursive: true });
      const path = join(pictures, `${state.replaceAll(/\W+/g, "-")}-${size.width}x${size.height}.png`);
      await page.screenshot({ path, fullPage: true });
    }
  }
  assert.deepEqual(faults, []);
}

test("one finger", () => lookAtEverySize("one finger"));

test("paused, with a device that is not as it should be", async () => {
  await showScene("relief");
  await moving(() => page.waitForFunction(() => document.body.dataset.limited === "true", null, { polling: 30 }));
  await press("#pause");
  await body("state", "paused");
  assert.equal(await page.locator("#device-limited").textContent(), "force limit");
  assert.ok(await page.locator("#device-limited").isVisible());
  assert.equal(await page.locator("#device-warning").textContent(), "⚠ warning");
  assert.match(await page.locator("#device-notices").textContent(), /^Force limit: max_force_N = .*never presses$/);
  await lookAtEverySize("paused with a warning");
  await press("#pause");
  await body("state", "running");
});

test("without a twin; moved by the page; in a headset", async () => {
  for (const scene of ["corner", "plane", "cylinder"]) {
    await showScene(scene);
    await lookAtEverySize(`one finger, ${scene}`);
  }
});

test("stopped, with much to tell", async () => {
  await showScene("sphere");
  assert.ok(await page.locator("#device-limited").isHidden());
  assert.ok(await page.locator("#device-warning").isHidden());
  assert.equal(await page.locator("#device-notices li").count(), 0);
  await press("#stop");
  await body("stopped", "true");
  for (let k = 0; k < 4; ++k) running.tell(`say port /dev/serial/by-id/usb-Pololu_Corporation_Maestro-if0${k}: gone; the run goes on and tries to open it again`);
  await page.locator("#notifications li").nth(3).waitFor();
  await lookAtEverySize("stopped with messages");
  await press("#release");
  await lookAtEverySize("asked to release");
  await press("#release-keep");
  assert.ok(await page.locator("#release-ask").isHidden());
  await press("#release");
  await body("stopped", "true");
  await press("#release-now");
  await body("stopped", "false");
  await page.evaluate(() => document.getElementById("notifications").replaceChildren());
});

test("registering", async () => {
  await press("#register");
  await lookAtEverySize("asked to register");
  await press("#register-start");
  await body("registration", "running");
  await lookAtEverySize("registering");
  await press("#register-cancel");
  await page.locator("#registration").waitFor({ state: "hidden" });
});

test("fitting", async () => {
  await press("#fit");
  await lookAtEverySize("asked to fit");
  await press("#fit-start");
  await body("fit", "pressing");
  assert.match(await page.locator("#fit-run").textContent(), /Press 3 of 9, 0\.41 N/);
  await lookAtEverySize("fitting");
  await press("#fit-stop");
  await body("fit", "refused");
  await body("stopped", "true");
  await lookAtEverySize("fit ended");
  await press("#fit-done");
  await page.locator("#fitting").waitFor({ state: "hidden" });
  await press("#release");
  await press("#release-now");
  await body("stopped", "false");
});

test("fitting by touch", async () => {
  await showScene("edge");
  await press("#fit");
  assert.match(await page.locator("#fit-ask").innerText(), /no force sensor/);
  assert.doesNotMatch(await page.locator("#fit-ask").innerText(), /0\.8 N/);
  await lookAtEverySize("asked to fit by touch");
  await press("#fit-start");
  await body("fit", "pressing");
  assert.match(await page.locator("#fit-run").innerText(), /Touch 3 of 10(?!.*N)/);
  await lookAtEverySize("fitting by touch");
  const touch = (number) => page.waitForFunction((wanted) => document.querySelector("#fit-press").textContent === wanted, `Touch ${number} of 10`, { polling: 30 });
  await page.keyboard.press("Space"); // the button has the focus
  await touch(4);
  await page.locator("#fit-press").click(); // and now nothing has
  await page.keyboard.press("Space");
  await touch(5);
  await press("#fit-felt");
  await touch(6);
  await page.keyboard.press("Escape");
  await page.locator("#fitting").waitFor({ state: "hidden" });
  await body("stopped", "true");
  await press("#release");
  await press("#release-now");
  await body("stopped", "false");
  await showScene("sphere");
});

test("loading", async () => {
  running.tell("loading hand");
  await body("loading", "hand");
  assert.equal(await page.locator("#notice").textContent(), "Loading hand …");
  await lookAtEverySize("loading");
  running.tell("loading");
  await body("loading", "");
  assert.equal(await page.locator("#notice").textContent(), "");
});

test("five fingers in one view, each with its device's state and what is wrong with it", async () => {
  await showScene("hand");
  assert.equal(await browser.data("view"), "hand");
  assert.equal(await page.locator('#fingers [aria-checked="true"]').textContent(), "All fingers");
  assert.ok(await page.locator("#rendered").isHidden());
  await moving(() => page.waitForFunction(() => Number(document.body.dataset.contacts) > 20 &&
    document.querySelector('[data-row="middle"] .mark:not(.warning):not([hidden])'), null, { polling: 30 }));
  const rows = (await page.locator("#hand-fingers tr").allInnerTexts()).map((row) => row.replaceAll(/\s+/g, " "));
  assert.equal(rows.length, 5);
  rows.forEach((row, i) => {
    assert.match(row, new RegExp(`^${["thumb", "index", "middle", "ring", "pinky"][i]} \\d+\\.\\d\\d N \\d+ of \\d+ (rendering|ready)`, "i"));
    assert.equal(/warning/.test(row), i === 2 || i === 4, row);
  });
  assert.match(await page.locator("#hand-notices").textContent(), /^Middle, force limit: .*Pinky, approach: /);
  await lookAtEverySize("five fingers");
});

test("one of five fingers", async () => {
  await showFinger("thumb");
  await lookAtEverySize("one of five fingers");
  await showFinger("pinky");
  assert.match(await page.locator("#device-notices").textContent(), /^Approach: /);
  assert.ok(await page.locator("#device-limited").isHidden());
});

test("a reload keeps what is shown", async () => {
  for (const [finger, view] of [["ring", "finger"], ["All fingers", "hand"]]) {
    await showFinger(finger);
    await page.reload();
    await body("view", view);
    assert.equal(await page.locator('#fingers [aria-checked="true"]').textContent(), finger);
  }
});

/** What Tab comes to, until it comes round. */
async function tabStops() {
  const stops = [];
  await page.evaluate(() => document.activeElement?.blur());
  for (let k = 0; k < 40; ++k) {
    await page.keyboard.press("Tab");
    const stop = await page.evaluate(() => {
      const at = document.activeElement;
      if (at === document.body) return null;
      const style = getComputedStyle(at);
      if (style.outlineStyle === "none" || parseFloat(style.outlineWidth) < 1) return `${at.id}: no outline`;
      return at.id || at.closest("[id]").id + (at.getAttribute("role") === "radio" ? ` ${at.textContent}` : "");
    });
    if (stop === null || (stop === stops[0] && stops.length > 1)) break;
    stops.push(stop);
  }
  return stops;
}

test("Tab comes to every control, in the order of the page", async () => {
  await page.setViewportSize(sizes[1]);
  await showScene("hand");
  await showFinger("All fingers");
  assert.deepEqual(await tabStops(), ["scenes hand", "fingers All fingers", "pause", "restart", "stop", "virtual-view", "reset-view",
    ...Array(5).fill("hand-fingers")]);
  await showFinger("thumb");
  assert.deepEqual(await tabStops(), ["scenes hand", "fingers thumb", "pause", "restart", "register", "fit", "stop", "virtual-view",
    "reset-view", "rendered-view", "objective", "plot-step"]);
});

test("arrow keys move through scenes and fingers, and keep the focus", async () => {
  const focused = () => page.evaluate(() => document.activeElement.textContent);
  await showScene("hand");
  await showFinger("thumb");
  await page.locator('#fingers [aria-checked="true"]').focus();
  for (const [key, finger] of [["ArrowRight", "index"], ["ArrowDown", "middle"], ["ArrowLeft", "index"], ["Home", ""], ["ArrowUp", "pinky"], ["ArrowRight", ""]]) {
    await page.keyboard.press(key);
    await body("finger", finger);
    assert.equal(await focused(), finger || "All fingers");
    assert.equal(await page.locator('#fingers [aria-checked="true"]').textContent(), finger || "All fingers");
  }
  await page.locator('#scenes [aria-checked="true"]').focus();
  await page.keyboard.press("ArrowRight");
  await body("scene", "plane");
  assert.equal(await focused(), "plane");
  await page.keyboard.press("End");
  await body("scene", "sphere");
  await page.keyboard.press("ArrowRight");
  await body("scene", "corner");
  assert.equal(await focused(), "corner");
});

test("arrow keys turn a view that Tab has come to", async () => {
  await page.locator("#reset-view").focus();
  await page.keyboard.press("Shift+Tab");
  assert.equal(await page.evaluate(() => document.activeElement.id), "virtual-view");
  await page.locator("#rendered-view").focus();
  await page.keyboard.press("Tab");
  await page.keyboard.press("Shift+Tab");
  const clip = await page.locator("#rendered").boundingBox();
  const before = await page.screenshot({ clip });
  for (let k = 0; k < 4; ++k) await page.keyboard.press("ArrowRight");
  await settled();
  await page.waitForTimeout(300);
  assert.ok(!before.equals(await page.screenshot({ clip })), "nothing turned");
});

test("a dialog takes the focus, keeps it, gives it back; Escape closes it and stops the device", async () => {
  await page.setViewportSize(sizes[1]);
  await page.locator("#register").focus();
  await page.keyboard.press("Enter");
  const inside = () => page.evaluate(() => document.activeElement.closest("#registration") !== null);
  assert.ok(await inside());
  const visited = new Set();
  for (const key of ["Tab", "Shift+Tab"]) {
    for (let k = 0; k < 8; ++k) {
      await page.keyboard.press(key);
      assert.ok(await inside(), `${key} left the dialog`);
      visited.add(await page.evaluate(() => document.activeElement.id));
    }
  }
  assert.equal(visited.size, 6);
  await page.keyboard.press("Escape");
  assert.ok(await page.locator("#registration").isHidden());
  assert.equal(await page.evaluate(() => document.activeElement.id), "register");
  await body("stopped", "true");

  await page.keyboard.press("Enter");
  await page.locator("#register-length").press("Enter"); // sends the form
  await body("registration", "running");
  assert.equal(await page.evaluate(() => document.activeElement.id), "register-cancel");
  await page.keyboard.press("Enter");
  await body("registration", "idle");
  assert.equal(await page.evaluate(() => document.activeElement.id), "register");
  await press("#release");
  await body("stopped", "true");
  await press("#release-now");
  await body("stopped", "false");
});

test("a screen reader is told what everything is, and what changes", async () => {
  const session = await page.context().newCDPSession(page);
  const tree = async () => (await session.send("Accessibility.getFullAXTree")).nodes.filter(({ ignored }) => !ignored)
    .map((node) => ({
      role: node.role?.value, name: node.name?.value ?? "",
      ...Object.fromEntries((node.properties ?? []).map(({ name, value }) => [name, value.value])),
      id: node.nodeId, children: node.childIds ?? [],
    }));
  await showScene("hand");
  await showFinger("thumb");
  let nodes = await tree();
  const of = (role) => nodes.filter((node) => node.role === role).map(({ name }) => name);
  for (const { role, name } of nodes) {
    if (["button", "radio", "radiogroup", "img", "image", "dialog", "region", "spinbutton", "table"].includes(role) && role !== "table") {
      assert.notEqual(name.trim(), "", `a ${role} has no name`);
    }
  }
  assert.deepEqual(of("radiogroup"), ["Scene", "Finger"]);
  assert.deepEqual(nodes.filter(({ role, checked }) => role === "radio" && checked === "true").map(({ name }) => name.toLowerCase()), ["hand", "thumb"]);
  assert.equal(of("radio").length, 7 + 6);
  assert.ok(of("button").includes("Pause") && of("button").some((name) => name.startsWith("Stop")), String(of("button")));
  assert.ok(of("heading").includes("Virtual touch") && of("heading").includes("Twin"));
  const live = () => nodes.filter((node) => node.live === "polite" || node.live === "assertive").map(({ role }) => role);
  assert.ok(live().filter((role) => role === "status").length >= 1, String(live()));

  await press("#pause");
  await body("state", "paused");
  nodes = await tree();
  const told = nodes.filter(({ role }) => role === "status")
    .flatMap(({ children }) => nodes.filter(({ id }) => children.includes(id)).map(({ name }) => name));
  assert.ok(told.includes("Paused"), `told: ${told}`);
  assert.ok(of("button").includes("Resume"));
  await press("#pause");
  await body("state", "running");
  assert.equal(await page.locator("#announcer").textContent(), "Running");

  await press("#register");
  nodes = await tree();
  assert.deepEqual(nodes.filter(({ role }) => role === "dialog").map(({ name, modal }) => ({ name, modal })), [{ name: "Register this finger", modal: true }]);
  for (const name of of("spinbutton")) assert.match(name, /^(Length|Breadth|Depth|Height of the table)/);
  await press("#register-close");

  await showFinger("All fingers");
  nodes = await tree();
  assert.deepEqual(of("columnheader"), ["finger", "normal force", "device"]);
  assert.deepEqual(of("rowheader").map((name) => name.toLowerCase()), ["thumb", "index", "middle", "ring", "pinky"]);
  await session.detach();
});

test("the checks find what is broken", async () => {
  await page.setViewportSize(sizes[0]);
  await showScene("sphere");
  await settled();
  const breaks = [
    [layoutFaults, /wide in a window/, (d) => (d.getElementById("virtual-what").style.cssText = "position:absolute;left:0;width:2000px")],
    [layoutFaults, /overprint each other/, (d) => (d.getElementById("notice").style.cssText = "position:absolute;top:14px;left:18px;visibility:visible;height:auto", d.getElementById("notice").textContent = "Broken")],
    [layoutFaults, /out of reach/, (d) => (d.querySelector("#plot-force h2").style.cssText = "position:relative;left:-400px")],
    [layoutFaults, /is cut by/, (d) => (d.querySelector(".status").style.cssText = "overflow:hidden;width:200px;flex-wrap:nowrap")],
    [layoutFaults, /is clipped/, (d) => (d.getElementById("rendered-what").style.cssText = "overflow:hidden;width:40px;white-space:nowrap")],
    [layoutFaults, /stop button is not in sight/, (d) => (d.querySelector(".bar").style.cssText = "position:relative;top:-40px")],
    [layoutFaults, /registration.*covers header/, (d) => (d.getElementById("registration").style.cssText = "top:40px;left:900px;width:900px", d.getElementById("registration").hidden = false)],
    [layoutFaults, /is distorted/, (d) => (d.getElementById("patch-twin").style.height = "50%")],
    [layoutFaults, /wider than its button/, (d) => (d.getElementById("restart").style.cssText = "width:40px;overflow:hidden")],
    [contrastFaults, /at least 4.5/, (d) => (d.getElementById("virtual-what").style.color = "#667386")],
    [contrastFaults, /at least 4.5/, (d) => (d.querySelector("main").style.opacity = "0.45")],
    [contrastFaults, /at least 3$/, (d) => (d.querySelector(".link i").style.background = "#222b37")],
    [contrastFaults, /nothing marks it/, (d) => (d.querySelector("[aria-checked=true]").style.boxShadow = "none")],
  ];
  for (const [check, found, damage] of breaks) {
    assert.deepEqual(await page.evaluate(check), []);
    // In one task with the check, so that nothing mends it in between.
    const faults = await page.evaluate(`(() => {
      (${damage})(document);
      return (${check})();
    })()`);
    assert.ok(faults.some((fault) => found.test(fault)), `${damage} gives ${JSON.stringify(faults)}`);
    await page.evaluate(() => {
      for (const element of document.querySelectorAll("[style]")) {
        if (!element.closest("#plots, #measures, .pressure") || element.matches("h2")) element.removeAttribute("style");
      }
      document.getElementById("registration").hidden = true;
      document.getElementById("notice").textContent = "";
    });
    await settled();
  }
});

test("has no complaints", () => assert.deepEqual(browser.complaints, []));

test("the program is gone", async () => {
  await showScene("hand");
  await showFinger("All fingers");
  await moving(() => page.waitForFunction(() => Number(document.body.dataset.contacts) > 20, null, { polling: 30 }));
  assert.equal(await running.stop(), 0);
  await body("connection", "lost");
  assert.match(await page.locator("#notice").textContent(), /^No connection/);
  assert.equal(await page.locator("#device-state").textContent(), "unknown");
  await lookAtEverySize("five fingers, the program gone");
  await showFinger("thumb");
  await page.waitForFunction(() => document.getElementById("patch-twin").width > 2, null, { polling: 30 });
  assert.equal(await page.locator("#device-state").textContent(), "unknown");
  await lookAtEverySize("one of five fingers, the program gone");
});
