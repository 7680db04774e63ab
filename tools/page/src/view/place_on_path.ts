import { axes } from "../bench";
import { positionOf } from "./number_text";

/** Where an axis is; null without a unit, of which the plan has another measure. */
export function placeOnPath(name: string): number | null {
  const axis = axes.value.find((one) => one.info.name === name);
  return axis?.units?.unit ? positionOf(axis) : null;
}
