// Holds the picture of the scope when a value passes a level: what came before is there already.
import { computed, effect, signal } from "@preact/signals";
import { isPaused, newRow, rows, traces, windowSeconds, type Trace } from "./scope";

export type Edge = "rising" | "falling";
export const edges: Edge[] = ["rising", "falling"];

interface Armed {
  trace: Trace;
  edge: Edge;
  level: number;
}

export const armed = signal<Armed | null>(null);
/** In seconds of the recording. */
export const firedAt = signal<number | null>(null);
export const isWaiting = computed(() => armed.value !== null && firedAt.value === null);

/** What is shown then has so much of its time behind the trigger. */
const partBehind = 0.5;

export function arm(wish: Armed): void {
  armed.value = wish;
  firedAt.value = null;
  isPaused.value = false;
}

export function disarm(): void {
  armed.value = null;
  firedAt.value = null;
}

/** Another set-up begins a new recording. */
effect(() => {
  void traces.value;
  disarm();
});

newRow.add(() => {
  const wish = armed.peek();
  const now = rows.times[rows.times.length - 1];
  if (!wish || now === undefined) return;
  const fired = firedAt.peek();
  if (fired === null) {
    if (passes(wish)) firedAt.value = now;
  } else if (now - fired >= partBehind * windowSeconds.peek()) {
    armed.value = null;
    isPaused.value = true;
  }
});

function passes({ trace, edge, level }: Armed): boolean {
  const column = rows.columns[traces.peek().indexOf(trace)] ?? [];
  const [before, now] = column.slice(-2);
  if (before == null || now == null) return false;
  return edge === "rising" ? before < level && now >= level : before > level && now <= level;
}
