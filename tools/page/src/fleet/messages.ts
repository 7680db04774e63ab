// What gateways say on a broker. Anything may have been written there: what is not as docs/FLEET.md has it is null. Does no I/O.

export interface Birth {
  isOnline: boolean;
  epoch: string;
  /** Of tmcld; empty: it is not there. */
  tmcld: string;
  axes: string[];
}

export interface AxisState {
  position_microsteps: number;
  velocity_pps: number | null;
  position: number | null;
  velocity: number | null;
  target: number | null;
  target_microsteps: number;
  unit: string | null;
  moving: boolean;
  latched: boolean;
  referenced: boolean;
  unattended: boolean;
  stop_cause: string | null;
  owner: string | null;
  faults: string[];
}

/** The part of a state that changes on the way. */
export type Telemetry = Pick<AxisState, "position_microsteps" | "velocity_pps" | "position" | "velocity">;

export interface StopAnswer {
  stopped: string[];
  failed: { axis: string; why: string }[];
  /** Of the whole answer; empty: there is none. */
  error: string;
}

const mostBytes = { birth: 65_536, state: 16_384, telemetry: 4096, answer: 1_000_000 };
const mostAxes = 512;
const longestText = 256;

type Json = Record<string, unknown>;
type Check<T> = (value: unknown) => value is T;

const decoder = new TextDecoder("utf-8", { fatal: true });

const isObject = (value: unknown): value is Json => typeof value === "object" && value !== null && !Array.isArray(value);
const isNumber = (value: unknown): value is number => typeof value === "number" && Number.isFinite(value);
const isTrueOrFalse = (value: unknown): value is boolean => typeof value === "boolean";
const isText = (value: unknown): value is string => typeof value === "string" && value.length <= longestText;
const orNull = <T>(check: Check<T>) => (value: unknown): value is T | null => value === null || check(value);
const listOf = <T>(check: Check<T>) => (value: unknown): value is T[] => Array.isArray(value) && value.length <= mostAxes && value.every(check);

function objectIn(payload: Uint8Array, most: number): Json | null {
  if (payload.length > most) return null;
  try {
    const value: unknown = JSON.parse(decoder.decode(payload));
    return isObject(value) ? value : null;
  } catch {
    return null;
  }
}

/** The members that are checked, and no others. */
function shaped<T extends object>(said: Json, shape: { [Key in keyof T]: Check<T[Key]> }): T | null {
  const taken: Json = {};
  for (const key of Object.keys(shape) as (keyof T & string)[]) {
    if (!Object.hasOwn(said, key) || !shape[key](said[key])) return null;
    taken[key] = said[key];
  }
  return taken as T;
}

/** `isName`: an axis may be called so. */
export function readBirth(payload: Uint8Array, isName: (text: string) => boolean): Birth | null {
  const said = objectIn(payload, mostBytes.birth);
  const head = said && shaped(said, { online: isTrueOrFalse, epoch: isText });
  if (!said || !head) return null;
  if (!head.online) return { isOnline: false, epoch: head.epoch, tmcld: "", axes: [] };
  const rest = shaped(said, { tmcld: orNull(isText), axes: listOf(isText) });
  if (!rest || !rest.axes.every(isName)) return null;
  return { isOnline: true, epoch: head.epoch, tmcld: rest.tmcld ?? "", axes: [...new Set(rest.axes)] };
}

const ofMoving = {
  position_microsteps: isNumber,
  velocity_pps: orNull(isNumber),
  position: orNull(isNumber),
  velocity: orNull(isNumber),
};

const ofState = {
  ...ofMoving,
  target: orNull(isNumber),
  target_microsteps: isNumber,
  unit: orNull(isText),
  moving: isTrueOrFalse,
  latched: isTrueOrFalse,
  referenced: isTrueOrFalse,
  unattended: isTrueOrFalse,
  stop_cause: orNull(isText),
  owner: orNull(isText),
  faults: listOf(isText),
};

/** Of that axis. */
export function readState(payload: Uint8Array, axis: string): AxisState | null {
  const said = objectIn(payload, mostBytes.state);
  return said && said["axis"] === axis ? shaped<AxisState>(said, ofState) : null;
}

export function readTelemetry(payload: Uint8Array): Telemetry | null {
  const said = objectIn(payload, mostBytes.telemetry);
  return said && shaped<Telemetry>(said, ofMoving);
}

function messageOf(error: unknown): string {
  return isObject(error) && typeof error["message"] === "string" ? error["message"].slice(0, longestText) : "";
}

export function readStopAnswer(payload: Uint8Array): StopAnswer | null {
  const said = objectIn(payload, mostBytes.answer);
  if (!said) return null;
  if (isObject(said["error"])) return { stopped: [], failed: [], error: messageOf(said["error"]) || "?" };
  const result = said["result"];
  const lists = isObject(result) && shaped(result, { stopped: listOf(isObject), failed: listOf(isObject) });
  if (!lists || ![...lists.stopped, ...lists.failed].every(({ axis }) => isText(axis))) return null;
  const failed = lists.failed.map(({ axis, error }) => ({ axis: axis as string, why: messageOf(error) || "?" }));
  return { stopped: lists.stopped.map(({ axis }) => axis as string), failed, error: "" };
}
