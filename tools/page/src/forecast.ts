// What traced axes will do: a move from rest as the twin of the axis makes it, which tmcld computes.
import { signal } from "@preact/signals";
import { call, type StateTold } from "./bench";
import type { Answer } from "./rpc";

/** One move of an axis; positions and velocities are as the traces of the axis have them. */
export interface Forecast {
  axis: string;
  targetMicrosteps: number;
  /** When it began, by the clock of tmcld. */
  beginMs: number;
  /** From there, in seconds. */
  times: number[];
  positions: number[];
  velocities: number[];
}

export const isForecasting = signal(true);
/** The last move of each axis, by its name. */
export const forecasts = new Map<string, Forecast>();

const points = 1000;

// The values of a state are read one after the other: it may move already, and have its old target.
const targetFollowsMs = 500;

interface Rest {
  state: StateTold;
  /** When it was seen moving, by the clock of tmcld. */
  movesSinceMs: number | null;
}
/** Of each axis that stands. */
const atRest = new Map<string, Rest>();
const targets = new Map<string, number>();

export function forgetForecasts(): void {
  forecasts.clear();
  atRest.clear();
  targets.clear();
}

/** Of each state that the scope is told; `onNew` when a move that has begun is foreseen. */
export function followState(state: StateTold, onNew: (forecast: Forecast) => void): void {
  if (!isForecasting.peek()) return;
  const { axis, target_microsteps: target } = state;
  targets.set(axis, target);
  if (forecasts.get(axis)?.targetMicrosteps !== target) forecasts.delete(axis);
  const known = atRest.get(axis);
  // One that has its target and does not move yet is about to. Whether it is there is read first, and may be of before.
  const isThere = state.position_reached && state.position_microsteps === target;
  const isAboutToMove = known !== undefined && known.state.target_microsteps !== target && !isThere;
  if (!state.moving && !isAboutToMove) {
    atRest.set(axis, { state, movesSinceMs: null });
    return;
  }
  if (!state.moving || !known) return;
  known.movesSinceMs ??= state.event_time_ms;
  const mayFollow = state.event_time_ms - known.movesSinceMs < targetFollowsMs;
  if (known.state.target_microsteps === target && mayFollow) return;
  atRest.delete(axis);
  void foresee(known.state, state, onNew);
}

/** The target is another one than that where it stood: otherwise something else turns it. */
async function foresee(before: StateTold, now: StateTold, onNew: (forecast: Forecast) => void): Promise<void> {
  const way = now.target_microsteps - before.position_microsteps;
  if (way === 0 || now.target_microsteps === before.target_microsteps) return;
  try {
    // Asked for after the move has begun, so that settings written right before it count.
    const ramp = await call("axis.get_ramp", { axis: now.axis, in_motion: true });
    const { curve } = await call("profile.simulate", {
      model: ramp.model,
      parameters: ramp.settings.map((one) => String(one.number)),
      values: ramp.settings.map((one) => one.value),
      distance_microsteps: way,
      points,
    });
    if (!curve) return;
    if (targets.get(now.axis) !== now.target_microsteps) return;
    const forecast = forecastOf(before, now, curve);
    forecasts.set(now.axis, forecast);
    onNew(forecast);
  } catch {
    // Its ramps are not described.
  }
}

function forecastOf(before: StateTold, now: StateTold, curve: NonNullable<Answer<"profile.simulate">["curve"]>): Forecast {
  const hasUnit = now.unit !== null && before.position !== null && now.target !== null;
  const way = now.target_microsteps - before.position_microsteps;
  const scale = hasUnit ? (now.target! - before.position!) / way : 1;
  const origin = hasUnit ? before.position! : before.position_microsteps;
  // It has begun when its twin would have to be where it was seen first.
  const seenAt = now.position_microsteps - before.position_microsteps;
  const onTheWay = curve.positions_microsteps.findIndex((one) => Math.abs(one) >= Math.abs(seenAt));
  return {
    axis: now.axis,
    targetMicrosteps: now.target_microsteps,
    beginMs: now.event_time_ms - 1000 * (onTheWay < 0 ? 0 : crossing(curve.times_s, curve.positions_microsteps, onTheWay, seenAt)),
    times: curve.times_s,
    positions: curve.positions_microsteps.map((one) => origin + one * scale),
    velocities: curve.velocities_pps.map((one) => one * scale),
  };
}

/** When the way between two points of a curve, the second of them at `index`, is so far. */
function crossing(times: number[], ways: number[], index: number, way: number): number {
  const [to, end] = [ways[index]!, times[index]!];
  const [from, begin] = [ways[index - 1] ?? to, times[index - 1] ?? end];
  return from === to ? end : begin + ((end - begin) * (way - from)) / (to - from);
}

/** Of position or velocity; null before the move and after it, and for other values. */
export function foreseen(forecast: Forecast, value: string, atMs: number): number | null {
  const values = valuesOf(forecast, value);
  const { times } = forecast;
  const seconds = (atMs - forecast.beginMs) / 1000;
  const end = times[times.length - 1] ?? 0;
  if (!values || seconds < 0 || seconds > end || end === 0) return null;
  // They are spread evenly.
  const place = (seconds / end) * (times.length - 1);
  const index = Math.min(Math.floor(place), times.length - 2);
  return values[index]! + (values[index + 1]! - values[index]!) * (place - index);
}

export function valuesOf(forecast: Forecast, value: string): number[] | null {
  if (value === "position") return forecast.positions;
  return value === "velocity" ? forecast.velocities : null;
}
