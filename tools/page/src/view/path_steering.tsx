import { useState } from "preact/hooks";
import { may } from "../access";
import { call } from "../bench";
import type { PathStatus } from "../path_status";
import { textOf } from "../rpc";
import { texts } from "../texts";
import { numberText } from "./number_text";

/** A path that is passed: how far it is, and what holds, slows down or ends it. */
export function PathSteering({ path }: { path: PathStatus }) {
  const [problem, setProblem] = useState("");
  const { axes } = path;
  const carryOut = (action: Promise<unknown>) => {
    setProblem("");
    action.catch((error) => setProblem(textOf(error)));
  };
  const name = path.name ?? axes.join(", ");
  return (
    <article class="card" aria-label={texts.pathOf(name)}>
      <h2>{name}</h2>
      <progress value={path.done} aria-label={texts.pathDone} />
      <dl>
        <Row name={texts.pathPhase} value={phaseOf(path)} />
        <Row name={texts.pathTime} value={texts.timeOf(numberText(path.passed_s), numberText(path.duration_s))} />
        {path.left_s !== null && <Row name={texts.pathLeft} value={`${numberText(path.left_s)} ${texts.seconds}`} />}
        {path.line !== null && <Row name={texts.pathLine} value={String(path.line)} />}
        <Row name={texts.pathFeed} value={texts.feedOf(numberText(path.feed), Math.round(path.factor_now * 100))} />
        <Row name={texts.pathDeviation} value={numberText(path.off_path)} />
      </dl>
      <div class="row">
        {may("path.feed") && (
          <button onClick={() => carryOut(call("path.feed", { axes, hold: !path.held }))}>
            {path.held ? texts.resumePath : texts.holdPath}
          </button>
        )}
        {may("path.stop") && <button onClick={() => carryOut(call("path.stop", { axes }))}>{texts.stopPath}</button>}
      </div>
      {may("path.feed") && path.mode !== "position" && (
        <Override path={path} onChange={(factor) => carryOut(call("path.feed", { axes, factor }))} />
      )}
      {problem && <p class="problem" role="alert">{problem}</p>}
    </article>
  );
}

function phaseOf(path: PathStatus): string {
  if (path.waits_at_line !== null) return texts.pathWaits(path.waits_at_line);
  return path.held ? texts.pathHeld : path.phase;
}

function Row({ name, value }: { name: string; value: string }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}

/** While it is dragged it shows where it is dragged to; tmcld is told once, when it is let go. */
function Override({ path, onChange }: { path: PathStatus; onChange: (factor: number) => void }) {
  const [dragged, setDragged] = useState<number | null>(null);
  const percent = dragged ?? Math.round(path.factor * 100);
  return (
    <label class="override">
      {texts.override(percent)}
      <input
        type="range"
        min="10"
        max="200"
        step="5"
        value={percent}
        onInput={(event) => setDragged(Number(event.currentTarget.value))}
        onChange={(event) => {
          setDragged(null);
          onChange(Number(event.currentTarget.value) / 100);
        }}
      />
    </label>
  );
}
