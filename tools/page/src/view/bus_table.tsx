import { useEffect, useRef, useState } from "preact/hooks";
import { trafficBetween, type Bus, type Traffic } from "../bus_load";
import { texts } from "../texts";
import { Table } from "./table";

const counters = Object.keys(texts.counters) as (keyof Bus["counters"])[];

/** Of each bus, between the last two looks. */
export function useTraffic(buses: Bus[]): Map<string, Traffic | null> {
  const before = useRef({ at: 0, buses: [] as Bus[] });
  const [traffic, setTraffic] = useState(new Map<string, Traffic | null>());
  useEffect(() => {
    const now = { at: performance.now(), buses };
    const seconds = (now.at - before.current.at) / 1000;
    const pairs = buses.map((bus) => {
      const old = before.current.buses.find((one) => one.name === bus.name);
      return [bus.name, old ? trafficBetween(old, bus, seconds) : null] as const;
    });
    before.current = now;
    setTraffic(new Map(pairs));
  }, [buses]);
  return traffic;
}

/** Each bus with its load and its counters. */
export function BusTable({ buses, traffic }: { buses: Bus[]; traffic: Map<string, Traffic | null> }) {
  const heads = [texts.bus, texts.link, texts.state, texts.load, texts.datagramsPerS, ...counters.map((one) => texts.counters[one])];
  return (
    <>
      <Table caption={texts.buses} heads={heads}>
        {buses.map((bus) => (
          <tr key={bus.name} data-bus={bus.name}>
            <th scope="row">{bus.name}</th>
            <td>{bus.link}</td>
            <td class={bus.state === "open" ? "" : "problem"}>{texts.busStates[bus.state] ?? bus.state}</td>
            <td class="number">{loadText(traffic.get(bus.name))}</td>
            <td class="number">{traffic.get(bus.name)?.datagramsPerS.toFixed(0) ?? texts.notKnown}</td>
            {counters.map((one) => (
              <td class="number">{bus.counters[one]}</td>
            ))}
          </tr>
        ))}
      </Table>
      {buses.map((bus) => (
        <Trouble key={bus.name} bus={bus} />
      ))}
    </>
  );
}

function loadText(traffic: Traffic | null | undefined): string {
  return traffic?.load == null ? texts.notKnown : `${(100 * traffic.load).toFixed(1)} %`;
}

function Trouble({ bus }: { bus: Bus }) {
  const heard = bus.heard?.hint ? `${bus.heard.meaning}. ${bus.heard.hint}` : "";
  const lines = [bus.error ?? "", heard].filter(Boolean);
  return lines.length > 0 && <p class="problem">{`${bus.name}: ${lines.join(" · ")}`}</p>;
}
