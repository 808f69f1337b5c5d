// The types of softfinger-client and docs/protocol.md name the same fields.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { bits, keys, layout, rows } from "./protocol_page.mjs";
import { root } from "./touch_scene.mjs";

const types = readFileSync(`${root}/clients/javascript/src/messages.d.ts`, "utf8").replace(/\/\/.*$|\/\*\*[^]*?\*\//gm, "");

/** What stands between a declaration and the end of its braces, or of its statement. */
function declaration(start) {
  const [, text] = new RegExp(`export ${start}\\b[^{=]*[{=]\\n?([^]*?)(?=^}|;\\n(?=\\n|export|$)|$(?![^]))`, "m").exec(types) ?? [];
  assert.ok(text, start);
  return text;
}
/** The names of members, those within others left out. */
function membersOf(name) {
  let text = declaration(`interface ${name}`);
  for (let before = ""; before !== text; ) [before, text] = [text, text.replace(/\{[^{}]*\}/g, "")];
  return [...text.matchAll(/^ *(\w+)\??:/gm)].map(([, member]) => member);
}
const sorted = (list) => [...list].sort();

for (const name of ["Scene", "FingerDescription", "Workspace", "FollowedFinger", "Notice", "Objective", "DeviceState", "LatencyStage",
  "Loading", "Registration", "Fit", "Notifications", "Events"]) {
  test(`${name} has the keys of its section`, () => {
    const members = membersOf(name);
    assert.ok(members.length > 1);
    assert.deepEqual(sorted(keys(name)), sorted(members));
  });
}

test("members of members stand in the row of their list", () => {
  const inner = { Scene: ["objects"], FingerDescription: ["pieces"], Workspace: ["reaches", "tilt_layers"] };
  assert.deepEqual([...declaration("interface Events").matchAll(/^ {4}(\w+):/gm)].map(([, key]) => key), keys("Event"));
  for (const [name, lists] of Object.entries(inner)) {
    for (const list of lists) {
      const [, fields] = new RegExp(`^ *${list}: \\{([^}]*)\\}`, "m").exec(declaration(`interface ${name}`));
      const meaning = rows(name).find(([key]) => key === `\`${list}\``)[2];
      const found = [...fields.matchAll(/(\w+):/g)].map(([, field]) => field);
      assert.ok(found.length > 1);
      for (const field of found) assert.ok(meaning.includes(`\`${field}\``), `${name}.${list}: ${field}`);
    }
  }
});

test("Shape has the keys of every kind, and the kinds", () => {
  const text = declaration("type RigidShape") + declaration("type Shape");
  assert.deepEqual(sorted(keys("Shape")), sorted(new Set([...text.matchAll(/(\w+):/g)].map(([, key]) => key))));
  const kinds = [...text.matchAll(/kind: "(\w+)"/g)].map(([, kind]) => kind);
  assert.ok(kinds.length > 3);
  for (const kind of kinds) assert.ok(rows("Shape")[0][1].includes(`"${kind}"`), kind);
});

/** Fields of a table of bytes that a reader is given as members of their own. */
const membersByBytes = (section, but) => [
  ...layout(section).filter(({ name, type }) => type !== "pad" && !but.includes(name)).map(({ name }) => name),
  ...layout(section).filter(({ name }) => name.endsWith("flags")).flatMap(({ name }) => Object.keys(bits(section, name))),
];

test("Snapshot, FingerSnapshot and Twin have the fields of their bytes", () => {
  const skin = membersOf("Skin");
  const sums = membersOf("ContactSums");
  assert.deepEqual(sorted(membersOf("Snapshot")), sorted([...membersByBytes("Snapshot", ["magic", "flags", "objects"])]));
  const counts = ["samples", "axes", "joints", "points", "solids", "twin_samples", "known_axes", "device_flags"];
  assert.deepEqual(sorted([...membersOf("FingerSnapshot"), ...skin, ...sums]),
    sorted([...membersByBytes("FingerSnapshot", counts), "objective", "twin"]));
  assert.deepEqual(sorted([...membersOf("Twin"), ...skin]), sorted(membersByBytes("Twin", [])));
  assert.deepEqual(sorted(membersOf("SoftObjectSnapshot")), sorted(membersByBytes("SoftObject", ["points"])));
});

test("Request has the requests and keys of the page", () => {
  const requests = [...declaration("type Request").matchAll(/\{ request: "(\w+)"([^}]*)\}/g)]
    .map(([, request, more]) => [request, sorted([...more.matchAll(/(\w+)\??:/g)].map(([, key]) => key))]);
  const told = rows("Request").map(([request, more]) =>
    [request.replaceAll("`", ""), sorted([...more.matchAll(/`(\w+)`/g)].map(([, key]) => key))]);
  assert.ok(told.length > 8);
  assert.deepEqual(sorted(told.map(String)), sorted(requests.map(String)));
});
