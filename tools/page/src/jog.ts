// A button that is tapped makes one step; held, the axis goes on until it is released. What ends a hold for sure is tmcld:
// the axis moves only as long as axis.jog comes again, whatever becomes of this page.
import { signal } from "@preact/signals";
import { call, expectArrival } from "./bench";
import type { Axis } from "./bench";
import { textOf } from "./rpc";

export const stepSizes = [0.01, 0.1, 1, 10, 100];
export const speeds = [0.05, 0.25, 1];
/** Of an axis without a unit: a step of 1 is so many. */
export const microstepsInAStep = 100;

export const stepSize = signal(kept("step", stepSizes, 1));
/** Of max_velocity. */
export const speed = signal(kept("speed", speeds, 0.25));

const holdAfterMs = 500;
const holdMs = 300;
const renewEveryMs = holdMs / 3;
const leaseMs = 2000;
const renewalsOfALease = 4;

export type Direction = 1 | -1;

/** By axis: when the last hold has braked, and has given back its lease. */
const endOfHold = new Map<string, Promise<void>>();

/** A press of a button, until it is released. */
export class Press {
  #isHeld = false;
  #isOver = false;
  #timer: number;

  constructor(
    private readonly axis: Axis,
    private readonly direction: Direction,
    private readonly onProblem: (text: string) => void,
  ) {
    this.#timer = window.setTimeout(() => void this.#hold(), holdAfterMs);
  }

  /** The finger, the pointer or the key has gone up: a short press is a step. */
  release(): void {
    if (!this.#isOver && !this.#isHeld) void this.#step();
    this.cancel();
  }

  /** Ends a hold, and makes no step: the pointer is lost, or the page is hidden. */
  cancel(): void {
    this.#isOver = true;
    clearTimeout(this.#timer);
  }

  async #step(): Promise<void> {
    try {
      await endOfHold.get(this.axis.info.name);
      const moved = await call("axis.move_by", { axis: this.axis.info.name, ...distanceOfStep(this.axis, this.direction) });
      expectArrival(this.axis.info.name, moved);
    } catch (error) {
      this.onProblem(textOf(error));
    }
  }

  async #hold(): Promise<void> {
    this.#isHeld = true;
    const name = this.axis.info.name;
    await endOfHold.get(name);
    const end = this.#goOn(name).catch((error) => this.onProblem(textOf(error)));
    endOfHold.set(name, end);
  }

  async #goOn(name: string): Promise<void> {
    const fastest = await call("parameter.get", { axis: name, parameter: "max_velocity" });
    const velocity = Math.max(1, Math.round(fastest.value * speed.peek())) * this.#sign();
    if (this.#isOver) return;
    const lease = await call("lease.acquire", { axes: [name], ttl_ms: leaseMs });
    try {
      await this.#keepGoing(velocity, lease);
    } finally {
      await call("lease.release", { lease: lease.lease, epoch: lease.epoch });
    }
  }

  async #keepGoing(velocity: number, lease: { lease: number; epoch: number }): Promise<void> {
    const axis = this.axis.info.name;
    let renewedAt = performance.now();
    while (!this.#isOver) {
      await call("axis.jog", { axis, velocity_internal: velocity, hold_ms: holdMs });
      if (performance.now() - renewedAt > leaseMs / renewalsOfALease) {
        renewedAt = performance.now();
        await call("lease.renew", { lease: lease.lease, epoch: lease.epoch });
      }
      await new Promise((done) => setTimeout(done, renewEveryMs));
    }
    await call("axis.jog", { axis, velocity_internal: 0, hold_ms: holdMs });
  }

  /** The module counts its way; the axis' unit may grow the other way. */
  #sign(): number {
    return this.axis.units?.unit && this.axis.units.reverse ? -this.direction : this.direction;
  }
}

export function distanceOfStep(axis: Axis, direction: Direction): { distance: number } | { distance_microsteps: number } {
  const step = stepSize.value * direction;
  if (axis.units?.unit) return { distance: step };
  return { distance_microsteps: Math.round(step * microstepsInAStep) };
}

/** The storage may be full, or not allowed: the choice holds for as long as the page is open then. */
export function keep(name: string, value: number): void {
  try {
    localStorage.setItem(name, String(value));
  } catch {
    // nothing is kept
  }
}

function kept(name: string, choices: number[], otherwise: number): number {
  try {
    const value = Number(localStorage.getItem(name));
    return choices.includes(value) ? value : otherwise;
  } catch {
    return otherwise;
  }
}
