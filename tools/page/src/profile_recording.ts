// The next move of a real axis, as it is read: laid over what the chips would make of one.
import { effect, signal } from "@preact/signals";
import { call, isConnected, stateListeners, type StateTold } from "./bench";
import { textOf } from "./rpc";

/** From where it stood; a move in the negative direction is turned round. */
export interface Recording {
  axis: string;
  times: number[];
  positions: number[];
  velocities: number[];
}

export const recording = signal<Recording | null>(null);
export const phase = signal<"" | "waiting" | "recording">("");
export const recordingProblem = signal("");

const intervalMs = 20;
/** A move that turns for ever is not recorded for ever. */
const mostRows = 5000;

let subscription: number | null = null;
let stood: StateTold | null = null;

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

/** Keeps what there is. */
export async function endRecording(): Promise<void> {
  const old = subscription;
  subscription = null;
  stood = null;
  phase.value = "";
  if (old !== null) await call("unsubscribe", { subscription: old }).catch(() => {});
}

/** A subscription ends with its connection. */
effect(() => {
  if (isConnected.value) return;
  subscription = null;
  stood = null;
  phase.value = "";
});

stateListeners.add((state) => {
  if (state.subscription !== subscription) return;
  if (state.moving) take(state);
  else if (phase.peek() === "recording") {
    take(state);
    void endRecording();
  } else stood = state;
});

/** Of an axis that moves already, the rest is recorded. */
function take(state: StateTold): void {
  const begin = (stood ??= state);
  const before = recording.peek() ?? { axis: state.axis, times: [], positions: [], velocities: [] };
  const way = state.target_microsteps < begin.position_microsteps ? -1 : 1;
  phase.value = "recording";
  recording.value = {
    axis: state.axis,
    times: [...before.times, (state.event_time_ms - begin.event_time_ms) / 1000],
    positions: [...before.positions, way * (state.position_microsteps - begin.position_microsteps)],
    velocities: [...before.velocities, way * (state.velocity_pps ?? 0)],
  };
  if (recording.value.times.length >= mostRows) void endRecording();
}
