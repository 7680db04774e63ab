// The text of a program that is edited, and what tmcld makes of it. It stays while another part of the page is looked at.
import { signal } from "@preact/signals";
import { call } from "./bench";
import { CallError, textOf, type Answer, type Problem } from "./rpc";
import { texts } from "./texts";

export type Assembled = Answer<"program.assemble">;

export const text = signal("");
/** Of the text as it is; null while that is not known, or where something is wrong with it. */
export const assembled = signal<Assembled | null>(null);
/** What is wrong with the text as it is. */
export const problems = signal<Problem[]>([]);
/** Why nothing is known of it; empty if something is. */
export const failure = signal("");

// A message to tmcld has 65,536 bytes at most.
const mostBytes = 60_000;

export function edit(wanted: string): void {
  text.value = wanted;
  assembled.value = null;
}

/** Null where it is wrong, or not to be known. */
export async function assemble(model: string | null): Promise<Assembled | null> {
  const wanted = text.peek();
  let told: { made: Assembled | null; wrong: Problem[]; why: string } = { made: null, wrong: [], why: "" };
  try {
    if (new Blob([JSON.stringify(wanted)]).size > mostBytes) throw new CallError(texts.textTooLong(mostBytes), "text_too_long");
    told.made = await call("program.assemble", { text: wanted, ...(model && { model }) });
  } catch (error) {
    const found = error instanceof CallError ? (error.data.problems ?? []) : [];
    told = { made: null, wrong: found, why: found.length > 0 ? "" : textOf(error) };
  }
  // What comes late is of another text.
  if (wanted !== text.peek()) return null;
  assembled.value = told.made;
  problems.value = told.wrong;
  failure.value = told.why;
  return told.made;
}

/** Where a line and a column begin, which counts in bytes of UTF-8. */
export function placeIn(wanted: string, line: number, column: number): number {
  const lines = wanted.split("\n");
  const before = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
  const bytes = new TextEncoder().encode(lines[line - 1] ?? "").slice(0, Math.max(0, column - 1));
  return before + new TextDecoder().decode(bytes).length;
}
