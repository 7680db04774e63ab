// A file on its way to the axes: tmcld plans it, then runs the plan that a person has seen.
import { effect, signal } from "@preact/signals";
import { call } from "./bench";
import { file, kind, stage, type PathFile } from "./path_file";
import { CallError, textOf, type Answer, type Params, type Problem } from "./rpc";
import { texts } from "./texts";

export type Plan = Answer<"path.plan">;
/** Where the axes were seen on the path, and where they were farthest off. */
export type Passage = Pick<Answer<"path.run">, "seen" | "off_path_at">;

export const modes = ["velocity", "segments", "position"];

/** Numbers are texts, as they are typed: empty is what tmcld takes by itself. */
export const settings = signal({ mode: "velocity", tolerance: "", velocity: "", acceleration: "", perTurn: "", lenient: false });
export type Settings = typeof settings.value;

/** By axis of the file, what a person has chosen for it. */
export const assigned = signal<Record<string, string>>({});
/** Axes of the file that are known: tmcld tells them. */
export const fileAxes = signal<string[]>([]);

export const plan = signal<Plan | null>(null);
/** A plan is run once, and holds for the settings that it was made with. */
export const mayRun = signal(false);
export const busy = signal<"" | "planning" | "running">("");
export const problem = signal<{ text: string; lines: Problem[] } | null>(null);
export const outcome = signal("");
/** Of the plan that was run last. */
export const passage = signal<Passage | null>(null);

const pointsOfCurve = 2000;

/** What was known of the file before is of another file. */
effect(() => {
  void file.value;
  assigned.value = {};
  fileAxes.value = [];
  plan.value = null;
  passage.value = null;
  outcome.value = "";
  problem.value = null;
});

/** A plan of other settings is not run. */
effect(() => {
  void [file.value, kind.value, settings.value, assigned.value];
  mayRun.value = false;
});

export function assign(fileAxis: string, axis: string): void {
  assigned.value = { ...assigned.peek(), [fileAxis]: axis };
}

export async function dryRun(): Promise<void> {
  const chosen = file.peek();
  if (!chosen) return;
  const wish = [chosen, kind.peek(), settings.peek(), assigned.peek()];
  await carryOut("planning", async () => {
    const made = await call("path.plan", { ...(await request(chosen)), points: pointsOfCurve });
    if (chosen !== file.peek()) return;
    plan.value = made;
    passage.value = null;
    fileAxes.value = made.course.axes.map((one) => one.axis);
    mayRun.value = [file.peek(), kind.peek(), settings.peek(), assigned.peek()].every((one, index) => one === wish[index]);
  });
}

/** What was planned last. The daemon keeps it until it is run. */
export async function runPlan(toStart: boolean): Promise<void> {
  const wanted = plan.peek();
  if (!wanted || !mayRun.peek()) return;
  mayRun.value = false;
  await carryOut("running", async () => {
    const ran = await call("path.run", { plan: wanted.plan, to_start: toStart, points: pointsOfCurve });
    passage.value = ran;
    outcome.value = [texts.pathPassed(ran.passed_s, ran.off_path), ...ran.warnings, ...ran.remarks].join(". ");
  });
}

/** Axis 0 of the program is the first of them. */
export async function runMint(axes: string[]): Promise<void> {
  const chosen = file.peek();
  if (!chosen) return;
  await carryOut("running", async () => {
    const ran = await call("mint.run", { axes, bytes: await stage(chosen) });
    outcome.value = [texts.mintPassed(ran.groups.length), ...ran.remarks].join(". ");
  });
}

async function carryOut(what: "planning" | "running", action: () => Promise<void>): Promise<void> {
  busy.value = what;
  problem.value = null;
  outcome.value = "";
  try {
    await action();
  } catch (error) {
    refuse(error);
  } finally {
    busy.value = "";
  }
}

function refuse(error: unknown): void {
  const data = error instanceof CallError ? error.data : {};
  problem.value = { text: textOf(error), lines: data.problems ?? [] };
  // It has begun, and was ended early.
  if (data.run?.seen) passage.value = data.run;
  // An axis of the file with a name of its own: a person says which one it is.
  const missing = data.file_axis;
  if (typeof missing === "string" && !fileAxes.peek().includes(missing)) fileAxes.value = [...fileAxes.peek(), missing];
}

async function request(chosen: PathFile): Promise<Params<"path.plan">> {
  const wish = settings.peek();
  const chosenAxes = Object.entries(assigned.peek()).filter(([, axis]) => axis);
  return {
    ...(chosenAxes.length > 0 && { file_axes: chosenAxes.map(([name]) => name), axes: chosenAxes.map(([, axis]) => axis) }),
    ...(kind.peek() !== "auto" && { format: kind.peek() }),
    ...(wish.tolerance && { tolerance: numberIn(wish.tolerance) }),
    ...(wish.velocity && { velocity: quantityIn(wish.velocity) }),
    ...(wish.acceleration && { acceleration: quantityIn(wish.acceleration) }),
    ...(wish.perTurn && { per_turn: numberIn(wish.perTurn) }),
    mode: wish.mode,
    lenient: wish.lenient,
    name: chosen.name,
    bytes: await stage(chosen),
  };
}

function numberIn(text: string): number {
  const value = Number(text.replace(",", "."));
  if (!Number.isFinite(value)) throw new CallError(`${texts.noNumber}: ${text}`, "no_number");
  return value;
}

/** A number in the units of the file; or a text with its unit, such as 20mm/s, which tmcld reads. */
function quantityIn(text: string): number | string {
  const value = Number(text.replace(",", "."));
  return Number.isFinite(value) ? value : text.trim();
}
