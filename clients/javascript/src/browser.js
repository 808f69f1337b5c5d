// softfinger-client in browsers, with their own WebSocket. It sends the cookie that the address with the token gave.
import { readAddress, socketAddress } from "./address.js";
import { Client } from "./client.js";
import { arrived } from "./connection.js";

export { kContactSums, kHandJoints, kProtocolVersion, readSnapshot } from "./wire.js";
export { Client };

/** @param {string} address */
function begin(address) {
  const { origin } = readAddress(address);
  return new Client(origin, () => new WebSocket(socketAddress(origin)));
}

/** @type {typeof import("./index.js").open} */
export const open = (address) => begin(address);
/** @type {typeof import("./index.js").connect} */
export const connect = async (address) => /** @type {any} */ (await arrived(begin(address)));
