import { useState } from "preact/hooks";
import { may } from "../access";
import { call } from "../bench";
import { hexOf } from "../hex";
import { linesOf, type ProgramLine } from "../program";
import { text, type Assembled } from "../program_text";
import { texts } from "../texts";
import { chosenFile } from "./chosen_file";
import { ProgramEditor } from "./program_editor";
import { ProgramTable } from "./program_table";
import { useOutcome } from "./use_outcome";
import { usePoll } from "./use_poll";

const lookEveryMs = 500;

type Plain = "program.run" | "program.stop" | "program.step" | "program.reset";
const plain: Plain[] = ["program.run", "program.stop", "program.step", "program.reset"];

/** The text that was loaded, and the line of each of its commands. */
interface Source {
  text: string;
  lines: number[];
}

/** The program that a module runs by itself. */
export function Program({ bus, address, model }: { bus: string; address: number; model: string | null }) {
  const module = { bus, address };
  const { answer: status, problem: silence } = usePoll(() => call("program.status", module), lookEveryMs, [bus, address]);
  const [lines, setLines] = useState<ProgramLine[] | null>(null);
  const [source, setSource] = useState<Source | null>(null);
  const [breakpoints, setBreakpoints] = useState<number[]>([]);
  const { problem, note, carryOut } = useOutcome();
  const read = async () => {
    const { program } = await call("program.read", module);
    setLines(linesOf(program));
    setSource(null);
    return "";
  };
  const load = async (field: HTMLInputElement) => {
    const file = chosenFile(field);
    if (!file) return "";
    const program = hexOf(new Uint8Array(await file.arrayBuffer()));
    const { commands } = await call("program.load", { ...module, program });
    setLines(linesOf(program));
    setSource(null);
    return texts.programLoaded(file.name, commands);
  };
  const loadText = async ({ program, lines: linesOfText }: Assembled) => {
    const loaded = { text: text.peek(), lines: linesOfText };
    const { commands } = await call("program.load", { ...module, program });
    setLines(linesOf(program));
    setSource(loaded);
    return texts.textLoaded(commands);
  };
  const act = (method: Plain) => carryOut(() => call(method, module).then(() => ""));
  // Modules do not tell their breakpoints: those of this page are known.
  const toggleBreakpoint = (at: number) =>
    carryOut(async () => {
      const isSet = breakpoints.includes(at);
      await call(isSet ? "program.clear_breakpoint" : "program.set_breakpoint", { ...module, at });
      setBreakpoints(isSet ? breakpoints.filter((one) => one !== at) : [...breakpoints, at]);
      return "";
    });
  const toggleLine = (line: number) => {
    const at = source?.lines.indexOf(line) ?? -1;
    if (at >= 0) toggleBreakpoint(at);
  };
  const isStopped = status?.state !== "running";
  const next = status?.next_address ?? null;
  /** Null where the module has another text than the editor. */
  const linesHere = source !== null && source.text === text.value ? source.lines : null;
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
      {lines && (
        <ProgramTable
          lines={lines}
          linesOfText={source?.lines ?? null}
          next={next}
          breakpoints={breakpoints}
          toggleBreakpoint={toggleBreakpoint}
        />
      )}
      <ProgramEditor
        model={model}
        nextLine={next === null ? null : (linesHere?.[next] ?? null)}
        breakLines={breakpoints.map((at) => linesHere?.[at] ?? 0)}
        toggleLine={linesHere && may("program.set_breakpoint") ? toggleLine : null}
        load={loadText}
        carryOut={carryOut}
      />
    </section>
  );
}
