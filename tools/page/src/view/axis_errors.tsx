import { call } from "../bench";
import { texts } from "../texts";
import { usePoll } from "./use_poll";

const lookEveryMs = 1000;

/** What the module of an axis says is wrong, in words. */
export function AxisErrors({ axis }: { axis: string }) {
  const { answer, problem } = usePoll(() => call("axis.get_errors", { axis }), lookEveryMs, [axis]);
  if (problem) return <p class="problem" role="alert">{problem}</p>;
  if (!answer) return null;
  const nameOf = (flag: string) => texts.faultNames[flag] ?? flag;
  const faults = [...answer.flags.map(nameOf), ...answer.unproven.map((flag) => texts.unproven(nameOf(flag)))];
  const facts: [string, string][] = [
    [texts.faults, faults.join(", ") || texts.none],
    [texts.closedSwitches, answer.switches.map((one) => texts.switchNames[one] ?? one).join(", ") || texts.none],
    [texts.lastStop, answer.stop_cause ? (texts.stopCauses[answer.stop_cause] ?? answer.stop_cause) : texts.notKnown],
    [texts.supply, answer.supply_volts === null ? texts.notKnown : `${answer.supply_volts} V`],
    [texts.temperature, answer.temperature_celsius === null ? texts.notKnown : `${answer.temperature_celsius} °C`],
  ];
  return (
    <section class="card" aria-label={texts.faults}>
      <dl>
        {facts.map(([name, value]) => (
          <div>
            <dt>{name}</dt>
            <dd class={name === texts.faults && faults.length > 0 ? "problem" : ""}>{value}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}
