// The parameters of an axis: what its model has, and what they are now.
import { call } from "./bench";
import { textOf, type Answer } from "./rpc";

export type ParameterInfo = Answer<"parameter.list">["parameters"][number];
export type ParameterValue = Answer<"parameter.get">;

/** What was told, or what was wrong. */
export interface Reading {
  value: ParameterValue | null;
  problem: string;
}

const questionsAtOnce = 8;

// A motor goes by these: they are for the card of the axis, which knows its limits and its lease.
const moving = new Set(["target_position", "actual_position", "target_velocity"]);

export function isEditable(info: ParameterInfo): boolean {
  return info.access === "read_write" && !moving.has(info.name);
}

export function fits(info: ParameterInfo, words: string[]): boolean {
  const text = [info.number, info.name, info.meaning, info.unit, ...info.aliases].join(" ").toLowerCase();
  return words.every((word) => text.includes(word));
}

/** Some at a time, so that a long list keeps no other client waiting; `take` has each as it comes. */
export async function readAll(axis: string, numbers: number[], take: (number: number, reading: Reading) => boolean): Promise<void> {
  for (let first = 0; first < numbers.length; first += questionsAtOnce) {
    const some = numbers.slice(first, first + questionsAtOnce);
    const readings = await Promise.all(some.map((number) => readOne(axis, number)));
    if (!readings.every((reading, index) => take(some[index]!, reading))) return;
  }
}

async function readOne(axis: string, parameter: number): Promise<Reading> {
  return call("parameter.get", { axis, parameter }).then(
    (value) => ({ value, problem: "" }),
    (error) => ({ value: null, problem: textOf(error) }),
  );
}

/** An integer is in what the module counts in; a text with its unit is read by tmcld. */
export function setParameter(axis: string, parameter: number, text: string): Promise<Answer<"parameter.set">> {
  const trimmed = text.trim();
  const wish = /^[-+]?\d+$/.test(trimmed) ? { value: Number(trimmed) } : { value_in_unit: trimmed };
  return call("parameter.set", { axis, parameter, ...wish });
}

