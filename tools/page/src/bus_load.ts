// How much of the time a bus is in use, from two looks at its counters.
import type { Answer } from "./rpc";

export type Bus = Answer<"bus.list">["buses"][number];

export interface Traffic {
  datagramsPerS: number;
  /** Part of the time; null where the bit rate is not known. */
  load: number | null;
}

// With start and stop bit; a CAN frame without stuffed bits.
const bitsOfByte = 10;
const bitsOfSerialDatagram = 9 * bitsOfByte;
const bitsOfCanFrame = 47 + 7 * 8;

export function trafficBetween(before: Bus, now: Bus, seconds: number): Traffic | null {
  const datagrams = datagramsOf(now) - datagramsOf(before);
  const garbage = now.counters.garbage_bytes - before.counters.garbage_bytes;
  if (seconds <= 0 || datagrams < 0 || garbage < 0) return null; // tmcld has started again
  const each = now.link.startsWith("can:") ? bitsOfCanFrame : bitsOfSerialDatagram;
  const bits = datagrams * each + garbage * bitsOfByte;
  const load = now.bit_rate === null ? null : Math.min(bits / (now.bit_rate * seconds), 1);
  return { datagramsPerS: datagrams / seconds, load };
}

function datagramsOf({ counters }: Bus): number {
  const { requests, replies, late_replies, unexpected_replies, surplus } = counters;
  return requests + replies + late_replies + unexpected_replies + surplus;
}
