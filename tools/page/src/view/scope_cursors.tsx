import { isPaused, scaleOf, traces } from "../scope";
import { cursors, setCursor, valuesAt, type Cursor } from "../scope_cursors";
import { texts } from "../texts";
import { numberText } from "./number_text";
import { TextTable } from "./table";

/** While the picture stands. */
export function ScopeCursors() {
  if (!isPaused.value) return null;
  return (
    <>
      <div class="row">
        <CursorInput index={0} label={texts.cursorA} />
        <CursorInput index={1} label={texts.cursorB} />
        <span class="help">{texts.cursorsHelp}</span>
      </div>
      <Differences />
    </>
  );
}

function CursorInput({ index, label }: { index: 0 | 1; label: string }) {
  const at = cursors.value[index];
  const set = (text: string) => setCursor(index, text === "" || !Number.isFinite(Number(text)) ? null : Number(text));
  return (
    <label>
      {label}
      <input class="short" type="number" step="any" value={at ?? ""} onChange={(event) => set(event.currentTarget.value)} />
    </label>
  );
}

function Differences() {
  const [first, second] = cursors.value;
  if (first === null && second === null) return null;
  const columns = cursors.value.map((at) => (at === null ? [] : valuesAt(at)));
  const row = (name: string, a: Cursor | undefined, b: Cursor | undefined) => [name, textOf(a), textOf(b), a == null || b == null ? "" : numberText(b - a)];
  const rows = traces.value.map((trace, index) => row(`${texts.trace(trace.axis, trace.value)} (${scaleOf(trace)})`, columns[0]![index], columns[1]![index]));
  return <TextTable caption={texts.cursors} heads={[texts.value, "A", "B", "B − A"]} rows={[row(texts.time, first, second), ...rows]} />;
}

const textOf = (value: Cursor | undefined) => (value == null ? "" : numberText(value));
