// The next move of a real axis, as it is read: laid over what the chips would make of one.
import { effect, signal } from "@preact/signals";
import { call, isConnected, stateListeners, type StateTold } from "./bench";
import { textOf } from "./rpc";

/** From where it stood; a move in the negative direction is turned round. */
export interface Recording {
  axis: string;
  times: number[];
  positions: number[];
  velocities: (number | null)[];
}

export const recording = signal<Recording | null>(null);
export const phase = signal<"" | "waiting" | "recording">("");
export const recordingProblem = signal("");

const intervalMs = 20;
/** A move that turns for ever is not recorded for ever. */
const mostRows = 5000;

let subscription: number | null = null;
let stood: StateTold | null = null;
/** Of a move, until it has ended. */
let rows: StateTold[] = [];

export async function recordNextMove(axis: string): Promise<void> {
  await endRecording();
  recording.value = null;
  recordingProblem.value = "";
  try {
    subscription = (await call("subscribe", { axes: [axis], interval_ms: intervalMs, every_look: true })).subscription;
    phase.value = "waiting";
  } catch (error) {
    recordingProblem.value = textOf(error);
  }
}

/** Shows what there is. */
export async function endRecording(): Promise<void> {
  const old = subscription;
  if (rows.length > 0) recording.value = recordingOf(stood ?? rows[0]!, rows);
  forget();
  if (old !== null) await call("unsubscribe", { subscription: old }).catch(() => {});
}

function forget(): void {
  subscription = null;
  stood = null;
  rows = [];
  phase.value = "";
}

/** A subscription ends with its connection. */
effect(() => {
  if (!isConnected.value) forget();
});

/** Of an axis that moves already, the rest is recorded. */
stateListeners.add((state) => {
  if (state.subscription !== subscription) return;
  if (!state.moving && rows.length === 0) {
    stood = state;
    return;
  }
  phase.value = "recording";
  rows.push(state);
  if (!state.moving || rows.length >= mostRows) void endRecording();
});

function recordingOf(begin: StateTold, states: StateTold[]): Recording {
  const end = states[states.length - 1]!;
  const way = end.position_microsteps < begin.position_microsteps ? -1 : 1;
  return {
    axis: begin.axis,
    times: states.map((state) => (state.event_time_ms - begin.event_time_ms) / 1000),
    positions: states.map((state) => way * (state.position_microsteps - begin.position_microsteps)),
    velocities: states.map((state) => (state.velocity_pps === null ? null : way * state.velocity_pps)),
  };
}
