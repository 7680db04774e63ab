import { fleet, frame, runs, status, stop, stopRefused } from "../../fleet/session";
import type { StopRun } from "../../fleet/stop_run";
import { texts } from "../../fleet/texts";
import { all } from "../../fleet/topics";

/** Of what is missing; the rest is counted. */
const mostLines = 20;

/** The space bar stops wherever the focus is: a button does not take it for a click, and a field not for a character. */
function takeSpaceBar(event: KeyboardEvent): void {
  if (event.key !== " " || status.peek().is === "form") return;
  event.preventDefault();
  event.stopPropagation();
  if (event.type === "keydown" && !event.repeat) stop(all);
}
addEventListener("keydown", takeSpaceBar, true);
addEventListener("keyup", takeSpaceBar, true);

export function StopFleet() {
  frame.value;
  return (
    <div class="stop-all">
      <button
        class="red"
        title={texts.stopAllHelp}
        // A finger that goes down stops, not one that goes up. A click comes from a screen reader, too.
        onPointerDown={() => stop(all)}
        onClick={(event) => event.detail === 0 && stop(all)}
      >
        {texts.stopAll}
      </button>
      <Objection />
      {[...runs.values()].map((run) => (
        <Report key={run.id} run={run} />
      ))}
      {runs.size === 0 && <div class="report" />}
    </div>
  );
}

/** Why no stop goes out, or none is taken. */
function Objection() {
  const now = status.value;
  const isWanted = [...runs.values()].some((run) => run.report(performance.now()).done.length === 0);
  if (now.is === "lost" && isWanted) return <p class="problem loud" role="alert">{texts.notSent(now.why)}</p>;
  return stopRefused.value === "" ? null : <p class="problem loud" role="alert">{stopRefused.value}</p>;
}

function Report({ run }: { run: StopRun }) {
  const report = run.report(performance.now());
  const missing = [...new Set(report.missing.map(({ gateway }) => gateway))].length;
  const isGood = missing === 0 && report.done.length > 0;
  const { away } = fleet.counts();
  let text = texts.stopping(report.done.length, missing);
  if (report.isOver) text = isGood ? texts.stopped(report) : texts.givenUp(missing);
  if (report.isOver && missing === 0 && !isGood) text = texts.noGateway;
  return (
    <div class="report" data-run={run.scope}>
      <p role="status" class={report.isOver ? (isGood ? "good" : "problem loud") : ""}>{texts.scopeOf(run.scope) + text}</p>
      {report.missing.length > 0 && (
        <ul class="problem missing">
          {report.missing.slice(0, mostLines).map((one) => (
            <li key={`${one.gateway}/${one.axis}`}>{texts.missing(one)}</li>
          ))}
          {report.missing.length > mostLines && <li>{texts.more(report.missing.length - mostLines)}</li>}
        </ul>
      )}
      {run.scope === all && away > 0 && <p class="problem">{texts.awayNotStopped(away)}</p>}
    </div>
  );
}
