// What goes over a bus, datagram by datagram, for as long as it is watched.
import { call } from "./bench";
import { clockText } from "./clock_text";
import { textOf, type Answer } from "./rpc";
import { texts } from "./texts";
import { meaningOf } from "./tmcl";

type Told = Answer<"bus.trace">["datagrams"][number];
/** With all of it as text, to filter by. */
export type Traced = Told & { time: string; meaning: string; words: string };

const everyMs = 250;
/** As many as tmcld remembers. */
const mostKept = 4096;
const mostAtOnce = 1024;

export interface Trace {
  /** The oldest first. */
  datagrams: Traced[];
  missed: number;
  problem: string;
}
export const noTrace: Trace = { datagrams: [], missed: 0, problem: "" };

/** Goes on behind `trace`; the function that is returned ends it. */
export function watchBus(bus: string, trace: Trace, onChange: (trace: Trace) => void): () => void {
  let isOver = false;
  let timer = 0;
  let after = trace.datagrams.at(-1)?.number;
  const round = async () => {
    try {
      const answer = await call("bus.trace", { bus, limit: mostAtOnce, ...(after === undefined ? {} : { after }) });
      if (isOver) return;
      const isAnew = after !== undefined && answer.last < after; // tmcld has started again
      trace = isAnew ? noTrace : extended(trace, answer, after !== undefined);
      after = isAnew ? undefined : (trace.datagrams.at(-1)?.number ?? answer.last);
      onChange(trace);
    } catch (error) {
      if (!isOver) onChange((trace = { ...trace, problem: textOf(error) }));
    }
    if (!isOver) timer = window.setTimeout(round, everyMs);
  };
  void round();
  return () => {
    isOver = true;
    clearTimeout(timer);
  };
}

function extended(trace: Trace, answer: Answer<"bus.trace">, hasBegun: boolean): Trace {
  const datagrams = [...trace.datagrams, ...answer.datagrams.map(traced)].slice(-mostKept);
  return { datagrams, missed: trace.missed + (hasBegun ? answer.dropped : 0), problem: "" };
}

function traced(told: Told): Traced {
  const meaning = meaningOf(told);
  const time = clockText(told.utc_us);
  const direction = texts.directions[told.direction] ?? told.direction;
  const words = [told.number, time, direction, told.client ?? texts.daemonItself, told.bytes, meaning].join(" ").toLowerCase();
  return { ...told, time, meaning, words };
}

/** The newest first, `most` of them. */
export function filtered({ datagrams }: Trace, text: string, most: number): Traced[] {
  const words = text.toLowerCase().split(/[\s,]+/).filter(Boolean);
  const fitting: Traced[] = [];
  for (let index = datagrams.length - 1; index >= 0 && fitting.length < most; --index) {
    const one = datagrams[index]!;
    if (words.every((word) => one.words.includes(word))) fitting.push(one);
  }
  return fitting;
}

export interface TracedClient {
  name: string;
  questions: number;
  lastTime: string;
}

/** Who has asked, among the datagrams that are kept; the last one first. */
export function clientsIn({ datagrams }: Trace): TracedClient[] {
  const clients = new Map<string, TracedClient>();
  for (let index = datagrams.length - 1; index >= 0; --index) {
    const { client, direction, time } = datagrams[index]!;
    if (client == null || direction !== "out") continue;
    const known = clients.get(client) ?? { name: client, questions: 0, lastTime: time };
    clients.set(client, { ...known, questions: known.questions + 1 });
  }
  return [...clients.values()];
}
