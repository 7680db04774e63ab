// One connection to a broker: a WebSocket that carries MQTT 5.
import { BadPacket, connect, disconnect, PacketReader, pingreq, puback, publish, subscribe, unsubscribe } from "./packets";
import type { Login, Packet, Publication } from "./packets";

/** Why a connection has ended: words of the socket, or a reason code of the broker. */
export type Ending = { is: "lost" | "silent" | "no_mqtt" } | { is: "refused" | "ended_by_broker"; reason: number };

export interface BrokerEvents {
  onOpen(): void;
  onMessage(topic: string, payload: Uint8Array, retained: boolean): void;
  /** To a publication with QoS 1. */
  onAcknowledged(packet: number, reason: number): void;
  onEnd(why: Ending): void;
}

const pingEveryMs = 5000;
/** After a ping, or after the socket was asked for: so long nothing may come. */
const silenceMs = 10_000;
const keepAliveS = 120;
const mostPacketNumber = 0xffff;
const firstFailure = 0x80;

export class BrokerLink {
  #socket: WebSocket;
  #events: BrokerEvents;
  #reader = new PacketReader();
  #isOpen = false;
  #isOver = false;
  #lastPacket = 0;
  #heard = performance.now();
  #timer: ReturnType<typeof setInterval>;

  /** Throws where the browser refuses the address. */
  constructor(address: string, login: Omit<Login, "keepAliveS">, events: BrokerEvents) {
    this.#events = events;
    this.#socket = new WebSocket(address, ["mqtt"]);
    this.#socket.binaryType = "arraybuffer";
    this.#socket.onopen = () => this.#send(connect({ ...login, keepAliveS }));
    this.#socket.onmessage = ({ data }) => this.#read(data);
    this.#socket.onclose = () => this.#end({ is: "lost" });
    this.#timer = setInterval(() => this.#look(), pingEveryMs);
  }

  get isOpen(): boolean {
    return this.#isOpen;
  }

  /** The number of its packet, by which it is acknowledged; 0 with QoS 0, or without a connection. */
  publish(publication: Publication): number {
    if (!this.#isOpen) return 0;
    const packet = publication.qos === 1 ? this.#nextPacket() : 0;
    this.#send(publish({ ...publication, packet }));
    return packet;
  }
  subscribe(topics: string[]): void {
    if (this.#isOpen && topics.length > 0) this.#send(subscribe(this.#nextPacket(), topics));
  }
  unsubscribe(topics: string[]): void {
    if (this.#isOpen && topics.length > 0) this.#send(unsubscribe(this.#nextPacket(), topics));
  }
  /** Without a word to the events. */
  end(): void {
    if (this.#isOpen) this.#send(disconnect());
    this.#isOver = true;
    this.#close();
  }

  #nextPacket(): number {
    this.#lastPacket = (this.#lastPacket % mostPacketNumber) + 1;
    return this.#lastPacket;
  }
  #send(bytes: Uint8Array<ArrayBuffer>): void {
    if (this.#socket.readyState === WebSocket.OPEN) this.#socket.send(bytes);
  }

  #read(data: unknown): void {
    if (this.#isOver) return;
    this.#heard = performance.now();
    if (!(data instanceof ArrayBuffer)) return this.#end({ is: "no_mqtt" });
    try {
      for (const packet of this.#reader.read(new Uint8Array(data))) this.#take(packet);
    } catch (error) {
      if (!(error instanceof BadPacket)) throw error;
      this.#end({ is: "no_mqtt" });
    }
  }

  #take(packet: Packet): void {
    if (packet.is === "connack") this.#begin(packet.reason);
    else if (!this.#isOpen) this.#end({ is: "no_mqtt" });
    else if (packet.is === "publish") this.#deliver(packet);
    else if (packet.is === "puback") this.#events.onAcknowledged(packet.packet, packet.reason);
    else if (packet.is === "disconnect") this.#end({ is: "ended_by_broker", reason: packet.reason });
  }

  #begin(reason: number): void {
    if (reason >= firstFailure) return this.#end({ is: "refused", reason });
    this.#isOpen = true;
    this.#events.onOpen();
  }

  #deliver(packet: Packet & { is: "publish" }): void {
    if (packet.qos === 1) this.#send(puback(packet.packet));
    this.#events.onMessage(packet.topic, packet.payload, packet.retained);
  }

  #look(): void {
    if (performance.now() - this.#heard > pingEveryMs + silenceMs) this.#end({ is: "silent" });
    else if (this.#isOpen) this.#send(pingreq());
  }

  #end(why: Ending): void {
    if (this.#isOver) return;
    this.#isOver = true;
    this.#close();
    this.#events.onEnd(why);
  }
  #close(): void {
    clearInterval(this.#timer);
    this.#isOpen = false;
    this.#socket.close();
  }
}
