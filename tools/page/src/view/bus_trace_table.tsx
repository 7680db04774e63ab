import { useState } from "preact/hooks";
import { filtered, type Trace } from "../bus_trace";
import { texts } from "../texts";
import { Table } from "./table";

const mostRows = 500;

interface BusTraceOf {
  names: string[];
  bus: string;
  choose: (name: string) => void;
  trace: Trace;
  isPaused: boolean;
  setPaused: (isPaused: boolean) => void;
}

/** What went over one bus, the newest first. */
export function BusTrace({ names, bus, choose, trace, isPaused, setPaused }: BusTraceOf) {
  const [filter, setFilter] = useState("");
  const rows = filtered(trace, filter, mostRows);
  const heads = [texts.number, texts.timeUtc, texts.direction, texts.meaning, texts.client, texts.bytes];
  return (
    <>
      <div class="row">
        <label>
          {texts.bus}
          <select value={bus} onChange={(event) => choose(event.currentTarget.value)}>
            {names.map((name) => (
              <option>{name}</option>
            ))}
          </select>
        </label>
        <label>
          {texts.filter}
          <input value={filter} title={texts.filterHelp} onInput={(event) => setFilter(event.currentTarget.value)} />
        </label>
        <button onClick={() => setPaused(!isPaused)}>{isPaused ? texts.resume : texts.pause}</button>
        <span class="help">{texts.traceHelp(mostRows)}</span>
      </div>
      {trace.problem && <p class="problem">{trace.problem}</p>}
      {trace.missed > 0 && <p class="problem">{texts.missed(trace.missed)}</p>}
      <Table caption={texts.traceOf(bus)} heads={heads}>
        {rows.map((one) => (
          <tr key={one.number}>
            <td class="number">{one.number}</td>
            <td>{one.time}</td>
            <td>{texts.directions[one.direction] ?? one.direction}</td>
            <td>{one.meaning}</td>
            <td>{one.client ?? texts.daemonItself}</td>
            <td class="bytes">{one.bytes}</td>
          </tr>
        ))}
      </Table>
    </>
  );
}
