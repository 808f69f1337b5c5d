// softfinger-client, where it has its packages: in the build folder, or where one works on it.
import { pathToFileURL } from "node:url";
import { root } from "./touch_scene.mjs";

export const clientFolder = process.env.SOFTFINGER_CLIENT ?? `${root}/clients/javascript`;
export const { connect, open, readSnapshot, kHandJoints, kProtocolVersion } =
  await import(pathToFileURL(`${clientFolder}/src/node.js`));
export const { default: WebSocket, WebSocketServer } = await import(pathToFileURL(`${clientFolder}/node_modules/ws/wrapper.mjs`));
