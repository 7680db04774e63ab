import { useEffect, useState } from "preact/hooks";
import { textOf } from "../rpc";

export interface Poll<T> {
  answer: T | null;
  problem: string;
}

/** Asks again and again while it is shown and looked at; the last answer stays when one fails. */
export function usePoll<T>(ask: () => Promise<T>, everyMs: number, inputs: unknown[]): Poll<T> {
  const [poll, setPoll] = useState<Poll<T>>({ answer: null, problem: "" });
  useEffect(() => {
    let isOver = false;
    let timer = 0;
    const round = async () => {
      if (!document.hidden) {
        const told = await ask().then(
          (answer) => ({ answer, problem: "" }),
          (error) => ({ problem: textOf(error) }),
        );
        if (!isOver) setPoll((before) => ({ ...before, ...told }));
      }
      if (!isOver) timer = window.setTimeout(round, everyMs);
    };
    void round();
    return () => {
      isOver = true;
      clearTimeout(timer);
    };
  }, inputs);
  return poll;
}
