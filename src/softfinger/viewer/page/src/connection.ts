import { readSnapshot, type Loading, type Notifications, type Registration, type Request, type Scene, type Snapshot } from "./wire";

export interface Listener {
  onScene(scene: Scene): void;
  onSnapshot(snapshot: Snapshot): void;
  onRegistration(registration: Registration): void;
  onNotifications(lines: string[]): void;
  onLoading(scene: string): void;
  onState(state: "connecting" | "live" | "lost"): void;
}

/** The WebSocket to the program; comes back by itself when the program does. */
export class Connection {
  private socket: WebSocket | null = null;
  private scene: Scene | null = null;
  private stopWanted = false; // and not known to have come

  constructor(private readonly listener: Listener) {
    listener.onState("connecting");
    this.open();
  }

  send(request: Request): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(request));
  }

  /** Stops devices: now, or first of all when the program can be reached again. */
  stop(): void {
    this.stopWanted = true;
    this.send({ request: "stop" });
  }

  /** Of the newest kind: dropped while older ones wait to be sent. */
  sendHand(message: ArrayBuffer): void {
    if (this.socket?.readyState === WebSocket.OPEN && this.socket.bufferedAmount < 2048) this.socket.send(message);
  }

  private open(): void {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      if (this.stopWanted) this.send({ request: "stop" });
      this.listener.onState("live");
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => this.receive(event.data);
    socket.onclose = () => {
      this.listener.onState("lost");
      this.scene = null;
      setTimeout(() => this.open(), 1000);
    };
    this.socket = socket;
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data === "string") {
      const message = JSON.parse(data) as Scene | Registration | Notifications | Loading;
      if (message.type === "registration") return this.listener.onRegistration(message);
      if (message.type === "notifications") return this.listener.onNotifications(message.lines);
      if (message.type === "loading") return this.listener.onLoading(message.scene);
      this.scene = message;
      this.listener.onScene(message);
      return;
    }
    const snapshot = this.scene && readSnapshot(data, this.scene);
    if (!snapshot || snapshot.generation !== this.scene?.generation) return;
    if (snapshot.stopped) this.stopWanted = false;
    this.listener.onSnapshot(snapshot);
  }
}
