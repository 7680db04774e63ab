import { useState } from "preact/hooks";
import { textOf } from "../rpc";

/** What came of the last action: a note, or what was wrong. */
export function useOutcome() {
  const [problem, setProblem] = useState("");
  const [note, setNote] = useState("");
  const carryOut = (action: () => Promise<string>) => {
    setProblem("");
    setNote("");
    action().then(setNote, (error) => setProblem(textOf(error)));
  };
  return { problem, note, carryOut };
}
