// The lines of the table: a gateway, and its axes beneath it. Does no I/O.
import type { Gateway } from "./fleet";
import { fits } from "./glob";

export interface Row {
  gateway: Gateway;
  /** Empty: the line of the gateway itself. */
  axis: string;
}

export function rowsOf(gateways: Gateway[], pattern: string): Row[] {
  const shown = gateways.filter(({ name }) => fits(pattern.trim(), name));
  return shown.flatMap((gateway) => [{ gateway, axis: "" }, ...gateway.birth!.axes.map((axis) => ({ gateway, axis }))]);
}

/** Beyond both ends of what is in sight. */
const spareRows = 8;

export interface Window {
  first: number;
  /** Behind the last one. */
  end: number;
}

/** Of so many lines of one height, those that are drawn. */
export function windowOf(count: number, scrolled: number, height: number, rowHeight: number): Window {
  const first = Math.max(0, Math.min(count, Math.floor(scrolled / rowHeight)) - spareRows);
  return { first, end: Math.min(count, Math.ceil((scrolled + height) / rowHeight) + spareRows) };
}
