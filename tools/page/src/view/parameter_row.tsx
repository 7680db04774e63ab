import { useState } from "preact/hooks";
import { may } from "../access";
import { call } from "../bench";
import { isEditable, setParameter, type ParameterInfo, type Reading } from "../parameters";
import { texts } from "../texts";
import { numberText } from "./number_text";
import { useOutcome } from "./use_outcome";

interface ParameterRowOf {
  axis: string;
  info: ParameterInfo;
  reading: Reading | undefined;
  onRead: (reading: Reading) => void;
}

export function ParameterRow({ axis, info, reading, onRead }: ParameterRowOf) {
  const value = reading?.value ?? null;
  return (
    <tr data-parameter={info.name}>
      <td class="number">{info.number}</td>
      <th scope="row">{info.name}</th>
      <td>{info.meaning}</td>
      <td>{texts.rangeOf(info.minimum, info.maximum)}</td>
      <td>{info.unit}</td>
      <td>
        {may("parameter.set") && isEditable(info) ? (
          <Edit axis={axis} info={info} value={value?.value ?? null} onRead={onRead} />
        ) : (
          (value?.value ?? texts.notKnown)
        )}
        {reading?.problem && <p class="problem">{reading.problem}</p>}
      </td>
      <td>{value?.value_in_unit == null ? "" : `${numberText(value.value_in_unit)} ${value.unit}`}</td>
    </tr>
  );
}

interface EditOf extends Omit<ParameterRowOf, "reading"> {
  value: number | null;
}

/** What is typed stays until it is set, also when the value is read again. */
function Edit({ axis, info, value, onRead }: EditOf) {
  const [typed, setTyped] = useState<string | null>(null);
  const { problem, note, carryOut } = useOutcome();
  const set = async () => {
    const { warnings, ...told } = await setParameter(axis, info.number, typed ?? "");
    setTyped(null);
    onRead({ value: told, problem: "" });
    return [texts.isSet, ...warnings].join(". ");
  };
  const store = async () => {
    await call("parameter.store", { axis, parameter: info.number });
    return texts.isStored;
  };
  const submit = (event: Event) => {
    event.preventDefault();
    if (typed !== null) carryOut(set);
  };
  const problemId = `problem-${info.number}`;
  return (
    <form class="edit" onSubmit={submit}>
      <input
        inputMode="decimal"
        aria-label={texts.valueOf(info.name)}
        aria-invalid={problem !== ""}
        aria-describedby={problem ? problemId : undefined}
        value={typed ?? value ?? ""}
        onInput={(event) => setTyped(event.currentTarget.value)}
      />
      <button disabled={typed === null}>{texts.set}</button>
      {may("parameter.store") && info.stored && (
        <button type="button" aria-label={texts.storeOf(info.name)} disabled={typed !== null} onClick={() => carryOut(store)}>
          {texts.store}
        </button>
      )}
      {problem && <p class="problem" role="alert" id={problemId}>{problem}</p>}
      {note && <p role="status">{note}</p>}
    </form>
  );
}
