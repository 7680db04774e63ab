import { useEffect, useState } from "preact/hooks";
import { call } from "../bench";
import { fits, readAll, type ParameterInfo, type Reading } from "../parameters";
import { textOf } from "../rpc";
import { texts } from "../texts";
import { ParameterRow } from "./parameter_row";
import { Table } from "./table";

/** The parameters of an axis as its module has them, to look through and to change. */
export function Parameters({ axis }: { axis: string }) {
  const [infos, setInfos] = useState<ParameterInfo[]>([]);
  const [readings, setReadings] = useState<Record<number, Reading>>({});
  const [filter, setFilter] = useState("");
  const [problem, setProblem] = useState("");
  const [round, setRound] = useState(0);
  const take = (number: number, reading: Reading) => setReadings((before) => ({ ...before, [number]: reading }));
  useEffect(() => {
    let isOver = false;
    const read = async () => {
      const { parameters } = await call("parameter.list", { axis });
      if (isOver) return;
      setInfos(parameters);
      await readAll(axis, parameters.map((one) => one.number), (number, reading) => {
        if (!isOver) take(number, reading);
        return !isOver;
      });
    };
    setProblem("");
    read().catch((error) => setProblem(textOf(error)));
    return () => void (isOver = true);
  }, [axis, round]);
  const words = filter.toLowerCase().split(/[\s,]+/).filter(Boolean);
  const heads = [texts.number, texts.parameter, texts.meaning, texts.range, texts.unit, texts.value, texts.inUnit];
  return (
    <>
      <div class="row">
        <label>
          {texts.filter}
          <input value={filter} title={texts.filterHelp} onInput={(event) => setFilter(event.currentTarget.value)} />
        </label>
        <button onClick={() => setRound(round + 1)}>{texts.readAgain}</button>
        <span class="help">{texts.parametersHelp}</span>
      </div>
      {problem && <p class="problem" role="alert">{problem}</p>}
      <Table caption={texts.parametersOf(axis)} heads={heads}>
        {infos
          .filter((info) => fits(info, words))
          .map((info) => (
            <ParameterRow key={info.number} axis={axis} info={info} reading={readings[info.number]} onRead={(reading) => take(info.number, reading)} />
          ))}
      </Table>
    </>
  );
}
