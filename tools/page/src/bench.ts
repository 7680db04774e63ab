// The axes as tmcld tells of them: the only place that knows, fed by a subscription.
import { effect, signal } from "@preact/signals";
import { access, findOutWho, may } from "./access";
import type { Answer, Params } from "./rpc";
import { CallError, Connection } from "./rpc";
import type { Methods } from "./methods";
import { texts } from "./texts";
import { takeNewPage } from "./version";

export type AxisInfo = Answer<"axis.list">["axes"][number];
export type AxisState = Answer<"subscribe">["states"][number];
export type AxisUnits = Answer<"axis.get_units">;
export type Module = Answer<"module.list">["modules"][number];

export interface Axis {
  info: AxisInfo;
  module: Module | null;
  units: AxisUnits | null;
  state: AxisState | null;
  /** Why there is no state; empty if there is one. */
  problem: string;
  /** Of a move of this page: when it is to end, by performance.now(), and where. */
  arrival: { at: number; target: number } | null;
}

export const axes = signal<Axis[]>([]);
export const isConnected = signal(false);

/** False where it is not known. */
export function everyAxisStands(): boolean {
  return isConnected.peek() && axes.peek().every(({ state, problem }) => state !== null && !state.moving && !problem);
}

/** They are told each state, of whatever subscription of this page. */
export const stateListeners = new Set<(state: StateTold) => void>();

const stateInterval = 50;
const slowestRetryMs = 5000;
const signOfLifeMs = 2500;
const questionsAtOnce = 32;
// Between what changes what is known of a module, and asking for it.
const refreshDelayMs = 200;

const pause = (ms: number) => new Promise<void>((done) => setTimeout(done, ms));

let connection: Connection | null = null;
let retryMs = 500;
let refreshTimer: number | undefined;

/** As one client, which has the leases of this page and what it lets turn. */
export function call<M extends keyof Methods>(method: M, params: Params<M>): Promise<Answer<M>> {
  if (!connection) return Promise.reject(new CallError(texts.notConnected, "not_connected"));
  return connection.call(method, params);
}

function change(name: string, changes: Partial<Axis>): void {
  axes.value = axes.value.map((axis) => (axis.info.name === name ? { ...axis, ...changes } : axis));
}

/** Of a move that tmcld has taken. */
export function expectArrival(name: string, move: { predicted_s: number | null; target_microsteps: number }): void {
  const at = performance.now() + (move.predicted_s ?? 0) * 1000;
  change(name, { arrival: move.predicted_s === null ? null : { at, target: move.target_microsteps } });
}

/** Keeps a connection for as long as the page is let in. */
export function watchAxes(): void {
  effect(() => {
    const isWanted = may("subscribe");
    if (isWanted && !connection) connect();
    if (!isWanted && connection) connection.end();
  });
}

function connect(): void {
  const mine = new Connection();
  connection = mine;
  mine.onOpen = () => {
    retryMs = 500;
    void begin(mine);
  };
  mine.onNotification = (method, params) => take(method, params);
  mine.onClose = () => {
    connection = null;
    isConnected.value = false;
    void connectAgain();
  };
}

async function connectAgain(): Promise<void> {
  await pause(retryMs);
  retryMs = Math.min(retryMs * 2, slowestRetryMs);
  // A browser does not say why a WebSocket was refused.
  await findOutWho();
  if (access.peek().is !== "unknown") await takeNewPage();
  if (may("subscribe") && !connection) connect();
}

async function begin(mine: Connection): Promise<void> {
  try {
    await refresh(mine);
    const { states, failed } = await mine.call("subscribe", { interval_ms: stateInterval });
    for (const state of states) change(state.axis, { state, problem: "" });
    for (const one of failed) change(one.axis, { problem: String(one.error.message ?? "") });
    isConnected.value = true;
    await watchOver(mine);
  } catch {
    mine.end();
  }
}

/** A connection that was cut says nothing. Ends when tmcld does not answer by it in time. */
async function watchOver(mine: Connection): Promise<void> {
  while (mine === connection) {
    await pause(signOfLifeMs);
    const answer = mine.call("bus.list", {});
    await Promise.race([answer, pause(signOfLifeMs).then(() => Promise.reject(new Error()))]);
  }
}

/** What changes seldom. */
async function refresh(mine: Connection): Promise<void> {
  const { axes: infos } = await mine.call("axis.list", {});
  const { modules } = await mine.call("module.list", {});
  const units = await unitsOf(infos, mine);
  axes.value = infos.map((info, index) => {
    const known = axes.peek().find((axis) => axis.info.name === info.name);
    const module = modules.find((one) => one.bus === info.bus && one.address === info.address) ?? null;
    return { state: null, problem: "", arrival: null, ...known, info, module, units: units[index] ?? known?.units ?? null };
  });
}

async function unitsOf(infos: AxisInfo[], mine: Connection): Promise<(AxisUnits | null)[]> {
  const units: (AxisUnits | null)[] = [];
  for (let first = 0; first < infos.length; first += questionsAtOnce) {
    const some = infos.slice(first, first + questionsAtOnce);
    units.push(...(await Promise.all(some.map((info) => mine.call("axis.get_units", { axis: info.name }).catch(() => null)))));
  }
  return units;
}

function refreshSoon(): void {
  clearTimeout(refreshTimer);
  refreshTimer = window.setTimeout(() => {
    if (connection && isConnected.peek()) refresh(connection).catch(() => {});
  }, refreshDelayMs);
}

export type StateTold = AxisState & { subscription: number; dropped: number };
type EventTold = { kind: string; bus: string; address: number | null; dropped: number };

/** Of the axes that an event is about. */
const problemAfter: Record<string, string> = {
  module_silent: texts.moduleSilent,
  link_lost: texts.linkLost,
  module_answers: "",
  link_restored: "",
};

function take(method: string, params: never): void {
  if (method === "notify_state") {
    takeState(params);
    for (const listener of stateListeners) listener(params);
  }
  if (method === "notify_event") takeEvent(params);
}

/** States are whole: of those that were dropped, nothing is missing. An older one is not taken. */
function takeState(state: StateTold): void {
  const axis = axes.peek().find((one) => one.info.name === state.axis);
  if (!axis || (axis.state && axis.state.seq >= state.seq && isConnected.peek())) return;
  const goesElsewhere = state.target_microsteps !== axis.arrival?.target;
  const stands = !state.moving && (state.position_reached || state.stop_cause !== null);
  change(state.axis, { state, problem: "", arrival: goesElsewhere || stands ? null : axis.arrival });
}

function takeEvent(event: EventTold): void {
  if (event.dropped > 0) return connection?.end(); // what was missed is asked for anew
  const problem = problemAfter[event.kind];
  if (problem !== undefined) {
    for (const axis of axes.peek()) {
      const isOfIt = axis.info.bus === event.bus && (event.address === null || axis.info.address === event.address);
      if (isOfIt) change(axis.info.name, { problem });
    }
  }
  refreshSoon();
}
