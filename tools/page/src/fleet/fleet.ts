// The gateways on a broker and their axes, from what they say there. Does no I/O.
import { readBirth, readState, readTelemetry } from "./messages";
import type { AxisState, Birth } from "./messages";
import { isLevel } from "./topics";
import type { Topic } from "./topics";

export interface Gateway {
  name: string;
  /** Null: its birth has not come, or was taken off the broker. */
  birth: Birth | null;
  /** Of axes that its birth need not name. */
  states: Map<string, AxisState>;
  /** Of its earlier connections, the newest last. */
  formerEpochs: string[];
}

export type Presence = "online" | "away" | "without_tmcld";

export interface Counts {
  online: number;
  away: number;
  withoutTmcld: number;
  axes: number;
  moving: number;
  withFaults: number;
}

const mostGateways = 10_000;
const mostStates = 512; // of a gateway
const mostFormerEpochs = 4;

export function presenceOf({ birth }: Gateway): Presence {
  if (!birth?.isOnline) return "away";
  return birth.tmcld === "" ? "without_tmcld" : "online";
}

export const isOnline = (gateway: Gateway) => gateway.birth?.isOnline === true;

/** Of the axes that it has now. */
export function hasFault(state: AxisState | undefined): boolean {
  return state !== undefined && (state.faults.length > 0 || state.latched);
}

const order = new Intl.Collator("en", { numeric: true });

export class Fleet {
  #gateways = new Map<string, Gateway>();
  /** Messages that no gateway would send. */
  misread = 0;
  /** Changes with what gateways there are, and which axes they have. */
  generation = 0;

  gateway(name: string): Gateway | undefined {
    return this.#gateways.get(name);
  }
  /** In no order, those of which there was no birth, too. */
  all(): Iterable<Gateway> {
    return this.#gateways.values();
  }
  /** Those of which there was a birth, by name. */
  gateways(): Gateway[] {
    return [...this.#gateways.values()].filter(({ birth }) => birth !== null).sort((one, other) => order.compare(one.name, other.name));
  }

  take(topic: Topic, payload: Uint8Array): void {
    const gateway = topic.is === "reply" ? null : this.#gatewayOf(topic.gateway);
    const isTaken = gateway !== null && this.#takeOf(gateway, topic, payload);
    if (!isTaken) ++this.misread;
  }

  /** The broker tells everything that it keeps anew: what it does not tell is not there any more. */
  forget(): void {
    this.#gateways.clear();
    ++this.generation;
  }

  counts(): Counts {
    const counts: Counts = { online: 0, away: 0, withoutTmcld: 0, axes: 0, moving: 0, withFaults: 0 };
    for (const gateway of this.#gateways.values()) if (gateway.birth) count(gateway, counts);
    return counts;
  }

  /** Of which something was heard, and not the rest: a broker drops messages for a client that it waits for. */
  incomplete(): { births: string[]; states: string[] } {
    const all = [...this.#gateways.values()];
    const lacksState = ({ birth, states }: Gateway) => birth !== null && birth.tmcld !== "" && birth.axes.some((axis) => !states.has(axis));
    return {
      births: all.filter(({ birth }) => birth === null).map(({ name }) => name),
      states: all.filter(lacksState).map(({ name }) => name),
    };
  }

  #gatewayOf(name: string): Gateway | null {
    const known = this.#gateways.get(name);
    if (known) return known;
    if (this.#gateways.size >= mostGateways) return null;
    const gateway: Gateway = { name, birth: null, states: new Map(), formerEpochs: [] };
    this.#gateways.set(name, gateway);
    return gateway;
  }

  #takeOf(gateway: Gateway, topic: Topic, payload: Uint8Array): boolean {
    if (topic.is === "birth") return this.#takeBirth(gateway, payload);
    if (topic.is === "state") return takeState(gateway, topic.axis, payload);
    return topic.is === "telemetry" && takeTelemetry(gateway, topic.axis, payload);
  }

  #takeBirth(gateway: Gateway, payload: Uint8Array): boolean {
    if (payload.length === 0) this.#remove(gateway);
    const birth = payload.length === 0 ? null : readBirth(payload, isLevel);
    if (!birth) return payload.length === 0;
    // The will of a connection that another one has followed. The gateway says its birth again.
    if (!birth.isOnline && gateway.formerEpochs.includes(birth.epoch)) return true;
    if (gateway.birth && gateway.birth.epoch !== birth.epoch) this.#follow(gateway, gateway.birth.epoch, birth.epoch);
    if (!birth.isOnline) gateway.states.clear();
    gateway.birth = birth;
    ++this.generation;
    return true;
  }

  #follow(gateway: Gateway, former: string, now: string): void {
    const others = gateway.formerEpochs.filter((epoch) => epoch !== now && epoch !== former);
    gateway.formerEpochs = [...others, former].slice(-mostFormerEpochs);
  }
  #remove(gateway: Gateway): void {
    this.#gateways.delete(gateway.name);
    ++this.generation;
  }
}

function takeState(gateway: Gateway, axis: string, payload: Uint8Array): boolean {
  if (payload.length === 0) return gateway.states.delete(axis) || true;
  const state = readState(payload, axis);
  if (!state || (!gateway.states.has(axis) && gateway.states.size >= mostStates)) return false;
  gateway.states.set(axis, state);
  return true;
}

/** Of an axis whose state is known. */
function takeTelemetry(gateway: Gateway, axis: string, payload: Uint8Array): boolean {
  const telemetry = readTelemetry(payload);
  const state = gateway.states.get(axis);
  if (telemetry && state) gateway.states.set(axis, { ...state, ...telemetry });
  return telemetry !== null;
}

function count(gateway: Gateway, counts: Counts): void {
  const presence = presenceOf(gateway);
  if (presence === "away") ++counts.away;
  else if (presence === "online") ++counts.online;
  else ++counts.withoutTmcld;
  if (presence !== "online") return;
  for (const axis of gateway.birth!.axes) {
    const state = gateway.states.get(axis);
    ++counts.axes;
    if (state?.moving) ++counts.moving;
    if (hasFault(state)) ++counts.withFaults;
  }
}
