import { useEffect, useRef, useState } from "preact/hooks";
import { axes } from "../bench";
import { forgetForecasts, isForecasting } from "../forecast";
import {
  addTrace,
  csv,
  hasForecast,
  isPaused,
  mostTraces,
  removeTrace,
  scopeProblem,
  traces,
  windows,
  windowSeconds,
} from "../scope";
import { texts } from "../texts";
import { colours } from "./colours";
import { saveFile } from "./save_file";
import { ScopeCursors } from "./scope_cursors";
import { ScopeTrigger } from "./scope_trigger";

/** Values of axes over time. */
export function Scope() {
  return (
    <section class="scope" aria-label={texts.scope}>
      <h2>{texts.scope}</h2>
      <AddTrace />
      <div class="row">
        {traces.value.map((trace, index) => {
          const name = texts.trace(trace.axis, trace.value);
          return (
            <button
              class="trace"
              style={{ borderLeftColor: colours[index] }}
              aria-label={texts.removeTrace(name)}
              onClick={() => removeTrace(trace)}
            >
              {name} ×
            </button>
          );
        })}
      </div>
      {scopeProblem.value && <p class="problem" role="alert">{scopeProblem.value}</p>}
      {traces.value.length > 0 && (
        <>
          <Controls />
          <ScopeTrigger />
          <ScopeCursors />
        </>
      )}
      {/* With the units of the axes known. */}
      {traces.value.length > 0 && axes.value.length > 0 && <Plot />}
    </section>
  );
}

function AddTrace() {
  const [axis, setAxis] = useState("");
  const [value, setValue] = useState("position");
  const names = axes.value.map((one) => one.info.name);
  const chosen = names.includes(axis) ? axis : (names[0] ?? "");
  const add = (event: Event) => {
    event.preventDefault();
    addTrace({ axis: chosen, value: value.trim() });
  };
  return (
    <form class="row" onSubmit={add}>
      <label>
        {texts.axis}
        <select value={chosen} onChange={(event) => setAxis(event.currentTarget.value)}>
          {names.map((name) => (
            <option>{name}</option>
          ))}
        </select>
      </label>
      <label>
        {texts.value}
        <input value={value} title={texts.scopeHelp} onInput={(event) => setValue(event.currentTarget.value)} />
      </label>
      <button disabled={!chosen || traces.value.length >= mostTraces}>{texts.addTrace}</button>
      <span class="help">{texts.scopeHelp}</span>
    </form>
  );
}

function Controls() {
  const forecast = (isWanted: boolean) => {
    isForecasting.value = isWanted;
    forgetForecasts();
    if (!isWanted) hasForecast.value = false;
  };
  const save = () => saveFile("scope.csv", csv(texts.time), "text/csv");
  return (
    <div class="row">
      <button onClick={() => (isPaused.value = !isPaused.value)}>{isPaused.value ? texts.resume : texts.pause}</button>
      <label>
        {texts.showLast}
        <select value={windowSeconds.value} onChange={(event) => (windowSeconds.value = Number(event.currentTarget.value))}>
          {windows.map((seconds) => (
            <option value={seconds}>
              {seconds} {texts.seconds}
            </option>
          ))}
        </select>
      </label>
      <button onClick={save}>{texts.saveCsv}</button>
      <button aria-pressed={isForecasting.value} title={texts.forecastHelp} onClick={() => forecast(!isForecasting.value)}>
        {texts.forecast}
      </button>
    </div>
  );
}

/** What draws is loaded when it is wanted. */
function Plot() {
  const place = useRef<HTMLDivElement>(null);
  const shown = traces.value;
  useEffect(() => {
    let end = () => {};
    let isGone = false;
    void import("./scope_plot").then(({ drawScope }) => {
      if (!isGone) end = drawScope(place.current!, shown);
    });
    return () => {
      isGone = true;
      end();
    };
  }, [shown]);
  return <div class="plot" ref={place} />;
}
