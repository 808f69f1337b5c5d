// What the client does where a connection is refused, lost or answered by another softfinger.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { after, before, beforeEach, test } from "node:test";
import { connect, kProtocolVersion, open, WebSocketServer } from "./client_under_test.mjs";

const kScene = {
  type: "scene", protocol_version: kProtocolVersion, generation: 3, scene: "plane", scenes: ["plane", "edge"],
  objects: [], fingers: [{ name: "index", objectives: [1] }, { name: "ring", objectives: [] }],
  objectives: [{ name: "pressure" }, { name: "surface" }], latency_stages: [],
};

const kLimit = { timeout: 30_000 };

let server, sockets, port, address;
let scene = kScene; // what the server begins with
let received = [];
const clients = [];

/** As the program lets visitors in, with token "sesame" where one is wanted. */
let cookie = null;
const kToken = "sesame-sesame-sesame";

function answer(request, response) {
  const right = request.url === `/?token=${kToken}`;
  response.writeHead(right ? 303 : 401, right ? { "Set-Cookie": `${cookie}; Path=/; HttpOnly`, Location: "/" } : {}).end();
}

async function serve(at = 0) {
  server = createServer(answer);
  sockets = new WebSocketServer({ server, path: "/ws", verifyClient: ({ req }) => !cookie || req.headers.cookie === cookie });
  sockets.on("connection", (socket) => {
    socket.on("message", (data, binary) => received.push(binary ? data : JSON.parse(data)));
    socket.send(JSON.stringify(scene));
  });
  await new Promise((done) => server.listen(at, "127.0.0.1", done));
  ({ port } = server.address());
  address = `http://127.0.0.1:${port}`;
}

async function end() {
  for (const socket of sockets.clients) socket.terminate();
  await new Promise((done) => server.close(done));
}

/** The server's end of the last that came. */
const newest = () => [...sockets.clients].at(-1);
const kept = (client) => (clients.push(client), client);
const line = (what) => new RegExp(`^softfinger at ${address}: .*${what}[^\\n]*$`);
async function came(count) {
  while (received.length < count) await new Promise((done) => setTimeout(done, 5));
  return received;
}

before(() => serve());
beforeEach(() => {
  [scene, cookie, received] = [kScene, null, []];
  for (const client of clients.splice(0)) client.close();
});
after(async () => {
  for (const client of clients) client.close();
  await end();
});

test("the newest is told to who comes later, and off ends it", kLimit, async () => {
  const client = kept(await connect(address));
  const seen = [];
  const off = client.on("scene", ({ generation }) => seen.push(generation));
  assert.deepEqual(seen, [3]);
  const push = () => newest().send(JSON.stringify({ ...kScene, generation: 4 }));
  push();
  await client.next("scene");
  assert.deepEqual(seen, [3, 4]);
  off();
  push();
  await client.next("scene");
  assert.deepEqual(seen, [3, 4]);
  assert.throws(() => client.on("frame", () => {}), /^Error: softfinger: nothing is called 'frame' here; there is scene, [^\n]*$/);
});

test("another version of the protocol is refused for good, in one line", kLimit, async () => {
  for (const version of [kProtocolVersion + 1, undefined]) {
    scene = { ...kScene, protocol_version: version };
    await assert.rejects(connect(address), { message: line(`version ${version ?? 0} of the protocol, this client version ${kProtocolVersion};`) });
  }
  const client = kept(open(address));
  const [state, why] = await new Promise((done) => client.on("state", (...told) => told[0] === "closed" && done(told)));
  assert.match(why, line("take the softfinger-client of that softfinger"));
  assert.equal(state, "closed");
  assert.equal(client.scene, null);
});

test("messages of a kind that is not known yet are left", kLimit, async () => {
  const client = kept(await connect(address));
  const socket = newest();
  socket.send(JSON.stringify({ type: "weather" }));
  socket.send(new Uint8Array(60));
  socket.send(JSON.stringify({ type: "loading", scene: "edge", more: 1 }));
  assert.equal((await client.next("loading")).scene, "edge");
  assert.equal(client.snapshot, null);
});

test("a token is changed for a cookie; without or with another one line says so", kLimit, async () => {
  cookie = `softfinger-${port}=0123456789abcdef`;
  for (const [at, options] of [[`${address}/?token=${kToken}`], [address, { token: kToken }], [`ws://127.0.0.1:${port}/ws`, { token: kToken }]]) {
    assert.equal((await connect(at, options).then(kept)).address, address);
  }
  await assert.rejects(connect(address), { message: line("asks for its token") });
  await assert.rejects(connect(address, { token: "another-another-another" }), { message: line("has another token") });
});

test("nobody there, and addresses that are none: one line", kLimit, async () => {
  await assert.rejects(connect("http://127.0.0.1:1"), { message: /^softfinger at http:\/\/127.0.0.1:1: nobody is there[^\n]*$/ });
  for (const wrong of ["", "ftp://127.0.0.1", "http://"]) {
    await assert.rejects(connect(wrong), { message: /^softfinger: '.*' is no address[^\n]*$/ });
  }
});

test("what the program would refuse is refused, and not sent", kLimit, async () => {
  const client = kept(await connect(address));
  const refused = (ask, why) => assert.throws(ask, { message: new RegExp(`^softfinger: ${why}[^\\n]*$`) });
  refused(() => client.pose("thumb", [0, 0, 0]), "no finger 'thumb' here; there is index, ring");
  refused(() => client.pose(2, [0, 0, 0]), "no finger '2' here");
  refused(() => client.pose(0, [0, 0, 1001]), "expected a position");
  refused(() => client.pose(0, [0, NaN, 0]), "expected a position");
  refused(() => client.pose(0, [0, 0]), "expected a position");
  refused(() => client.pose(0, [0, 0, 0], [0, 0, 0, 1.1]), "expected a quaternion");
  refused(() => client.hold("table", [0, 0, 0]), "no object that can be held 'table' here; there is none");
  refused(() => client.letGo("table"), "no object that can be held 'table' here");
  refused(() => client.chooseScene("moon"), "no scene 'moon' here; there is plane, edge");
  refused(() => client.chooseObjective("index", "pressure"), "no objective 'pressure' here; there is surface");
  refused(() => client.hand("left", [1, 2, 3]), "expected 8 numbers");
  assert.ok(client.chooseObjective("index", "surface") && client.pose("ring", [1, 2, 3]) && client.register(1, { breadth_mm: 16 }));
  assert.deepEqual(await came(3), [
    { request: "objective", finger: 0, objective: "surface" },
    { request: "pose", finger: 1, position_mm: [1, 2, 3], quaternion: [1, 0, 0, 0] },
    { request: "register", finger: 1, breadth_mm: 16 },
  ]);
});

test("a program that is gone is lost; a stop asked for meanwhile is the first thing it hears when it is back", kLimit, async () => {
  const client = kept(await connect(address));
  const waiting = client.next("snapshot");
  const states = [];
  client.on("state", (state, why) => states.push([state, why]));
  const lost = new Promise((done) => client.on("state", (state) => state === "lost" && done()));
  await Promise.all([end(), lost, assert.rejects(waiting, { message: line("has ended") })]);
  assert.ok(!client.pause() && !client.stop());
  assert.equal(client.scene.scene, "plane");
  await serve(port);
  scene = { ...kScene, generation: 1 };
  assert.equal((await client.next("scene").catch(() => client.next("scene"))).generation, 1);
  assert.deepEqual(await came(1), [{ request: "stop" }]);
  assert.deepEqual(states.map(([state]) => state), ["live", "lost", "live"]);
  client.close();
  assert.deepEqual(states.at(-1), ["closed", ""]);
});
