import { useState } from "preact/hooks";
import { may } from "../access";
import { axes } from "../bench";
import type { Chip, Register } from "../chips";
import { refusals, setOnAxis, setValue, simulations, values } from "../profiles";
import { texts } from "../texts";

/** The registers of a chip, each as a number and a slider. */
export function ChipForm({ chip, index }: { chip: Chip; index: number }) {
  const refusal = refusals.value[index];
  const warnings = simulations.value[index]?.warnings ?? [];
  return (
    <article class="card" aria-label={chip.name}>
      <h2>
        {chip.name} {chip.model !== chip.name && <small>{chip.model}</small>}
      </h2>
      {chip.registers.map((register, place) => (
        <RegisterInput
          register={register}
          value={values.value[index]![place]!}
          problem={refusal?.at === place ? refusal.text : ""}
          onInput={(text) => setValue(index, place, text)}
        />
      ))}
      {refusal?.at === "chip" && <p class="problem" role="alert">{refusal.text}</p>}
      {warnings.map((warning) => (
        <p class="problem">{warning}</p>
      ))}
      {may("parameter.set") && <SetOnAxis chip={chip} wanted={values.value[index]!} isRefused={refusal !== null} />}
    </article>
  );
}

interface RegisterInputOf {
  register: Register;
  value: string;
  problem: string;
  onInput: (text: string) => void;
}

function RegisterInput({ register, value, problem, onInput }: RegisterInputOf) {
  const { name, unit, parameter, least, most } = register;
  const take = (event: { currentTarget: HTMLInputElement }) => onInput(event.currentTarget.value);
  return (
    <div class="register">
      <label>
        {texts.registerOf(name, unit)}
        <input inputMode="numeric" title={parameter} value={value} aria-invalid={problem ? "true" : "false"} onInput={take} />
      </label>
      <input type="range" aria-label={texts.sliderOf(name)} min={least} max={most} value={value} onInput={take} />
      {problem && <p class="problem" role="alert">{problem}</p>}
    </div>
  );
}

interface SetOnAxisOf {
  chip: Chip;
  wanted: string[];
  isRefused: boolean;
}

function SetOnAxis({ chip, wanted, isRefused }: SetOnAxisOf) {
  const [axis, setAxis] = useState("");
  const [report, setReport] = useState<{ text: string; isGood: boolean } | null>(null);
  const names = axes.value.filter((one) => chip.models.includes(one.module?.model ?? "")).map((one) => one.info.name);
  if (names.length === 0) return null;
  const chosen = names.includes(axis) ? axis : names[0]!;
  const set = async () => {
    const problem = await setOnAxis(chosen, chip, wanted);
    setReport({ text: problem || texts.isSetOn(chosen), isGood: !problem });
  };
  return (
    <div class="row">
      <label>
        {texts.axis}
        <select value={chosen} onChange={(event) => setAxis(event.currentTarget.value)}>
          {names.map((name) => (
            <option>{name}</option>
          ))}
        </select>
      </label>
      <button disabled={isRefused} onClick={() => void set()}>
        {texts.setOn(chosen)}
      </button>
      {report && <p class={report.isGood ? "good" : "problem"} role="status">{report.text}</p>}
    </div>
  );
}
