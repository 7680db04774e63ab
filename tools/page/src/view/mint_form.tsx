import { useState } from "preact/hooks";
import { axes, call } from "../bench";
import { busy, problem, runMint } from "../path_job";
import { textOf } from "../rpc";
import { texts } from "../texts";

/** The axes of a Mint program have numbers: the first that is chosen is 0. */
export function MintForm() {
  const [chosen, setChosen] = useState<string[]>([]);
  const toggle = (name: string) =>
    setChosen(chosen.includes(name) ? chosen.filter((one) => one !== name) : [...chosen, name]);
  // A stop of one of its axes ends the program, which stops the others.
  const stop = () =>
    call("axis.stop", { axis: chosen[0]! }).catch((error) => (problem.value = { text: textOf(error), lines: [] }));
  return (
    <div class="row">
      <fieldset disabled={busy.value !== ""}>
        <legend>{texts.mintAxes}</legend>
        {axes.value.map(({ info }) => (
          <label>
            <input type="checkbox" checked={chosen.includes(info.name)} onChange={() => toggle(info.name)} />
            {chosen.includes(info.name) ? texts.mintAxis(info.name, chosen.indexOf(info.name)) : info.name}
          </label>
        ))}
      </fieldset>
      <button disabled={busy.value !== "" || chosen.length === 0} onClick={() => void runMint(chosen)}>
        {texts.run}
      </button>
      {busy.value === "running" && <button onClick={() => void stop()}>{texts.stopProgram}</button>}
      <span class="help" role="status">
        {busy.value && texts.pathBusy[busy.value]}
      </span>
    </div>
  );
}
