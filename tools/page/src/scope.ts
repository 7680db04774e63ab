// What the scope records: a row whenever a state comes, with the latest value of each trace.
import { effect, signal } from "@preact/signals";
import { axes, call, isConnected, stateListeners, type StateTold } from "./bench";
import { followState, foreseen, forecasts, forgetForecasts, type Forecast } from "./forecast";
import { textOf } from "./rpc";

export interface Trace {
  axis: string;
  /** position, velocity, target, or a parameter of the axis. */
  value: string;
}

export const mostTraces = 8;
export const windows = [5, 20, 60];

export const traces = signal<Trace[]>(tracesIn(location.hash));
export const windowSeconds = signal(20);
export const isPaused = signal(false);
export const scopeProblem = signal("");

type Column = (number | null)[];

/** Called after each row. */
export const newRow = new Set<() => void>();

/** The times, in seconds, then a column for each trace, and how far that is off what was foreseen: of at most so many rows. */
export const rows: { times: number[]; columns: Column[]; differences: Column[] } = { times: [], columns: [], differences: [] };
/** Whether there is a difference to show. */
export const hasForecast = signal(false);
const mostRows = 10_000;
// So many go at once: to move the others costs more than to keep these.
const oldRows = 1000;

const intervalMs = 20;
const valuesOfStates = ["position", "velocity", "target"];

let subscription: number | null = null;
let firstMs: number | null = null;

export const isParameter = (trace: Trace) => !valuesOfStates.includes(trace.value);

/** The address carries the set-up, so that it can be kept and passed on. */
function tracesIn(hash: string): Trace[] {
  const words = hash.startsWith("#scope=") ? hash.slice("#scope=".length).split(",") : [];
  const found = words.map((word) => {
    const [axis, value] = word.split("~").map(decodeURIComponent);
    return { axis: axis ?? "", value: value ?? "" };
  });
  return found.filter((trace) => trace.axis && trace.value).slice(0, mostTraces);
}

function hashOf(all: Trace[]): string {
  return "#scope=" + all.map((trace) => `${encodeURIComponent(trace.axis)}~${encodeURIComponent(trace.value)}`).join(",");
}

export function addTrace(trace: Trace): void {
  const isThere = traces.value.some((one) => one.axis === trace.axis && one.value === trace.value);
  if (!isThere && trace.value && traces.value.length < mostTraces) traces.value = [...traces.value, trace];
}

export function removeTrace(trace: Trace): void {
  traces.value = traces.value.filter((one) => one !== trace);
}

export function startScope(): void {
  effect(() => {
    const wanted = traces.value;
    if (wanted.length > 0 || location.hash) history.replaceState(null, "", hashOf(wanted));
    rows.times = [];
    rows.columns = wanted.map(() => []);
    rows.differences = wanted.map(() => []);
    hasForecast.value = false;
    forgetForecasts();
    firstMs = null;
    if (isConnected.value) void subscribe(wanted);
  });
  stateListeners.add(record);
}

async function subscribe(wanted: Trace[]): Promise<void> {
  scopeProblem.value = "";
  const old = subscription;
  subscription = null;
  try {
    if (old !== null) await call("unsubscribe", { subscription: old }).catch(() => {});
    if (wanted.length === 0) return;
    const parameters = [...new Set(wanted.filter(isParameter).map((trace) => trace.value))];
    const names = [...new Set(wanted.map((trace) => trace.axis))];
    const answer = await call("subscribe", { axes: names, interval_ms: intervalMs, parameters, every_look: true });
    if (traces.peek() === wanted) subscription = answer.subscription;
    else await call("unsubscribe", { subscription: answer.subscription });
  } catch (error) {
    scopeProblem.value = textOf(error);
  }
}

function record(state: StateTold): void {
  if (state.subscription !== subscription || isPaused.peek()) return;
  firstMs ??= state.event_time_ms;
  const last = rows.times.length - 1;
  // States of several axes come in the order in which they were read, but for those that waited.
  rows.times.push(Math.max((state.event_time_ms - firstMs) / 1000, rows.times[last] ?? 0));
  traces.peek().forEach((trace, index) => {
    const column = rows.columns[index]!;
    column.push(trace.axis === state.axis ? valueOf(trace, state) : (column[last] ?? null));
  });
  followState(state, (forecast) => compare(forecast, state.subscription));
  traces.peek().forEach((trace, index) => rows.differences[index]!.push(differenceOf(trace, index, rows.times.length - 1, forecasts.get(trace.axis))));
  if (rows.times.length >= mostRows + oldRows)
    for (const column of [rows.times, ...rows.columns, ...rows.differences]) column.splice(0, oldRows);
  for (const listener of newRow) listener();
}

/** In seconds of the recording. */
export const secondsOf = (eventMs: number) => (eventMs - (firstMs ?? 0)) / 1000;

/** What was recorded since the move has begun, before it was foreseen. */
function compare(forecast: Forecast, of: number): void {
  if (of !== subscription) return;
  hasForecast.value = true;
  const begin = secondsOf(forecast.beginMs);
  traces.peek().forEach((trace, index) => {
    if (trace.axis !== forecast.axis) return;
    for (let row = rows.times.length - 1; row >= 0 && rows.times[row]! >= begin; --row)
      rows.differences[index]![row] = differenceOf(trace, index, row, forecast);
  });
}

function differenceOf(trace: Trace, index: number, row: number, forecast: Forecast | undefined): number | null {
  const is = rows.columns[index]![row];
  const twin = forecast ? foreseen(forecast, trace.value, (firstMs ?? 0) + rows.times[row]! * 1000) : null;
  return is == null || twin === null ? null : is - twin;
}

function valueOf(trace: Trace, state: StateTold): number | null {
  const hasUnit = state.unit !== null;
  if (trace.value === "position") return hasUnit ? state.position : state.position_microsteps;
  if (trace.value === "target") return hasUnit ? state.target : state.target_microsteps;
  if (trace.value === "velocity") return hasUnit ? state.velocity : state.velocity_pps;
  const sample = state.samples.find((one) => one.parameter === trace.value || String(one.number) === trace.value);
  return sample ? (sample.value_in_unit ?? sample.value) : null;
}

/** What traces have in common that can be drawn on one scale. */
export function scaleOf(trace: Trace): string {
  if (isParameter(trace)) return trace.value;
  const unit = axes.peek().find((axis) => axis.info.name === trace.axis)?.units?.unit ?? "µsteps";
  return trace.value === "velocity" ? `${unit}/s` : unit;
}

export function csv(timeTitle: string): string {
  const titles = [timeTitle, ...traces.peek().map((trace) => `${trace.axis} ${trace.value} (${scaleOf(trace)})`)];
  // A name with a comma or a quote in it stays one column.
  const quoted = titles.map((title) => `"${title.replaceAll('"', '""')}"`);
  const lines = rows.times.map((time, row) => [time, ...rows.columns.map((column) => column[row] ?? "")].join(","));
  return [quoted.join(","), ...lines].join("\n") + "\n";
}
