// The WebSocket to the program: what comes over it, who listens, and that it comes back.
import { kProtocolVersion, readSnapshot } from "./wire.js";

/** @typedef {import("./index.js").Listened} Listened */
/** @typedef {import("./index.js").Scene} Scene */
/** @typedef {import("./index.js").Snapshot} Snapshot */

const kAgain = 1000; // ms, until a program that was lost is looked for
const kMostWaiting = 2048; // bytes
const kOpen = 1; // WebSocket.OPEN
const kRefused = 1008; // of RFC 6455: a policy that what was sent violates

const kKinds = ["scene", "snapshot", "registration", "fit", "notifications", "loading", "events", "state"];

export class Connection {
  /** @type {string} */
  address;
  /** @type {Scene | null} */
  scene = null;
  /** @type {Snapshot | null} */
  snapshot = null;
  /** @type {Listened["state"]} */
  state = "connecting";

  #openSocket;
  /** @type {WebSocket | null} */
  #socket = null;
  /** @type {Scene | null} */
  #current = null; // of this socket
  #stopWanted = false; // and not known to have come
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #again;
  /** @type {Map<string, Set<Function>>} */
  #listeners = new Map(kKinds.map((kind) => [kind, new Set()]));
  /** @type {Map<string, any[]>} */
  #newest = new Map([["state", ["connecting", ""]]]); // of what stays true until the next

  /** @param {string} origin @param {() => WebSocket | Promise<WebSocket>} openSocket */
  constructor(origin, openSocket) {
    this.address = origin;
    this.#openSocket = openSocket;
    void this.#begin();
  }

  /** @param {any} kind @param {any} listener */
  on(kind, listener) {
    const listeners = this.#listenersOf(kind);
    listeners.add(listener);
    const newest = this.#newest.get(kind);
    if (newest) listener(...newest);
    return () => void listeners.delete(listener);
  }

  /** @type {import("./index.js").Client["next"]} */
  next(kind) {
    const listeners = this.#listenersOf(kind);
    const states = this.#listenersOf("state");
    return new Promise((resolve, reject) => {
      const end = () => {
        listeners.delete(arrive);
        states.delete(change);
      };
      const arrive = (/** @type {any} */ message) => {
        end();
        resolve(message);
      };
      const change = (/** @type {string} */ state, /** @type {string} */ why) => {
        if (state !== "lost" && state !== "closed") return;
        end();
        reject(new Error(why || this.#line("closed")));
      };
      if (kind !== "state") states.add(change);
      listeners.add(arrive);
    });
  }

  /** @param {import("./index.js").Request} request */
  send(request) {
    return this.#write(JSON.stringify(request));
  }

  stop() {
    this.#stopWanted = true;
    return this.send({ request: "stop" });
  }

  close() {
    this.#end("");
  }

  /**
   * What only counts while it is new: dropped while what is older waits to be sent.
   * @param {ArrayBuffer} message
   */
  sendNewest(message) {
    return (this.#socket?.bufferedAmount ?? 0) < kMostWaiting && this.#write(message);
  }

  /** @param {string | ArrayBuffer} message */
  #write(message) {
    if (this.#socket?.readyState !== kOpen) return false;
    this.#socket.send(message);
    return true;
  }

  async #begin() {
    try {
      this.#attend(await this.#openSocket());
    } catch (error) {
      this.#lose(whatIsWrong(error));
    }
  }

  /** @param {WebSocket} socket */
  #attend(socket) {
    let why = "";
    let opened = false;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      opened = true;
      if (this.#stopWanted) this.send({ request: "stop" });
      this.#become("live", "");
    };
    socket.onmessage = ({ data }) => this.#receive(data);
    // Browsers do not say what is wrong.
    socket.onerror = (event) => (why = whatIsWrong(/** @type {ErrorEvent} */ (event).error));
    socket.onclose = ({ code, reason }) => {
      if (code === kRefused) why = `refused what was sent: ${reason}`;
      this.#lose(why || (opened ? "has ended, or cannot be reached any more" : "cannot be reached; does softfinger run there?"));
    };
    this.#socket = socket;
    if (this.state === "closed") socket.close();
  }

  /** @param {string | ArrayBuffer} data */
  #receive(data) {
    if (this.state === "closed") return;
    if (typeof data !== "string") return this.#receiveSnapshot(data);
    const message = JSON.parse(data);
    if (message.type === "scene") return this.#receiveScene(message);
    // What is new to this client is for others.
    if (message.type === "events" && message.generation !== this.#current?.generation) return;
    if (["registration", "fit", "notifications", "loading", "events"].includes(message.type)) this.#tell(message.type, message);
  }

  /** @param {Scene} scene */
  #receiveScene(scene) {
    if (scene.protocol_version !== kProtocolVersion) {
      return this.#end(this.#line(`speaks version ${scene.protocol_version ?? 0} of the protocol, this client ` +
        `version ${kProtocolVersion}; take the softfinger-client of that softfinger`));
    }
    this.#current = this.scene = scene;
    this.snapshot = null;
    this.#newest.delete("snapshot");
    this.#tell("scene", scene);
  }

  /** @param {ArrayBuffer} frame */
  #receiveSnapshot(frame) {
    const snapshot = this.#current && readSnapshot(frame, this.#current);
    if (!snapshot || snapshot.generation !== this.#current?.generation) return;
    if (snapshot.stopped) this.#stopWanted = false;
    this.snapshot = snapshot;
    this.#tell("snapshot", snapshot);
  }

  /** @param {string} why */
  #lose(why) {
    if (this.state === "closed") return;
    this.#current = this.#socket = null;
    this.#newest.delete("loading");
    this.#become("lost", this.#line(why));
    this.#again = setTimeout(() => void this.#begin(), kAgain);
  }

  /** For good. @param {string} why */
  #end(why) {
    if (this.state === "closed") return;
    clearTimeout(this.#again);
    this.#socket?.close();
    this.#become("closed", why);
  }

  /** @param {Listened["state"]} state @param {string} why */
  #become(state, why) {
    this.state = state;
    this.#tell("state", state, why);
  }

  /** @param {string} kind @param {...any} what */
  #tell(kind, ...what) {
    if (kind !== "notifications" && kind !== "events") this.#newest.set(kind, what);
    for (const listener of [...this.#listenersOf(kind)]) listener(...what);
  }

  /** @param {string} kind */
  #listenersOf(kind) {
    const listeners = this.#listeners.get(kind);
    if (!listeners) throw new Error(`softfinger: nothing is called '${kind}' here; there is ${kKinds.join(", ")}`);
    return listeners;
  }

  /** @param {string} what */
  #line(what) {
    return `softfinger at ${this.address}: ${what}`;
  }
}

/** In words, of what Node.js or `ws` complain about. @param {any} error */
function whatIsWrong(error) {
  const text = String(error?.message ?? "");
  if (text.includes("response: 401")) return "asks for its token; take the address that the program prints";
  if (text.includes("response: 403")) return "takes visitors at the address that it prints alone";
  if (error?.code === "ECONNREFUSED") return "nobody is there; does softfinger run at that port?";
  if (error?.code === "ECONNRESET") return "ended the connection before it was open; where it has a certificate, take its address with https";
  if (/CERT|SIGNED|ISSUER/.test(error?.code ?? "")) return `its certificate is not trusted (${error.code}); give who signed it as ca`;
  return error?.code ?? text;
}

/**
 * The client once it has a scene; closes it and throws where it cannot.
 * @template {Connection} T
 * @param {T} client
 * @returns {Promise<T>}
 */
export async function arrived(client) {
  try {
    await client.next("scene");
    return client;
  } catch (error) {
    client.close();
    throw error;
  }
}
