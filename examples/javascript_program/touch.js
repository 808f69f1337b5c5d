// A finger goes down onto what lies under it, over the socket of a running softfinger; what it feels, ten times a second.
//
//     softfinger run ../../scenes/plane.toml --tracker page
//     npm install && node touch.js http://127.0.0.1:8080
//
// Here the pose is made up: put your tracker's in its place.
import { connect } from "softfinger-client";

const kInterval = 25; // ms between poses
const kHeight = 20; // mm above the plane, where it begins
const kSpeed = 6; // mm/s
const kDepth = 5.5; // mm above the plane: its skin, 7.5 mm below its middle, is pressed flat

const wait = (ms) => new Promise((done) => setTimeout(done, ms));

async function touch(client) {
  const finger = client.scene.fingers.find(({ moved_here }) => moved_here);
  if (!finger) throw new Error(`${client.scene.scene} has no finger that this may move; run it with --tracker page`);
  const begin = performance.now();
  let most = 0;
  let told = -Infinity;
  client.on("snapshot", ({ time_s, fingers }) => {
    const { normal_force_N, contact_area_mm2, device_state } = fingers[client.scene.fingers.indexOf(finger)];
    most = Math.max(most, normal_force_N);
    if (time_s < told + 0.1) return;
    told = time_s;
    console.log(`${time_s.toFixed(1)} s  ${normal_force_N.toFixed(3)} N  ${contact_area_mm2.toFixed(1)} mm2  ${device_state}`);
  });
  for (let height = kHeight; height > kDepth; ) {
    height = Math.max(kDepth, kHeight - (kSpeed * (performance.now() - begin)) / 1000);
    client.pose(finger.name, [0, 0, height]);
    await wait(kInterval);
  }
  return most;
}

try {
  const client = await connect(process.argv[2] ?? "http://127.0.0.1:8080");
  client.on("state", (state, why) => state === "lost" && (console.error(why), process.exit(1)));
  const most = await touch(client);
  client.close();
  process.exitCode = most > 0 ? 0 : 1;
} catch (error) {
  console.error(error.message);
  process.exitCode = 1;
}
