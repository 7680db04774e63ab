// What becomes of one press on a stop: who has to answer, who has, and who is asked again. Does no I/O.
import type { Fleet, Gateway } from "./fleet";
import { isOnline } from "./fleet";
import type { StopAnswer } from "./messages";
import { all } from "./topics";

export type Why =
  | { is: "no_answer"; seconds: number }
  | { is: "error"; message: string }
  /** The answer says nothing about it. */
  | { is: "left_out" }
  /** It is not on the broker any more, and has not answered before. */
  | { is: "gone" };

export interface Missing {
  gateway: string;
  /** Empty: the whole gateway. */
  axis: string;
  why: Why;
}

export interface StopReport {
  /** Of one gateway, or of all. */
  scope: string;
  isOver: boolean;
  /** Gateways all of whose axes have confirmed the stop. */
  done: string[];
  axes: number;
  missing: Missing[];
}

interface Expected {
  axes: string[];
  stopped: Set<string>;
  failed: Map<string, string>;
  /** Of the last answer. */
  error: string;
  hasAnswered: boolean;
  isGone: boolean;
}

export const repeatMs = 100;
// Those that do not answer are reported as such after it.
const giveUpMs = 30_000;
/** So long it is told at each axis. */
const tellMs = 60_000;
/** So long a gateway whose birth comes in counts, too, though all others have answered. */
const settleMs = 3000;
/** Of those that are missing, so many are asked again at a time, in turn: what is asked has to be answered, too. */
const mostAtOnce = 200;

export class StopRun {
  #expected = new Map<string, Expected>();
  #asked = -Infinity;
  #turn = 0;

  /** `id`: a level of the topic for answers, which no other run has. */
  constructor(
    readonly scope: string,
    readonly id: string,
    readonly began: number,
  ) {}

  /** To whom the stop is to be published now: gateways, or all. To be asked before each report. */
  due(fleet: Fleet, now: number): string[] {
    if (!this.isOver(now) || now - this.began < settleMs) this.look(fleet);
    if (now - this.#asked < repeatMs || this.isOver(now)) return [];
    const isFirst = this.#asked === -Infinity;
    this.#asked = now;
    const names = this.#unfinished();
    return isFirst || names.length === 0 ? [this.scope] : this.#inTurn(names);
  }

  take(gateway: string, answer: StopAnswer): void {
    const expected = this.#expected.get(gateway);
    if (!expected) return;
    expected.hasAnswered = true;
    expected.error = answer.error;
    for (const axis of answer.stopped) {
      expected.stopped.add(axis);
      expected.failed.delete(axis);
    }
    for (const { axis, why } of answer.failed) if (!expected.stopped.has(axis)) expected.failed.set(axis, why);
  }

  /** On an axis, or where that is empty on the whole gateway; null where this press says nothing any more. */
  verdictOn(gateway: string, axis: string, now: number): "confirmed" | "notConfirmed" | null {
    const expected = this.#expected.get(gateway);
    if (!expected || now - this.began > tellMs) return null;
    const isConfirmed = axis === "" ? isDone(expected) : expected.stopped.has(axis) && !expected.failed.has(axis);
    return isConfirmed ? "confirmed" : "notConfirmed";
  }
  isOver(now: number): boolean {
    return now - this.began > giveUpMs || (this.#expected.size > 0 && this.#asked !== -Infinity && this.#unfinished().length === 0);
  }
  /** By all, and there is something. */
  isConfirmed(): boolean {
    return this.#expected.size > 0 && [...this.#expected.values()].every(isDone);
  }

  report(now: number): StopReport {
    const report: StopReport = { scope: this.scope, isOver: this.isOver(now), done: [], axes: 0, missing: [] };
    for (const [gateway, expected] of this.#expected) {
      const missing = missingOf(gateway, expected, now - this.began);
      report.axes += expected.stopped.size;
      report.missing.push(...missing);
      if (missing.length === 0) report.done.push(gateway);
    }
    return report;
  }

  /** Who is there has to answer. */
  look(fleet: Fleet): void {
    if (this.scope === all) for (const gateway of fleet.all()) this.#lookAt(gateway);
    const gateway = fleet.gateway(this.scope);
    if (gateway) this.#lookAt(gateway);
  }
  #lookAt(gateway: Gateway): void {
    const known = this.#expected.get(gateway.name);
    if (gateway.birth && known) known.isGone = !isOnline(gateway);
    if (!isOnline(gateway)) return;
    const axes = gateway.birth!.axes;
    if (known) known.axes = [...new Set([...known.axes, ...axes])];
    else this.#expected.set(gateway.name, { axes, stopped: new Set(), failed: new Map(), error: "", hasAnswered: false, isGone: false });
  }
  #inTurn(names: string[]): string[] {
    const from = names.length > mostAtOnce ? this.#turn % names.length : 0;
    this.#turn = from + mostAtOnce;
    return [...names.slice(from), ...names.slice(0, from)].slice(0, mostAtOnce);
  }
  #unfinished(): string[] {
    const names = [...this.#expected.keys()];
    return names.filter((name) => !this.#expected.get(name)!.isGone && !isDone(this.#expected.get(name)!));
  }
}

function isDone({ hasAnswered, axes, stopped, failed, error }: Expected): boolean {
  return hasAnswered && failed.size === 0 && axes.every((axis) => stopped.has(axis)) && (error === "" || axes.length > 0);
}

function missingOf(gateway: string, expected: Expected, passedMs: number): Missing[] {
  if (isDone(expected)) return [];
  const whole = (why: Why): Missing[] => [{ gateway, axis: "", why }];
  if (expected.isGone) return whole({ is: "gone" });
  if (!expected.hasAnswered) return whole({ is: "no_answer", seconds: Math.floor(passedMs / 1000) });
  if (expected.error) return whole({ is: "error", message: expected.error });
  const failed = [...expected.failed].map(([axis, message]): Missing => ({ gateway, axis, why: { is: "error", message } }));
  const leftOut = expected.axes.filter((axis) => !expected.stopped.has(axis) && !expected.failed.has(axis));
  return [...failed, ...leftOut.map((axis): Missing => ({ gateway, axis, why: { is: "left_out" } }))];
}
