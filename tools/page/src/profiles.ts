// What the ramp generators make of the same move; the address has the set-up, so that a link carries it.
import { effect, signal } from "@preact/signals";
import { call, isConnected } from "./bench";
import { chips, type Chip } from "./chips";
import { CallError, textOf, type Answer } from "./rpc";
import { texts } from "./texts";

export type Simulation = Answer<"profile.simulate">;

/** Where a problem is shown: at the distance, at a register by its place among those of its chip, or at the chip. */
export interface Refusal {
  at: "distance" | "chip" | number;
  text: string;
}

const words = new URLSearchParams(location.search);
const usualDistance = 50_000;
const settleMs = 200;
const points = 800;

/** Texts, as they are typed. */
export const distance = signal(words.get("distance") ?? String(usualDistance));
/** Of each chip, in the order of its registers. */
export const values = signal(chips.map(valuesInAddress));
export const simulations = signal<(Simulation | null)[]>(chips.map(() => null));
export const refusals = signal<(Refusal | null)[]>(chips.map(() => null));

function valuesInAddress(chip: Chip): string[] {
  const given = words.get(chip.name)?.split(",") ?? [];
  return chip.registers.map((one, index) => given[index] || String(one.value));
}

function replaced<T>(all: T[], index: number, value: T): T[] {
  return all.map((one, place) => (place === index ? value : one));
}

export function setValue(chip: number, register: number, text: string): void {
  values.value = values.value.map((all, index) => (index === chip ? replaced(all, register, text) : all));
}

/** Keeps the simulations as the inputs are, until the function that it gives is called. */
export function watchInputs(): () => void {
  const ends = chips.map((_, index) => watchChip(index));
  const endAddress = effect(() => {
    const [wanted, far] = [values.value, distance.value];
    const timer = window.setTimeout(() => writeAddress(wanted, far), settleMs);
    return () => clearTimeout(timer);
  });
  return () => {
    for (const end of [...ends, endAddress]) end();
    writeAddress(null, null);
  };
}

function writeAddress(wanted: string[][] | null, far: string | null): void {
  const address = new URL(location.href);
  const put = (name: string, text: string | null) =>
    text === null ? address.searchParams.delete(name) : address.searchParams.set(name, text);
  put("distance", far);
  chips.forEach((chip, index) => put(chip.name, wanted?.[index]?.join(",") ?? null));
  history.replaceState(null, "", address);
}

/** A chip whose own inputs stay as they are is not asked again. */
function watchChip(index: number): () => void {
  let asked = "";
  let latest = 0;
  let timer: number | undefined;
  const end = effect(() => {
    const wanted = values.value[index]!;
    const far = distance.value;
    // What was lost with a connection is asked anew.
    if (!isConnected.value) asked = "";
    if (!isConnected.value) return;
    const wish = [...wanted, far].join();
    if (wish === asked) return;
    asked = wish;
    const mine = ++latest;
    clearTimeout(timer);
    timer = window.setTimeout(() => void simulate(index, wanted, far, () => mine === latest), settleMs);
  });
  return () => {
    end();
    clearTimeout(timer);
    ++latest;
  };
}

async function simulate(index: number, wanted: string[], far: string, isLatest: () => boolean): Promise<void> {
  const chip = chips[index]!;
  let made: Simulation | null = null;
  let refusal: Refusal | null = null;
  try {
    made = await call("profile.simulate", {
      model: chip.model,
      parameters: chip.registers.map((one) => one.parameter),
      values: wanted.map((text, register) => wholeNumber(text, register)),
      distance_microsteps: wholeNumber(far, "distance"),
      points,
    });
  } catch (error) {
    refusal = error instanceof NoNumber ? error.refusal : { at: placeOf(error, chip), text: textOf(error) };
  }
  // An answer that comes late is not of what is typed now.
  if (!isLatest()) return;
  simulations.value = replaced(simulations.value, index, made);
  refusals.value = replaced(refusals.value, index, refusal);
}

class NoNumber extends Error {
  constructor(readonly refusal: Refusal) {
    super(refusal.text);
  }
}

export function wholeNumber(text: string, at: Refusal["at"]): number {
  const value = Number(text);
  if (text.trim() === "" || !Number.isSafeInteger(value)) throw new NoNumber({ at, text: texts.noWholeNumber });
  return value;
}

/** The message of tmcld names a parameter by its number, or by its name where it has none. */
function placeOf(error: unknown, chip: Chip): Refusal["at"] {
  if (!(error instanceof CallError)) return "chip";
  if (error.data.param === "distance_microsteps") return "distance";
  const named = error.data.param === "values" ? /for parameter (\w+)/.exec(error.message)?.[1] : undefined;
  const place = chip.registers.findIndex((one) => String(one.number ?? one.parameter) === named);
  return place < 0 ? "chip" : place;
}

/** One after the other; ends at the first that the module does not take. */
export async function setOnAxis(axis: string, chip: Chip, wanted: string[]): Promise<string> {
  for (const [index, { parameter, name }] of chip.registers.entries()) {
    try {
      await call("parameter.set", { axis, parameter, value: wholeNumber(wanted[index]!, index) });
    } catch (error) {
      return texts.setUntil(name, error instanceof NoNumber ? error.message : textOf(error));
    }
  }
  return "";
}
