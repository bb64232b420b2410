// The subset of Foxglove's WebSocket protocol that a gyrotwin gateway speaks, from the client's side.

export interface Channel {
  id: number;
  topic: string;
  encoding: string;
  schema: string;
}
export type Value = number | boolean | string | Value[] | {[key: string]: Value} | null;
export interface Parameter {
  name: string;
  value: Value;
}
export interface ServerInfo {
  name: string;
  metadata?: Record<string, string>;
}

export type ServerMessage =
  | ({op: 'serverInfo'} & ServerInfo)
  | {op: 'advertise'; channels: Channel[]}
  | {op: 'status'; level: number; message: string}
  | {op: 'parameterValues'; parameters: Parameter[]; id?: string}
  | {op: string};

export interface Data {
  subscription: number;
  time: bigint;  // of arrival at the gateway, since 1970 [ns]
  bytes: Uint8Array;
}

/** Message data of a subscription; null for anything else that is binary. */
export function parseData(buffer: ArrayBuffer): Data | null {
  const view = new DataView(buffer);
  if (view.byteLength < 13 || view.getUint8(0) !== 1) return null;
  return {subscription: view.getUint32(1, true), time: view.getBigUint64(5, true),
    bytes: new Uint8Array(buffer, 13)};
}

/** A message that the client publishes on a channel of its own. */
export function publication(channel: number, text: string): Uint8Array {
  const body = new TextEncoder().encode(text);
  const bytes = new Uint8Array(5 + body.length);
  bytes[0] = 1;
  new DataView(bytes.buffer).setUint32(1, channel, true);
  bytes.set(body, 5);
  return bytes;
}

const LONGEST_PAUSE = 3000;  // [ms]

export interface Listener {
  opened(): void;
  closed(): void;
  message(message: ServerMessage): void;
  data(data: Data): void;
}

/** A socket that comes back by itself. */
export class Connection {
  private socket: WebSocket | null = null;
  private pause = 500;

  constructor(private readonly url: string, private readonly listener: Listener) {
    this.connect();
  }

  get open(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  send(message: object): void {
    if (this.open) this.socket!.send(JSON.stringify(message));
  }

  publish(channel: number, request: object): boolean {
    if (!this.open) return false;
    this.socket!.send(publication(channel, JSON.stringify(request)));
    return true;
  }

  private connect(): void {
    const socket = new WebSocket(this.url, ['foxglove.sdk.v1', 'foxglove.websocket.v1']);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.pause = 500;
      this.listener.opened();
    };
    socket.onmessage = ({data}) => {
      if (typeof data === 'string') return this.listener.message(JSON.parse(data) as ServerMessage);
      const parsed = parseData(data as ArrayBuffer);
      if (parsed) this.listener.data(parsed);
    };
    socket.onclose = () => {
      this.socket = null;
      this.listener.closed();
      setTimeout(() => this.connect(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE);
    };
    this.socket = socket;
  }
}
