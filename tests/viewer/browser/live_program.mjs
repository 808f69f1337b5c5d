// Starts the program with its live page on a free port, and a browser that looks at it.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const kPatience = 120_000; // ms; software rendering on a busy machine is slow

/** Runs `program` and waits for the address it prints. */
export async function startProgram(program, args) {
  const child = spawn(program, args, { stdio: ["pipe", "pipe", "pipe"] });
  let output = "";
  const exited = new Promise((resolve) => {
    child.on("error", (error) => resolve({ code: -1, output: String(error) }));
    child.on("close", (code) => resolve({ code, output }));
  });
  const url = await new Promise((resolve, reject) => {
    const read = (chunk) => {
      output += chunk;
      process.stderr.write(chunk); // a test that fails shows what the program had to say
      const address = /http:\/\/127\.0\.0\.1:(\d+)/.exec(output);
      if (address) resolve(address[0]);
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    exited.then((end) => reject(new Error(`${program} ended with ${end.code}:\n${end.output}`)));
  });
  return {
    url,
    pid: child.pid,
    /** A line to its standard input. */
    tell: (line) => child.stdin.write(`${line}\n`),
    /** Ends it as Ctrl-C does; resolves with its exit status. */
    async stop() {
      child.kill("SIGINT");
      const giveUp = setTimeout(() => child.kill("SIGKILL"), 20_000);
      const { code } = await exited;
      clearTimeout(giveUp);
      return code;
    },
  };
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
      await page.waitForTimeout(300); // until it is drawn
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
