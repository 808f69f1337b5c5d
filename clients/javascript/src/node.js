// softfinger-client in Node.js, whose version 18 has no WebSocket, and whose later ones send no cookies.
import http from "node:http";
import https from "node:https";
import WebSocket from "ws";
import { readAddress, socketAddress } from "./address.js";
import { Client } from "./client.js";
import { arrived } from "./connection.js";

export { kContactSums, kHandJoints, kProtocolVersion, readSnapshot } from "./wire.js";
export { Client };

const kPatience = 10_000; // ms

/** The cookie that the program gives to who has its token; it is another one when the program begins anew. */
function cookieFor(origin, token, ca) {
  const { get } = origin.startsWith("https:") ? https : http;
  return new Promise((resolve, reject) => {
    const asked = get(`${origin}/?token=${encodeURIComponent(token)}`, { ca, agent: false, timeout: kPatience }, (answer) => {
      answer.resume();
      const [cookie] = answer.headers["set-cookie"] ?? [];
      if (answer.statusCode === 401) reject(new Error("has another token; take the address that the program prints"));
      else resolve(cookie?.split(";")[0]);
    });
    asked.on("error", reject);
    asked.on("timeout", () => asked.destroy(new Error("does not answer")));
  });
}

async function openSocket(origin, token, ca) {
  const cookie = token ? await cookieFor(origin, token, ca) : undefined;
  return new WebSocket(socketAddress(origin), {
    ca, headers: cookie ? { Cookie: cookie } : {}, handshakeTimeout: kPatience, perMessageDeflate: false,
  });
}

function begin(address, { token, ca } = {}) {
  const named = readAddress(address);
  return new Client(named.origin, () => openSocket(named.origin, token ?? named.token, ca));
}

/** @type {typeof import("./index.js").open} */
export const open = (address, options) => begin(address, options);
/** @type {typeof import("./index.js").connect} */
export const connect = async (address, options) => /** @type {any} */ (await arrived(begin(address, options)));
