import { useState } from "preact/hooks";
import { may } from "../access";
import { call, expectArrival, type Axis } from "../bench";
import { post, textOf } from "../rpc";
import { texts } from "../texts";
import { JogButton } from "./jog_buttons";
import { unitOf } from "./number_text";

const stopWithinMs = 3000;

export function AxisControls({ axis }: { axis: Axis }) {
  const [problem, setProblem] = useState("");
  const name = axis.info.name;
  const carryOut = (action: () => Promise<unknown>) => () => {
    setProblem("");
    action().catch((error) => setProblem(textOf(error)));
  };
  // A request of its own, which waits for nothing that this page does.
  const stop = carryOut(() => post("axis.stop", { axis: name }, stopWithinMs));
  const jog = { axis, onProblem: setProblem };
  return (
    <div class="controls">
      {may("axis.move_to") && <MoveForm axis={axis} carryOut={carryOut} />}
      <div class="row">
        {may("axis.jog") && <JogButton {...jog} direction={-1} />}
        <button class="red" aria-label={texts.stopAxis(name)} onPointerDown={stop} onClick={(event) => event.detail === 0 && stop()}>
          {texts.stop}
        </button>
        {may("axis.jog") && <JogButton {...jog} direction={1} />}
      </div>
      {may("axis.start_home") && (
        <div class="row">
          <button onClick={carryOut(() => call("axis.start_home", { axis: name }))}>{texts.home}</button>
          <button
            title={texts.recoverHelp}
            disabled={!axis.state?.latched}
            onClick={carryOut(() => call("axis.recover", { axis: name }))}
          >
            {texts.recover}
          </button>
        </div>
      )}
      {problem && <p class="problem" role="alert">{problem}</p>}
    </div>
  );
}

interface MoveFormOf {
  axis: Axis;
  carryOut: (action: () => Promise<unknown>) => () => void;
}

function MoveForm({ axis, carryOut }: MoveFormOf) {
  const [text, setText] = useState("");
  const name = axis.info.name;
  const move = async () => {
    const moved = await call("axis.move_to", { axis: name, ...wish(axis, text) });
    expectArrival(name, moved);
  };
  const submit = (event: Event) => {
    event.preventDefault();
    carryOut(move)();
  };
  return (
    <form class="row" onSubmit={submit}>
      <input
        inputMode="decimal"
        aria-label={texts.moveTo(name)}
        placeholder={unitOf(axis)}
        value={text}
        onInput={(event) => setText(event.currentTarget.value)}
      />
      <button>{texts.move}</button>
    </form>
  );
}

/** A number in the axis' unit; or a text with its unit, such as 2cm, which tmcld reads. */
function wish(axis: Axis, text: string): { position: number | string } | { position_microsteps: number } {
  const value = Number(text.replace(",", "."));
  const isNumber = text.trim() !== "" && Number.isFinite(value);
  if (axis.units?.unit) return { position: isNumber ? value : text.trim() };
  if (!isNumber) throw new Error(texts.noNumber);
  return { position_microsteps: Math.round(value) };
}
