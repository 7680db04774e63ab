// Packets of MQTT 5, as far as a client needs them that looks, and publishes with QoS 0 or 1. Does no I/O.

/** What a client sends. */
export interface Publication {
  topic: string;
  payload: string;
  retained?: boolean;
  qos?: 0 | 1;
  /** Of a QoS above 0. */
  packet?: number;
  expiryS?: number;
  responseTopic?: string;
}

export interface Login {
  client: string;
  user: string;
  /** Empty: none. */
  password: string;
  keepAliveS: number;
}

/** What a broker sends; what a client has no use for is left out. */
export type Packet =
  | { is: "connack"; reason: number }
  | { is: "publish"; topic: string; payload: Uint8Array; qos: number; packet: number; retained: boolean }
  | { is: "puback"; packet: number; reason: number }
  | { is: "disconnect"; reason: number }
  | { is: "other" };

/** The broker is told not to send a longer one; answers of gateways have 1 MB at most. */
export const mostPacketBytes = 1_200_000;

const types = { connect: 1, connack: 2, publish: 3, puback: 4, subscribe: 8, unsubscribe: 10, pingreq: 12, disconnect: 14 };
const properties = { expiry: 0x02, responseTopic: 0x08, mostPacketBytes: 0x27 };
const protocolLevel = 5;
const cleanStart = 0x02;
const hasPassword = 0x40;
const hasUser = 0x80;

const encoder = new TextEncoder();
const decoder = new TextDecoder("utf-8", { fatal: true });

const two = (value: number) => [(value >> 8) & 255, value & 255];
const four = (value: number) => [...two(value >>> 16), ...two(value)];

/** A number of one to four bytes, seven bits in each. */
function length(value: number): number[] {
  const bytes = [];
  do {
    const rest = Math.floor(value / 128);
    bytes.push((value % 128) | (rest > 0 ? 128 : 0));
    value = rest;
  } while (value > 0);
  return bytes;
}

function text(value: string): number[] {
  const bytes = encoder.encode(value);
  return [...two(bytes.length), ...bytes];
}

function packet(type: number, flags: number, body: number[]): Uint8Array<ArrayBuffer> {
  return Uint8Array.from([(type << 4) | flags, ...length(body.length), ...body]);
}

export function connect({ client, user, password, keepAliveS }: Login) {
  const flags = cleanStart | hasUser | (password ? hasPassword : 0);
  const own = [properties.mostPacketBytes, ...four(mostPacketBytes)];
  const ways = [...text("MQTT"), protocolLevel, flags, ...two(keepAliveS), ...length(own.length), ...own];
  return packet(types.connect, 0, [...ways, ...text(client), ...text(user), ...(password ? text(password) : [])]);
}

export function publish({ topic, payload, retained = false, qos = 0, packet: id = 0, expiryS, responseTopic }: Publication) {
  const own: number[] = [];
  if (expiryS !== undefined) own.push(properties.expiry, ...four(expiryS));
  if (responseTopic !== undefined) own.push(properties.responseTopic, ...text(responseTopic));
  const head = [...text(topic), ...(qos > 0 ? two(id) : []), ...length(own.length), ...own];
  return packet(types.publish, (qos << 1) | (retained ? 1 : 0), [...head, ...encoder.encode(payload)]);
}

export function subscribe(id: number, topics: string[]) {
  return packet(types.subscribe, 2, [...two(id), 0, ...topics.flatMap((topic) => [...text(topic), 0])]);
}

export function unsubscribe(id: number, topics: string[]) {
  return packet(types.unsubscribe, 2, [...two(id), 0, ...topics.flatMap(text)]);
}

export const pingreq = () => packet(types.pingreq, 0, []);
export const puback = (id: number) => packet(types.puback, 0, two(id));
export const disconnect = () => packet(types.disconnect, 0, []);

/** What came is no MQTT: nothing after it can be read. */
export class BadPacket extends Error {}

/** Reads one packet's bytes from the front to the end. */
class Body {
  #at = 0;
  constructor(readonly bytes: Uint8Array) {}

  take(count: number): Uint8Array {
    if (this.#at + count > this.bytes.length) throw new BadPacket("a packet ends too early");
    this.#at += count;
    return this.bytes.subarray(this.#at - count, this.#at);
  }
  get isAtEnd(): boolean {
    return this.#at === this.bytes.length;
  }
  one(): number {
    return this.take(1)[0]!;
  }
  two(): number {
    return this.one() * 256 + this.one();
  }
  text(): string {
    try {
      return decoder.decode(this.take(this.two()));
    } catch (error) {
      throw error instanceof BadPacket ? error : new BadPacket("a text is no UTF-8");
    }
  }
  skipProperties(): void {
    const size = lengthAt(this.bytes, this.#at);
    if (!size) throw new BadPacket("a packet ends too early");
    this.#at = size.end;
    this.take(size.value);
  }
  rest(): Uint8Array {
    return this.take(this.bytes.length - this.#at);
  }
}

const longestLength = 4;

/** Null: its last byte has not come yet. */
function lengthAt(bytes: Uint8Array, at: number): { value: number; end: number } | null {
  let value = 0;
  for (let index = 0; index < longestLength; ++index) {
    const byte = bytes[at + index];
    if (byte === undefined) return null;
    value += (byte & 127) * 128 ** index;
    if (byte < 128) return { value, end: at + index + 1 };
  }
  throw new BadPacket("a length has no end");
}

function readPublish(flags: number, body: Body): Packet {
  const topic = body.text();
  const qos = (flags >> 1) & 3;
  const id = qos > 0 ? body.two() : 0;
  body.skipProperties();
  return { is: "publish", topic, payload: body.rest(), qos, packet: id, retained: (flags & 1) === 1 };
}

function readPacket(head: number, body: Body): Packet {
  switch (head >> 4) {
    case types.connack:
      body.one();
      return { is: "connack", reason: body.one() };
    case types.publish:
      return readPublish(head & 15, body);
    case types.puback:
      return { is: "puback", packet: body.two(), reason: body.isAtEnd ? 0 : body.one() };
    case types.disconnect:
      return { is: "disconnect", reason: body.isAtEnd ? 0 : body.one() };
    default:
      return { is: "other" };
  }
}

/** Packets from what comes in: a part of one, or several at once. */
export class PacketReader {
  #unread: Uint8Array = new Uint8Array(0);

  /** The payloads lie in what was read: they are to be used at once. */
  *read(bytes: Uint8Array): Generator<Packet> {
    this.#add(bytes);
    for (;;) {
      const size = this.#unread.length > 1 ? lengthAt(this.#unread, 1) : null;
      if (size && size.value > mostPacketBytes) throw new BadPacket("a packet is longer than was agreed");
      if (!size || this.#unread.length < size.end + size.value) return;
      const head = this.#unread[0]!;
      const body = new Body(this.#unread.subarray(size.end, size.end + size.value));
      this.#unread = this.#unread.subarray(size.end + size.value);
      yield readPacket(head, body);
    }
  }

  #add(bytes: Uint8Array): void {
    if (this.#unread.length === 0) {
      this.#unread = bytes;
      return;
    }
    const both = new Uint8Array(this.#unread.length + bytes.length);
    both.set(this.#unread);
    both.set(bytes, this.#unread.length);
    this.#unread = both;
  }
}
