// Each message of docs/protocol.md, to and from the real program, over the client.
import assert from "node:assert/strict";
import { createSocket } from "node:dgram";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { connect, kHandJoints, kProtocolVersion, readSnapshot, WebSocket } from "./client_under_test.mjs";
import { readSection } from "./frame_by_page.mjs";
import { bits, keys, layout, names } from "./protocol_page.mjs";
import { startProgram } from "./running_program.mjs";
import { program, writeScenes } from "./touch_scene.mjs";

const kPatience = 60_000; // ms; the machine may be busy
const kAgain = 20; // ms between poses

let folder, running, client;
const said = []; // lines for people

/** Waits for a message that `wanted` takes; tells what was waited for where none comes. */
function until(kind, wanted, why) {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => end(reject, new Error(`${why}: not within ${kPatience / 1000} s`)), kPatience);
    let off = () => {};
    const end = (settle, what) => {
      clearTimeout(timer);
      setImmediate(() => off()); // on() may call before it returns
      settle(what);
    };
    off = client.on(kind, (message) => wanted(message) && end(resolve, message));
  });
}
/** Waits until people were told a line that has `text`. */
const line = async (text) => {
  const heard = () => said.some((each) => each.includes(text));
  if (!heard()) await until("notifications", heard, text);
};
const snapshot = (wanted, why) => until("snapshot", wanted, why);

/** Sends again and again until `arrived` settles, as a tracker does. */
async function meanwhile(send, arrived) {
  const timer = setInterval(send, kAgain);
  try {
    return await arrived;
  } finally {
    clearInterval(timer);
  }
}

/** A socket of its own: what the client would not send, or would not keep. */
async function rawSocket() {
  const socket = new WebSocket(`${running.url.replace("http", "ws")}/ws`);
  socket.binaryType = "arraybuffer";
  await new Promise((resolve, reject) => Object.assign(socket, { onopen: resolve, onerror: reject }));
  return socket;
}

const sorted = (list) => [...list].sort();
const sameKeys = (value, section, but = []) =>
  assert.deepEqual(sorted(Object.keys(value)), sorted(keys(section).filter((key) => !but.includes(key))), section);

async function freePort() {
  const socket = createSocket("udp4");
  await new Promise((done) => socket.bind(0, "127.0.0.1", done));
  const { port } = socket.address();
  await new Promise((done) => socket.close(done));
  return port;
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "softfinger-protocol-"));
  const scene = writeScenes(folder, await freePort());
  running = await startProgram(program, ["run", scene, "--port", "0", "--person", join(folder, "anna.toml")]);
  client = await connect(running.url);
  client.on("notifications", ({ lines }) => said.push(...lines));
});

after(async () => {
  client?.close();
  assert.equal(await running?.stop(), 0);
  rmSync(folder, { recursive: true, force: true });
});

test("Scene has the keys of the page, and its version", () => {
  const { scene } = client;
  sameKeys(scene, "Scene");
  assert.equal(scene.protocol_version, kProtocolVersion);
  assert.deepEqual(scene.scenes, ["again", "broken", "touch"]);
  const [index, middle, ring] = scene.fingers;
  for (const finger of scene.fingers) sameKeys(finger, "FingerDescription");
  sameKeys(index.workspace, "Workspace");
  sameKeys(middle.headset, "FollowedFinger");
  sameKeys(scene.objectives[0], "Objective");
  sameKeys(scene.device_states[0], "DeviceState");
  sameKeys(scene.latency_stages[0], "LatencyStage");
  assert.ok(scene.notices.length > 0, "a scene without notices shows nothing of them");
  sameKeys(scene.notices[0], "Notice");
  assert.deepEqual(scene.fingers.map((finger) => finger.moved_here), [true, false, false]);
  assert.equal(middle.headset.finger, "middle");
  assert.deepEqual(middle.headset.start, [100, 0, 20, 0, 0, 0, 1]);
  assert.ok(ring.registrable && index.twin && !middle.device_kind);
  assert.ok(index.fittable && !index.fits_by_touch && !middle.fittable && ring.fittable && ring.fits_by_touch);
  assert.ok(index.skin_positions_mm.length > 300 && index.objectives.length > 0);
});

test("Shape: each kind has its keys, and those together are the page's", () => {
  const shapes = client.scene.objects.map(({ shape }) => shape);
  assert.deepEqual(shapes.map(({ kind }) => kind), ["plane", "sphere", "box", "cylinder", "mesh", "sphere", "soft"]);
  assert.deepEqual(sorted(new Set(shapes.flatMap(Object.keys))), sorted(keys("Shape")));
  assert.deepEqual(shapes[2], { kind: "box", size_mm: [4, 5, 6], edge_radius_mm: 0.5 });
  assert.equal(shapes[4].positions_mm.length % 3, 0);
  assert.deepEqual(Object.keys(shapes[6]), Object.keys(shapes[4]));
});

test("Snapshot, FingerSnapshot and Twin lie as the page has their bytes", async () => {
  const press = () => client.pose("index", [0, 0, 5.5]);
  const read = await meanwhile(press, snapshot(({ fingers: [{ twin }] }) => twin?.normal_force_N > 0.1, "a pressed twin"));
  assert.ok(read.fingers[0].normal_force_N > 0.1);
  const { fields, parsed } = await meanwhile(press, sameFrame());
  assert.equal(fields.fingers, 3);
  assert.ok(parsed.fingers[0].twin && !parsed.fingers[1].twin);
});

test("SoftObject lies as the page has its bytes, and gives way", async () => {
  const rest = client.scene.objects[6].shape.positions_mm;
  const sunk = ({ soft_objects: [{ positions_mm }] }) => Math.max(...positions_mm.map((at, i) => Math.abs(at - rest[i])));
  await snapshot((one) => one.soft_objects.length > 0 && sunk(one) > 0.1, "a sponge that sinks by its weight");
  const { fields, parsed } = await sameFrame();
  assert.equal(fields.soft_objects, 1);
  assert.equal(parsed.soft_objects[0].object, 6);
  assert.equal(parsed.soft_objects[0].positions_mm.length, rest.length);
  assert.ok(sunk(parsed) < 5, "by more than its weight");
});

/** The next frame, which client and page read alike to the last byte. */
async function sameFrame() {
  const socket = await rawSocket();
  const frame = await new Promise((resolve) => (socket.onmessage = ({ data }) => typeof data !== "string" && resolve(data)));
  socket.close();
  const parsed = readSnapshot(frame, client.scene);
  const { fields, end } = readSection("Snapshot", frame, 0);
  sameFields(parsed, fields, "Snapshot", ["fingers", "X_WO", "soft_objects"]);
  assert.deepEqual(parsed.X_WO.flatMap((pose) => [...pose]), fields.X_WO);
  assert.equal(new TextDecoder().decode(new Uint8Array(frame, 0, 4)), "SFSA");
  const behind = parsed.fingers.reduce((at, finger) => sameFinger(finger, frame, at), end);
  assert.equal(parsed.soft_objects.length, fields.soft_objects);
  assert.equal(parsed.soft_objects.reduce((at, soft) => sameSoftObject(soft, frame, at), behind), frame.byteLength);
  return { fields, parsed };
}

/** What the client reads by that name is what the page has there; and it reads nothing that the page does not name. */
function sameFields(parsed, fields, section, but = []) {
  const flags = Object.keys(fields).find((name) => name.endsWith("flags"));
  const bit = flags ? bits(section, flags) : {};
  for (const [name, value] of Object.entries(parsed)) {
    if (but.includes(name)) continue;
    if (typeof value === "boolean") assert.equal(value, (fields[flags] & bit[name]) !== 0, `${section}: ${name}`);
    else if (name === "objective") assert.equal(value, fields[flags] >>> 8);
    else if (name === "device_state") assert.equal(value, String.fromCharCode(...fields[name].filter((c) => c !== 0)));
    else assert.deepEqual(typeof value === "object" ? [...value] : value, fields[name], `${section}: ${name}`);
    assert.ok(names(section).has(name), `${section}: ${name}`);
  }
}

function sameSoftObject(soft, frame, start) {
  const { fields, end } = readSection("SoftObject", frame, start);
  sameFields(soft, fields, "SoftObject");
  return end;
}

function sameFinger(finger, frame, start) {
  const { fields, end } = readSection("FingerSnapshot", frame, start);
  sameFields(finger, fields, "FingerSnapshot", ["twin"]);
  assert.equal(finger.twin !== null, fields.twin_samples > 0);
  assert.ok(client.scene.device_states.some(({ name }) => name === finger.device_state) || finger.device_state === "");
  if (!finger.twin) return end;
  const twin = readSection("Twin", frame, end, fields);
  sameFields(finger.twin, twin.fields, "Twin");
  return twin.end;
}

test("Events tell once of a marble that falls on the table", async () => {
  const impacts = [];
  const hits = ({ kind, object, other }) => kind === "impact" && object === "table" && other === "marble";
  const off = client.on("events", ({ events }) => impacts.push(...events.filter(hits)));
  client.restart();
  const told = await until("events", ({ events }) => events.some(hits), "an impact");
  sameKeys(told, "Events");
  assert.equal(told.generation, client.scene.generation);
  for (const event of told.events) sameKeys(event, "Event");
  const [impact] = impacts;
  // It falls 25 mm, and stays: its momentum, and its weight over 10 ms.
  const speed = Math.sqrt(2 * 9.81 * 0.025);
  assert.ok(Math.abs(impact.time_s - speed / 9.81) < 3e-3, `at ${impact.time_s} s`);
  assert.ok(Math.abs(impact.impulse_N_s - 0.005 * (speed + 0.0981)) < 3e-4, `${impact.impulse_N_s} N s`);
  await snapshot(({ time_s }) => time_s > 0.5, "a marble at rest");
  assert.equal(impacts.length, 1);
  off();
});

test("pause stops simulated time, resume lets it go on", async () => {
  client.pause();
  const paused = await snapshot((one) => one.paused, "a pause");
  assert.ok((await sameFrame()).parsed.paused);
  client.resume();
  const resumed = await snapshot((one) => !one.paused && one.time_s > paused.time_s, "time that goes on");
  assert.equal(resumed.generation, paused.generation);
});

test("pose moves a finger that is the page's, by the client that was first", async () => {
  await meanwhile(() => client.pose(0, [3, -2, 25], [0, 0, 0, 1]), snapshot(({ fingers: [{ X_WFt }] }) =>
    Math.abs(X_WFt[0] - 3) + Math.abs(X_WFt[1] + 2) + Math.abs(X_WFt[2] - 25) + Math.abs(Math.abs(X_WFt[5]) - 1) < 1e-3, "the pose"));
  const other = await connect(running.url);
  const before = client.snapshot.step;
  const both = () => {
    client.pose(0, [3, -2, 25], [0, 0, 0, 1]);
    other.pose(0, [50, 0, 25]);
  };
  const later = await meanwhile(both, snapshot(({ step }) => step > before + 200, "more steps"));
  other.close();
  assert.ok(Math.abs(later.fingers[0].X_WFt[0] - 3) < 1e-3, "moved by the second");
});

test("hold takes an object to where it is wanted, let_go lets it fall", async () => {
  const at = 5; // the marble's place among objects
  assert.deepEqual(client.scene.objects.filter(({ holdable }) => holdable).map(({ name }) => name), ["marble"]);
  assert.equal(client.scene.objects[at].name, "marble");
  const height = ({ X_WO }) => X_WO[at][2];
  await meanwhile(() => client.hold("marble", [900, 10, 40]), snapshot((one) => height(one) > 35, "a marble that is lifted"));
  client.letGo("marble");
  await snapshot((one) => height(one) < 6, "a marble that has fallen");
});

test("Hand moves a finger that follows a headset", async () => {
  assert.equal(layout("Hand").at(-1).type, `f32[${8 * kHandJoints.length}]`);
  // Straight fingers ahead, -z of a y-up space: x of W. Ft is between the distal joint and the tip.
  const joints = new Float32Array(8 * kHandJoints.length);
  kHandJoints.forEach((name, i) => joints.set([-0.01, 0.03, name === "middle-finger-tip" ? -0.12 : -0.1, 0, 0, 0, 1, 0.008], 8 * i));
  const { fingers: [, middle] } = await meanwhile(() => client.hand("left", joints),
    snapshot(({ fingers: [, { X_WFt }] }) => Math.abs(X_WFt[0] - 110) < 0.01, "the hand"));
  assert.ok(Math.abs(middle.X_WFt[1] - 10) < 0.01 && Math.abs(middle.X_WFt[2] - 30) < 0.01, `${middle.X_WFt}`);
  assert.ok(client.hand("left", null), "a hand that is not seen");
});

test("stop retracts devices until release names that stop", async () => {
  client.stop();
  const stopped = await snapshot((one) => one.stopped && one.stop_confirmed, "a stop");
  client.stop();
  await snapshot((one) => one.stops > stopped.stops, "another stop");
  assert.ok((await sameFrame()).parsed.stops >= 2);
  await meanwhile(() => client.release(stopped), line("not released: it was stopped again"));
  assert.ok(client.snapshot.stopped, "released from a stop that nobody saw");
  await meanwhile(() => client.release(), snapshot((one) => !one.stopped, "a release"));
});

test("objective chooses what leads a device", async () => {
  const { scene } = client;
  const [was, other] = scene.fingers[0].objectives.map((place) => scene.objectives[place].name);
  const place = scene.objectives.findIndex(({ name }) => name === other);
  client.chooseObjective("index", other);
  await snapshot(({ fingers: [{ objective }] }) => objective === place, "the other objective");
  client.chooseObjective("index", was);
  await snapshot(({ fingers: [{ objective }] }) => objective !== place, "the first objective");
});

test("register begins a registration, cancel_registration ends it", async () => {
  client.register("ring", { length_mm: 24, table_mm: -40 });
  const registration = await until("registration", ({ state }) => state === "running", "a registration");
  sameKeys(registration, "Registration");
  assert.equal(registration.finger, 2);
  assert.ok(registration.of > 1 && registration.words !== "");
  client.cancelRegistration();
  await until("registration", ({ state }) => state === "idle", "its end");
});

test("fit leads a device that learns its wearer, cancel_fit ends it, and it stays retracted", async () => {
  const { generation } = client.scene;
  client.fit("index");
  const fit = await until("fit", ({ state }) => state === "pressing", "a fit");
  sameKeys(fit, "Fit");
  assert.equal(fit.finger, 0);
  assert.ok(fit.of > 1 && fit.words !== "" && !fit.by_touch);
  assert.ok(client.felt()); // by presses nobody asks for it
  client.cancelFit();
  const ended = await until("fit", ({ state }) => state === "refused", "its end");
  assert.match(ended.message, /ended before it was done/);
  await until("scene", (scene) => scene.generation > generation, "the scene anew");
  await snapshot((one) => one.stopped, "a stopped device");
  client.cancelFit();
  await until("fit", ({ state }) => state === "idle", "a fit that is read and gone");
  await meanwhile(() => client.release(), snapshot((one) => !one.stopped, "a release"));
});

test("scene: Notifications say what is wrong with one, and nothing else changes", async () => {
  const { generation } = client.scene;
  const told = client.next("notifications");
  client.chooseScene("broken");
  await line("broken.toml:2");
  sameKeys(await told, "Notifications");
  assert.equal(client.scene.generation, generation);
});

test("scene: Loading, then a Scene of its own; restart begins another", async () => {
  const { generation } = client.scene;
  client.chooseScene("again");
  const loading = await until("loading", ({ scene }) => scene === "again", "the loading of the other scene");
  sameKeys(loading, "Loading");
  assert.equal(client.scene.generation, generation);
  const other = await until("scene", ({ scene }) => scene === "again", "the other scene");
  assert.ok(other.generation > generation);
  await until("loading", ({ scene }) => scene === "", "the end of loading");
  client.restart();
  const restarted = await until("scene", (scene) => scene.generation > other.generation, "a restart");
  assert.equal(restarted.scene, "again");
  await snapshot((one) => one.generation === restarted.generation, "a snapshot of it");
});

test("what is no request ends the connection, with a reason", async () => {
  for (const wrong of [JSON.stringify({ request: "fly" }), new Uint8Array(15)]) {
    const socket = await rawSocket();
    const closed = new Promise((resolve) => (socket.onclose = resolve));
    socket.send(wrong);
    assert.equal((await closed).code, 1008);
  }
});
