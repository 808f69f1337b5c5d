// What npm would publish: its files, its types in a project that has nothing else, and the example over it.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { clientFolder, kProtocolVersion } from "./client_under_test.mjs";
import { startProgram } from "./running_program.mjs";
import { program, root } from "./touch_scene.mjs";

const kLimit = { timeout: 120_000 };

let project; // with the packed files alone, and ws, in node_modules
let packed;

const tsc = (folder, ...options) => spawnSync(process.execPath, [join(clientFolder, "node_modules/typescript/bin/tsc"), ...options],
  { cwd: folder, encoding: "utf8" });

before(() => {
  project = mkdtempSync(join(tmpdir(), "softfinger-package-"));
  [packed] = JSON.parse(execFileSync("npm", ["pack", "--dry-run", "--json", "--ignore-scripts"], { cwd: clientFolder, encoding: "utf8" }));
  const installed = join(project, "node_modules/softfinger-client");
  for (const { path } of packed.files) cpSync(join(clientFolder, path), join(installed, path));
  symlinkSync(join(clientFolder, "node_modules/ws"), join(project, "node_modules/ws"));
});

after(() => rmSync(project, { recursive: true, force: true }));

test("the package has its sources, types, README and licence, and nothing else", () => {
  const sources = ["address", "browser", "client", "connection", "node", "wire"].map((name) => `src/${name}.js`);
  assert.deepEqual(packed.files.map(({ path }) => path).sort(),
    ["LICENSE", "README.md", "package.json", ...sources, "src/index.d.ts", "src/messages.d.ts"].sort());
  assert.equal(readFileSync(join(clientFolder, "LICENSE"), "utf8"), readFileSync(join(root, "LICENSE"), "utf8"));
});

const kProgram = `
import { connect, kHandJoints, kProtocolVersion, open, type Client, type FingerSnapshot, type Request, type Scene } from "softfinger-client";
const client = await connect("http://127.0.0.1:8080", { token: "t", ca: "c" });
const scene: Scene = client.scene;
const off: () => void = client.on("snapshot", ({ time_s, fingers, X_WO }) => {
  const finger: FingerSnapshot | undefined = fingers[0];
  const force: number = (finger?.normal_force_N ?? 0) + time_s + (finger?.twin?.iou ?? NaN) + (X_WO[0]?.[0] ?? 0);
  if (force > 1) client.pause();
});
client.on("state", (state, why: string) => state === "lost" && why.length);
const told: string[] = (await client.next("notifications")).lines;
const sent: boolean = client.pose("index", [0, 0, 1]) && client.hand("left", new Float32Array(8 * kHandJoints.length)) &&
  client.register(0, { table_mm: 3 }) && client.chooseScene("plane") && client.chooseObjective(0, "plane") && client.stop() && client.release();
const request: Request = { request: "pause" };
const other: Client = open("http://127.0.0.1:8080");
other.send(request);
// @ts-expect-error
client.on("nothing", () => {});
// @ts-expect-error
client.pose("index", "high");
// @ts-expect-error
client.register(0, { colour: 3 });
// @ts-expect-error
other.scene.generation;
off();
export { kProtocolVersion, scene, sent, told };
`;

for (const [module, moduleResolution] of [["NodeNext", "NodeNext"], ["ESNext", "Bundler"]]) {
  test(`its types do in an empty project, strict, as ${moduleResolution} finds them`, kLimit, () => {
    writeFileSync(join(project, "package.json"), JSON.stringify({ type: "module" }));
    writeFileSync(join(project, "program.ts"), kProgram);
    const { status, stdout } = tsc(project, "--noEmit", "--strict", "--target", "ES2022", "--lib", "ES2022", "--module", module,
      "--moduleResolution", moduleResolution, "--noUncheckedIndexedAccess", "--skipDefaultLibCheck", "program.ts");
    assert.equal(stdout, "");
    assert.equal(status, 0);
  });
}

test("its sources are of its types", kLimit, () => {
  const { status, stdout } = tsc(clientFolder);
  assert.equal(stdout, "");
  assert.equal(status, 0);
});

test("the example touches a plane, by a program that wants a token", kLimit, async () => {
  mkdirSync(join(project, "example"));
  for (const file of ["touch.js", "package.json"]) copyFileSync(join(root, "examples/javascript_program", file), join(project, "example", file));
  writeFileSync(join(project, "token"), "0123456789abcdef\n", { mode: 0o600 });
  const running = await startProgram(program,
    ["run", join(root, "scenes/plane.toml"), "--tracker", "page", "--no-twin", "--port", "0", "--token", join(project, "token")]);
  const touch = (address) => spawnSync(process.execPath, ["touch.js", address], { cwd: join(project, "example"), encoding: "utf8" });
  try {
    const { status, stdout, stderr } = touch(`${running.url}/?token=0123456789abcdef`);
    assert.equal(stderr, "");
    assert.equal(status, 0);
    const forces = stdout.trim().split("\n").map((line) => Number(/^[\d.]+ s +([\d.]+) N/.exec(line)[1]));
    assert.ok(forces.length > 5 && forces[0] === 0 && forces.at(-1) > 0.05, stdout);
    const stranger = touch(running.url);
    assert.match(stranger.stderr, /^softfinger at \S+: asks for its token; [^\n]*\n$/);
    assert.equal(stranger.status, 1);
  } finally {
    assert.equal(await running.stop(), 0);
  }
});

test("a browser gets an entry of its own, without ws", () => {
  const { exports } = JSON.parse(readFileSync(join(clientFolder, "package.json"), "utf8"));
  assert.deepEqual(Object.keys(exports["."]), ["types", "browser", "default"]);
  const conditions = spawnSync(process.execPath, ["--conditions=browser", "--input-type=module", "-e",
    'import { connect, kProtocolVersion } from "softfinger-client"; console.log(typeof connect, kProtocolVersion)'],
  { cwd: rmWs(), encoding: "utf8" });
  assert.equal(conditions.stdout, `function ${kProtocolVersion}\n`, conditions.stderr);
});

/** The project, from which ws is taken: last, so that nothing needs it any more. */
function rmWs() {
  rmSync(join(project, "node_modules/ws"));
  return project;
}
