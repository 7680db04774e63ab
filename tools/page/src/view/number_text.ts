// Numbers as people read them, with the unit of their axis.
import type { Axis } from "../bench";
import { texts } from "../texts";

const digits = 4;

export function numberText(value: number): string {
  return String(Number(value.toFixed(digits)));
}

export function unitOf(axis: Axis): string {
  return axis.units?.unit ?? texts.microsteps;
}

/** In the axis' unit where it has one. */
export function positionOf(axis: Axis): number | null {
  const state = axis.state;
  return state && (state.unit !== null ? state.position : state.position_microsteps);
}

export function targetOf(axis: Axis): number | null {
  const state = axis.state;
  return state && (state.unit !== null ? state.target : state.target_microsteps);
}

export function velocityOf(axis: Axis): number | null {
  const state = axis.state;
  return state && (state.unit !== null ? state.velocity : state.velocity_pps);
}

export function limitsOf(axis: Axis): [number, number] | null {
  const units = axis.units;
  const least = units?.unit ? units.soft_limit_minimum : units?.soft_limit_minimum_microsteps;
  const greatest = units?.unit ? units.soft_limit_maximum : units?.soft_limit_maximum_microsteps;
  return least != null && greatest != null ? [least, greatest] : null;
}

export function withUnit(axis: Axis, value: number | null, per = ""): string {
  return value === null ? "–" : `${numberText(value)} ${unitOf(axis)}${per}`;
}
