import { Component, type JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { may } from "../access";
import { isConnected } from "../bench";
import { highlighted, type Part } from "../highlight";
import { assemble, assembled, edit, failure, placeIn, problems, text, type Assembled } from "../program_text";
import type { Problem } from "../rpc";
import { texts } from "../texts";
import { chosenFile } from "./chosen_file";
import { saveFile } from "./save_file";

const settleMs = 300;
const mostProblems = 20;

interface ProgramEditorOf {
  /** Whose parameters the text may name. */
  model: string | null;
  /** Of the text, from 1: that of the next command, where the module has this text. */
  nextLine: number | null;
  /** Those with a breakpoint. */
  breakLines: number[];
  /** Sets a breakpoint at a line, or clears it; null where the module has another text. */
  toggleLine: ((line: number) => void) | null;
  /** Brings the program into the module. */
  load: (made: Assembled) => Promise<string>;
  carryOut: (action: () => Promise<string>) => void;
}

/** A program's text: coloured, checked by tmcld as it is typed, and loaded. */
export function ProgramEditor({ model, nextLine, breakLines, toggleLine, load, carryOut }: ProgramEditorOf) {
  const field = useRef<HTMLTextAreaElement>(null);
  const wanted = text.value;
  const isOpen = isConnected.value;
  useEffect(() => {
    if (!isOpen || !wanted) return;
    const timer = window.setTimeout(() => void assemble(model), settleMs);
    return () => clearTimeout(timer);
  }, [wanted, model, isOpen]);
  const open = async (input: HTMLInputElement) => {
    const file = chosenFile(input);
    if (file) edit((await file.text()).replaceAll("\r\n", "\n"));
    return "";
  };
  const assembleAndLoad = async () => {
    const made = assembled.peek() ?? (await assemble(model));
    return made ? load(made) : "";
  };
  const wrong = wanted ? problems.value : [];
  return (
    <>
      <h3>{texts.programText}</h3>
      <TextField field={field} wanted={wanted} wrong={wrong} nextLine={nextLine} breakLines={breakLines} toggleLine={toggleLine} />
      <p class="help">{texts.editorHelp}</p>
      <div class="row">
        <label>
          {texts.openText}
          <input type="file" accept=".tmc,.txt" onChange={({ currentTarget }) => carryOut(() => open(currentTarget))} />
        </label>
        <button disabled={!wanted} onClick={() => saveFile("program.tmc", wanted, "text/plain")}>
          {texts.saveText}
        </button>
        {may("program.load") && (
          <button disabled={!wanted || wrong.length > 0} onClick={() => carryOut(assembleAndLoad)}>
            {texts.loadText}
          </button>
        )}
        {wanted && assembled.value && <span role="status">{texts.isAssembled(assembled.value.commands)}</span>}
      </div>
      {wanted && failure.value && <p class="problem" role="alert">{failure.value}</p>}
      {wrong.length > 0 && <ProblemList wrong={wrong} field={field} />}
    </>
  );
}

interface TextFieldOf {
  field: { current: HTMLTextAreaElement | null };
  wanted: string;
  wrong: Problem[];
  nextLine: number | null;
  breakLines: number[];
  toggleLine: ((line: number) => void) | null;
}

/** The field lies over its coloured text, and scrolls it along. The numbers of its lines are beside the text. */
function TextField({ field, wanted, wrong, nextLine, breakLines, toggleLine }: TextFieldOf) {
  const colours = useRef<HTMLPreElement>(null);
  const badLines = new Set(wrong.map((one) => one.line));
  const scrollAlong = () => colours.current?.scrollTo(field.current!.scrollLeft, field.current!.scrollTop);
  const press = ({ currentTarget, offsetX, offsetY }: JSX.TargetedMouseEvent<HTMLTextAreaElement>) => {
    const { paddingLeft, paddingTop, lineHeight } = getComputedStyle(currentTarget);
    if (offsetX >= parseFloat(paddingLeft)) return;
    const down = offsetY + currentTarget.scrollTop - parseFloat(paddingTop);
    toggleLine?.(1 + Math.floor(down / parseFloat(lineHeight)));
  };
  return (
    <div class="editor">
      <pre ref={colours} aria-hidden="true">
        {highlighted(wanted).map((parts, index) => (
          <Line
            parts={parts}
            isBad={badLines.has(index + 1)}
            isNext={index + 1 === nextLine}
            isBreak={breakLines.includes(index + 1)}
          />
        ))}
      </pre>
      <textarea
        ref={field}
        aria-label={texts.programText}
        aria-invalid={wrong.length > 0 ? "true" : "false"}
        aria-describedby={wrong.length > 0 ? "program-problems" : undefined}
        spellcheck={false}
        autocapitalize="off"
        autocomplete="off"
        wrap="off"
        rows={14}
        value={wanted}
        onInput={(event) => edit(event.currentTarget.value)}
        onScroll={scrollAlong}
        onClick={press}
      />
    </div>
  );
}

interface LineOf {
  parts: Part[];
  isBad: boolean;
  isNext: boolean;
  isBreak: boolean;
}

/** Drawn again only where it has changed: a text may have thousands of lines. */
class Line extends Component<LineOf> {
  override shouldComponentUpdate(next: LineOf): boolean {
    const { parts, isBad, isNext, isBreak } = this.props;
    return isBad !== next.isBad || isNext !== next.isNext || isBreak !== next.isBreak || String(parts) !== String(next.parts);
  }
  override render({ parts, isBad, isNext, isBreak }: LineOf) {
    return (
      <div class={[isBad && "bad", isNext && "next", isBreak && "break"].filter(Boolean).join(" ") || undefined}>
        {parts.map(([kind, word]) => (kind ? <span class={kind}>{word}</span> : word))}
        {"\n"}
      </div>
    );
  }
}

/** Each leads to its place in the text. */
function ProblemList({ wrong, field }: { wrong: Problem[]; field: TextFieldOf["field"] }) {
  const show = ({ line, column }: Problem) => {
    const at = placeIn(text.peek(), line, column);
    field.current?.focus();
    field.current?.setSelectionRange(at, at);
  };
  return (
    <ul class="problem" id="program-problems" aria-label={texts.wrongInText} role="list">
      {wrong.slice(0, mostProblems).map((one) => (
        <li>
          <button onClick={() => show(one)}>{texts.problemAt(one.line, one.column, one.message)}</button>
        </li>
      ))}
      {wrong.length > mostProblems && <li>{texts.furtherProblems(wrong.length - mostProblems)}</li>}
    </ul>
  );
}
