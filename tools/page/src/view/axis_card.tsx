import { useEffect, useState } from "preact/hooks";
import { may } from "../access";
import type { Axis } from "../bench";
import { texts } from "../texts";
import { AxisControls } from "./axis_controls";
import { positionOf, targetOf, velocityOf, withUnit } from "./number_text";
import { PositionBar } from "./position_bar";

/** An axis: where it is, what it does, why it stands, and what this page may do with it. */
export function AxisCard({ axis }: { axis: Axis }) {
  const name = axis.info.name;
  const state = axis.state;
  return (
    <section class="card" aria-label={name} data-axis={name}>
      <h2>
        {name} <small>{axis.info.model ?? ""}</small>
      </h2>
      <p class="position">{withUnit(axis, positionOf(axis))}</p>
      <PositionBar axis={axis} />
      {/* What comes and goes is beneath, so that no button moves away under a finger. */}
      {(may("axis.move_to") || may("axis.stop")) && <AxisControls axis={axis} />}
      {axis.problem && <p class="problem">{axis.problem}</p>}
      {state && <Badges axis={axis} />}
      <dl>
        <Fact name={texts.velocity} value={withUnit(axis, velocityOf(axis), texts.perSecond)} />
        <Fact name={texts.target} value={withUnit(axis, targetOf(axis))} />
        {axis.arrival && <Countdown to={axis.arrival.at} />}
        {state?.stop_cause && <Fact name={texts.lastStop} value={texts.stopCauses[state.stop_cause] ?? state.stop_cause} />}
        {state?.owner && <Fact name={texts.owner} value={ownerText(axis)} />}
        <Fact name={texts.deadman} value={deadmanText(axis)} />
      </dl>
    </section>
  );
}

function Fact({ name, value }: { name: string; value: string }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}

function ownerText(axis: Axis): string {
  const { owner, lease } = axis.state!;
  return lease === null ? owner! : `${owner} (${texts.lease(lease)})`;
}

function deadmanText(axis: Axis): string {
  const deadman = axis.module?.deadman ?? "unknown";
  if (typeof deadman !== "string") return texts.deadmen.measured(deadman.measured);
  return deadman === "none" ? texts.deadmen.none : texts.deadmen.unknown;
}

function Badges({ axis }: { axis: Axis }) {
  const state = axis.state!;
  return (
    <p class="badges">
      <span class={state.moving ? "moving" : ""}>{state.moving ? texts.moving : texts.standing}</span>
      <span>{state.referenced ? texts.referenced : texts.notReferenced}</span>
      {state.latched && <span class="problem">{texts.latched}</span>}
      {state.unattended && <span class="problem">{texts.unattended}</span>}
      {state.faults.map((fault) => (
        <span class="problem">{texts.faultNames[fault] ?? fault}</span>
      ))}
    </p>
  );
}

function Countdown({ to }: { to: number }) {
  const [now, setNow] = useState(performance.now());
  useEffect(() => {
    const timer = setInterval(() => setNow(performance.now()), 100);
    return () => clearInterval(timer);
  }, []);
  return <Fact name={texts.arrival} value={`${Math.max(0, (to - now) / 1000).toFixed(1)} ${texts.seconds}`} />;
}
