// A scene with all that the protocol tells of: each shape, and fingers moved by page, headset and network.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

export const root = fileURLToPath(new URL("../..", import.meta.url)).replace(/\/$/, "");
export const program = process.env.SOFTFINGER_PROGRAM ?? `${root}/build/softfinger`;

const finger = (name, tracker, x, device) => `
[[finger]]
name = "${name}"
model = "${root}/fingers/index.toml"
${device ? `device = "${device}"` : ""}
tracker = "${tracker}"
[[finger.waypoint]]
time_s = 0.0
position_mm = [${x}, 0.0, 20.0]
`;

const kFoam = "material = { youngs_modulus_kPa = 1.0, poissons_ratio = 0.3, density_kg_per_m3 = 200.0 }";

const object = (name, shape, sizes, x, z = 0) => `
[[object]]
name = "${name}"
shape = "${shape}"
${sizes}
position_mm = [${x}, 0.0, ${z}.0]
`;

/** A device that a person is told of: it cannot come as near as its file wants it to. */
const farDevice = () => readFileSync(`${root}/devices/disk-linear.toml`, "utf8").replace(/^approach_mm = .*$/m, "approach_mm = 9.0");

/** A device that can learn who wears it. */
const sensingDevice = () => readFileSync(`${root}/devices/thimble-3rrs.toml`, "utf8") + '\n[force_sensor]\nkind = "emulator"\n';

const touch = (folder, port) => [
  finger("index", "page", 0, `${folder}/sensing.toml`),
  finger("middle", "webxr:left-middle", 100),
  finger("ring", `udp:${port}`, 200, `${folder}/far.toml`),
  object("table", "plane", "", 0),
  object("ball", "sphere", "radius_mm = 5.0", 400),
  object("block", "box", "size_mm = [4.0, 5.0, 6.0]\nedge_radius_mm = 0.5", 500),
  object("rod", "cylinder", "radius_mm = 3.0\nlength_mm = 20.0\nedge_radius_mm = 0.2", 600),
  object("needle", "mesh", `file = "${root}/objects/needle.stl"\nunit = "mm"`, 700),
  object("marble", "sphere", "radius_mm = 5.0\nmotion = \"dynamic\"\nmass_g = 5.0", 900, 30),
  // It rests on the plane, and sinks into itself by its weight.
  object("sponge", "soft", `file = "${root}/objects/sponge.msh"\nunit = "mm"\n${kFoam}`, 800, 10),
].join("");

/** In `folder`: touch.toml, which it returns, again.toml, quick to load, and broken.toml. */
export function writeScenes(folder, port) {
  writeFileSync(join(folder, "far.toml"), farDevice());
  writeFileSync(join(folder, "sensing.toml"), sensingDevice());
  mkdirSync(join(folder, "scenes"));
  const write = (name, text) => writeFileSync(join(folder, "scenes", `${name}.toml`), text);
  write("touch", touch(folder, port));
  write("again", finger("index", "page", 0) + object("table", "plane", "", 0));
  write("broken", "[[finger]]\nname = 7\n");
  return join(folder, "scenes", "touch.toml");
}
