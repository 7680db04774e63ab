import { useState } from "preact/hooks";
import { isPaused, traces } from "../scope";
import { arm, disarm, edges, firedAt, isWaiting, type Edge } from "../scope_trigger";
import { texts } from "../texts";
import { numberText } from "./number_text";

/** When the picture is to be held. */
export function ScopeTrigger() {
  const [index, setIndex] = useState(0);
  const [edge, setEdge] = useState<Edge>("rising");
  const [level, setLevel] = useState("0");
  const trace = traces.value[index] ?? traces.value[0];
  const value = Number(level.replace(",", "."));
  const isNumber = level.trim() !== "" && Number.isFinite(value);
  const submit = (event: Event) => {
    event.preventDefault();
    if (isWaiting.value) disarm();
    else if (trace && isNumber) arm({ trace, edge, level: value });
  };
  return (
    <form class="row" aria-label={texts.trigger} onSubmit={submit}>
      <label>
        {texts.trigger}
        <select value={index} onChange={(event) => setIndex(Number(event.currentTarget.value))}>
          {traces.value.map((one, number) => (
            <option value={number}>{texts.trace(one.axis, one.value)}</option>
          ))}
        </select>
      </label>
      <label>
        {texts.edge}
        <select value={edge} onChange={(event) => setEdge(event.currentTarget.value as Edge)}>
          {edges.map((one) => (
            <option value={one}>{texts.edges[one]}</option>
          ))}
        </select>
      </label>
      <label>
        {texts.level}
        <input class="short" inputMode="decimal" aria-invalid={!isNumber} value={level} onInput={(event) => setLevel(event.currentTarget.value)} />
      </label>
      <button disabled={!isNumber}>{isWaiting.value ? texts.disarm : texts.arm}</button>
      <span role="status">{isWaiting.value ? texts.waiting : firedAt.value !== null && texts.fired(numberText(firedAt.value), isPaused.value)}</span>
    </form>
  );
}
