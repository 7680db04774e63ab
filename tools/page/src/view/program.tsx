import { useState } from "preact/hooks";
import { may } from "../access";
import { call } from "../bench";
import { hexOf } from "../hex";
import { linesOf, type ProgramLine } from "../program";
import { texts } from "../texts";
import { chosenFile } from "./chosen_file";
import { ProgramTable } from "./program_table";
import { useOutcome } from "./use_outcome";
import { usePoll } from "./use_poll";

const lookEveryMs = 500;

type Plain = "program.run" | "program.stop" | "program.step" | "program.reset";
const plain: Plain[] = ["program.run", "program.stop", "program.step", "program.reset"];

/** The program that a module runs by itself. */
export function Program({ bus, address }: { bus: string; address: number }) {
  const module = { bus, address };
  const { answer: status, problem: silence } = usePoll(() => call("program.status", module), lookEveryMs, [bus, address]);
  const [lines, setLines] = useState<ProgramLine[] | null>(null);
  const { problem, note, carryOut } = useOutcome();
  const read = async () => {
    const { program } = await call("program.read", module);
    setLines(linesOf(program));
    return "";
  };
  const load = async (field: HTMLInputElement) => {
    const file = chosenFile(field);
    if (!file) return "";
    const program = hexOf(new Uint8Array(await file.arrayBuffer()));
    const { commands } = await call("program.load", { ...module, program });
    setLines(linesOf(program));
    return texts.programLoaded(file.name, commands);
  };
  const act = (method: Plain) => carryOut(() => call(method, module).then(() => ""));
  const isStopped = status?.state !== "running";
  return (
    <section class="part" aria-label={texts.program}>
      <h2>{texts.program}</h2>
      {silence && <p class="problem">{silence}</p>}
      {status && <p data-state={status.state}>{texts.programStatus(texts.programStates[status.state] ?? status.state, status.next_address)}</p>}
      <div class="row">
        <button onClick={() => carryOut(read)}>{texts.readProgram}</button>
        {may("program.load") && (
          <label>
            {texts.loadProgram}
            <input type="file" accept=".bin" onChange={({ currentTarget }) => carryOut(() => load(currentTarget))} />
          </label>
        )}
        {plain.filter(may).map((method) => (
          <button disabled={method === "program.step" && !isStopped} onClick={() => act(method)}>
            {texts.programActions[method]}
          </button>
        ))}
      </div>
      <p class="help">{texts.programHelp}</p>
      {problem && <p class="problem" role="alert">{problem}</p>}
      {note && <p role="status">{note}</p>}
      {lines && <ProgramTable module={module} lines={lines} next={status?.next_address ?? null} carryOut={carryOut} />}
    </section>
  );
}
