import { useEffect, useState } from "preact/hooks";
import { may } from "../access";
import { call, isConnected } from "../bench";
import { noTrace, watchBus, type Trace } from "../bus_trace";
import type { Answer } from "../rpc";
import { texts } from "../texts";
import { BusClients } from "./bus_clients";
import { BusConnected } from "./bus_connected";
import { BusTable, useTraffic } from "./bus_table";
import { BusTrace } from "./bus_trace_table";
import { Findings } from "./findings";
import { usePoll } from "./use_poll";

const lookEveryMs = 1000;
const noBuses: Answer<"bus.list">["buses"] = [];

/** What goes over the buses, and for whom. */
export function Bus() {
  return may("bus.list") && <Buses />;
}

function Buses() {
  const isOpen = isConnected.value;
  const { answer, problem } = usePoll(() => call("bus.list", {}), lookEveryMs, [isOpen]);
  const buses = answer?.buses ?? noBuses;
  const traffic = useTraffic(buses);
  const [chosen, setChosen] = useState("");
  const [isPaused, setPaused] = useState(false);
  const bus = buses.some((one) => one.name === chosen) ? chosen : (buses[0]?.name ?? "");
  const trace = useTrace(bus, isPaused, isOpen);
  return (
    <section class="part" aria-label={texts.tabs.bus}>
      {isOpen && problem && <p class="problem" role="alert">{problem}</p>}
      <BusTable buses={buses} traffic={traffic} />
      <BusTrace names={buses.map((one) => one.name)} bus={bus} choose={setChosen} trace={trace} isPaused={isPaused} setPaused={setPaused} />
      <BusClients bus={bus} trace={trace} />
      <BusConnected />
      <Findings />
    </section>
  );
}

function useTrace(bus: string, isPaused: boolean, isOpen: boolean): Trace {
  const [told, setTold] = useState({ bus, trace: noTrace });
  const trace = told.bus === bus ? told.trace : noTrace;
  useEffect(() => {
    if (bus && !isPaused && isOpen) return watchBus(bus, trace, (next) => setTold({ bus, trace: next }));
  }, [bus, isPaused, isOpen]);
  return trace;
}
