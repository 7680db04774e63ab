// Stops everything. Nothing here waits for the subscription, or for what the page shows: each stop is a request of its own.
import { signal } from "@preact/signals";
import { access, refuse } from "./access";
import { everyAxisStands } from "./bench";
import { CallError, post, textOf } from "./rpc";
import { texts } from "./texts";

export interface StopReport {
  isOver: boolean;
  /** Stand, or have taken the stop where this page may not read. */
  stand: string[];
  /** Have taken the stop, and move yet. */
  braking: string[];
  /** Have not taken it, or move on; each with the reason. */
  failed: { axis: string; why: string }[];
}

export const stopReport = signal<StopReport | null>(null);

const answerWithinMs = 3000;
const retryMs = 300;
// Axes that do not take a stop, or do not stand, are reported as such after it.
const giveUpMs = 30000;

let lastPress = 0;

const pause = (ms: number) => new Promise((done) => setTimeout(done, ms));

/** Every press goes out, whatever became of those before. */
export async function stopAll(): Promise<void> {
  if (access.peek().is !== "in") return;
  const press = ++lastPress;
  const ends = performance.now() + giveUpMs;
  const isNewest = () => press === lastPress;
  stopReport.value = { isOver: false, stand: [], braking: [], failed: [] };
  let taken = await stopOnce();
  while (isNewest() && access.peek().is === "in") {
    const report = await lookAt(taken);
    const isDone = report.braking.length === 0 && report.failed.length === 0;
    report.isOver = isDone || performance.now() > ends;
    if (!isNewest()) return;
    stopReport.value = report;
    if (report.isOver) return;
    await pause(retryMs);
    if (isNewest() && report.failed.length > 0) taken = await stopOnce();
  }
}

type Taken = { axes: string[]; failed: StopReport["failed"] };

async function stopOnce(): Promise<Taken> {
  try {
    const answer = await post("system.stop_all", {}, answerWithinMs);
    const failed = answer.failed.map((one) => ({ axis: one.axis, why: String(one.error.message ?? "") }));
    return { axes: answer.stopped.map((one) => one.axis), failed };
  } catch (error) {
    if (error instanceof CallError && signInErrors.includes(error.name)) refuse(error.message, error.name);
    return { axes: [], failed: [{ axis: texts.allAxes, why: textOf(error) }] };
  }
}

const signInErrors = ["sign_in_ended", "unknown_token", "no_token"];

async function lookAt(taken: Taken): Promise<StopReport> {
  const moves = await Promise.all(taken.axes.map(doesMove));
  const braking = taken.axes.filter((_, index) => moves[index]);
  const stand = taken.axes.filter((_, index) => !moves[index]);
  return { isOver: false, stand, braking, failed: taken.failed };
}

/** False where this page may not know. */
async function doesMove(axis: string): Promise<boolean> {
  try {
    return (await post("axis.get_state", { axis }, answerWithinMs)).moving;
  } catch (error) {
    return !(error instanceof CallError && error.name === "not_permitted");
  }
}

/** In a text of several lines it is a character, as long as it would stop nothing: every axis is known to stand. */
const isCharacter = (event: KeyboardEvent) => event.target instanceof HTMLTextAreaElement && everyAxisStands();

/** The space bar stops wherever the focus is: a button does not take it for a click, and a field not for a character. */
function takeSpaceBar(event: KeyboardEvent): void {
  if (event.key !== " " || access.peek().is !== "in" || isCharacter(event)) return;
  event.preventDefault();
  event.stopPropagation();
  if (event.type === "keydown" && !event.repeat) void stopAll();
}
addEventListener("keydown", takeSpaceBar, true);
addEventListener("keyup", takeSpaceBar, true);
