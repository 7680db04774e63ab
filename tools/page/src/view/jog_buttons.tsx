import { useEffect, useRef } from "preact/hooks";
import { may } from "../access";
import type { Axis } from "../bench";
import { distanceOfStep, keep, Press, speed, speeds, stepSize, stepSizes, type Direction } from "../jog";
import { texts } from "../texts";
import { numberText, unitOf } from "./number_text";

/** For all axes. */
export function JogSettings() {
  if (!may("axis.jog")) return null;
  return (
    <div class="jog-settings">
      <Choice label={texts.step} name="step" values={stepSizes} chosen={stepSize} textOf={String} />
      <Choice label={texts.speed} name="speed" values={speeds} chosen={speed} textOf={(value) => `${value * 100} %`} />
    </div>
  );
}

interface ChoiceOf {
  label: string;
  name: string;
  values: number[];
  chosen: { value: number };
  textOf: (value: number) => string;
}

function Choice({ label, name, values, chosen, textOf }: ChoiceOf) {
  const choose = (value: number) => {
    chosen.value = value;
    keep(name, value);
  };
  return (
    <fieldset>
      <legend>{label}</legend>
      {values.map((value) => (
        <label>
          <input type="radio" name={name} checked={chosen.value === value} onChange={() => choose(value)} />
          {textOf(value)}
        </label>
      ))}
    </fieldset>
  );
}

interface JogButtonOf {
  axis: Axis;
  direction: Direction;
  onProblem: (text: string) => void;
}

/** Tapped: a step. Held: goes on until it is released, or this page is not looked at any more. */
export function JogButton({ axis, direction, onProblem }: JogButtonOf) {
  const press = useRef<Press | null>(null);
  const begin = () => {
    press.current?.cancel();
    onProblem("");
    press.current = new Press(axis, direction, onProblem);
  };
  const release = () => {
    press.current?.release();
    press.current = null;
  };
  const cancel = () => {
    press.current?.cancel();
    press.current = null;
  };
  useEffect(() => {
    const events = ["visibilitychange", "pagehide", "blur"];
    for (const event of events) addEventListener(event, cancel);
    return () => {
      cancel();
      for (const event of events) removeEventListener(event, cancel);
    };
  }, []);
  const step = Object.values(distanceOfStep(axis, direction))[0]!;
  const amount = `${step > 0 ? "+" : "−"}${numberText(Math.abs(step))} ${unitOf(axis)}`;
  return (
    <button
      class="jog"
      aria-label={texts.jog(amount, axis.info.name)}
      onPointerDown={(event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        begin();
      }}
      onPointerUp={release}
      onPointerCancel={cancel}
      onLostPointerCapture={cancel}
      onContextMenu={(event) => event.preventDefault()}
      onKeyDown={(event) => event.key === "Enter" && !event.repeat && begin()}
      onKeyUp={(event) => event.key === "Enter" && release()}
      onBlur={cancel}
    >
      {amount}
    </button>
  );
}
