// Two instants of what the scope has recorded, and what lies between them.
import { effect, signal } from "@preact/signals";
import { rows, traces } from "./scope";

export type Cursor = number | null;

/** In seconds of the recording. */
export const cursors = signal<[Cursor, Cursor]>([null, null]);

export function setCursor(index: 0 | 1, at: Cursor): void {
  const [first, second] = cursors.peek();
  cursors.value = index === 0 ? [at, second] : [first, at];
}

/** The first, then the second; then anew. */
export function addCursor(at: number): void {
  const [first, second] = cursors.peek();
  cursors.value = first !== null && second === null ? [first, at] : [at, null];
}

/** Another set-up begins a new recording. */
effect(() => {
  void traces.value;
  cursors.value = [null, null];
});

/** Of each trace at the last row that had come by then. */
export function valuesAt(at: number): (number | null)[] {
  const after = rows.times.findIndex((time) => time > at);
  const row = (after < 0 ? rows.times.length : after) - 1;
  return rows.columns.map((column) => column[row] ?? null);
}
