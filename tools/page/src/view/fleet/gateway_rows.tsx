import type { AxisState } from "../../fleet/messages";
import type { Gateway } from "../../fleet/fleet";
import { isOnline, presenceOf } from "../../fleet/fleet";
import { runs, stop } from "../../fleet/session";
import { texts } from "../../fleet/texts";
import { all } from "../../fleet/topics";
import { faultNames, stopCauses } from "../../texts";
import { numberText } from "../number_text";

/** Anything may be asked for: what is no word of the table stays as it is. */
const wordFor = (words: Record<string, string>, key: string) => (Object.hasOwn(words, key) ? words[key]! : key);

interface RowOf {
  gateway: Gateway;
  /** In the whole table, whose first line are the heads. */
  number: number;
}

export function GatewayRow({ gateway, number }: RowOf) {
  const presence = presenceOf(gateway);
  return (
    <tr data-row data-gateway={gateway.name} aria-rowindex={number} class="gateway">
      <th scope="row" title={gateway.name}>{gateway.name}</th>
      <td colSpan={4} class="badges">
        {isOnline(gateway) && <button aria-label={texts.stopGateway(gateway.name)} onClick={() => stop(gateway.name)}>{texts.stopOne}</button>}
        <span class={presence === "online" ? "" : "problem"}>{texts.presences[presence]}</span>
        <Confirmation gateway={gateway.name} axis="" />
      </td>
    </tr>
  );
}

export function AxisRow({ gateway, axis, number }: RowOf & { axis: string }) {
  const state = gateway.states.get(axis);
  const stoppedBy = state?.stop_cause ? wordFor(stopCauses, state.stop_cause) : "";
  return (
    <tr data-row data-axis={`${gateway.name}/${axis}`} aria-rowindex={number}>
      <th scope="row" title={axis}>{axis}</th>
      <td class="number">{state ? positionText(state) : texts.notKnown}</td>
      <td class="badges">
        <Confirmation gateway={gateway.name} axis={axis} />
        {state && <Badges state={state} />}
      </td>
      <td title={stoppedBy}>{stoppedBy}</td>
      <td title={state?.owner ?? ""}>{state?.owner ?? ""}</td>
    </tr>
  );
}

function positionText(state: AxisState): string {
  const isInUnit = state.unit !== null && state.position !== null;
  return isInUnit ? `${numberText(state.position!)} ${state.unit}` : `${state.position_microsteps} ${texts.microsteps}`;
}

function Badges({ state }: { state: AxisState }) {
  return (
    <>
      <span class={state.moving ? "moving" : ""}>{state.moving ? texts.moving : texts.standing}</span>
      {state.latched && <span class="problem">{texts.latched}</span>}
      {state.unattended && <span class="problem">{texts.unattended}</span>}
      {state.faults.map((fault) => (
        <span class="problem">{wordFor(faultNames, fault)}</span>
      ))}
      {!state.referenced && <span>{texts.noReference}</span>}
    </>
  );
}

/** What has come of the last stop for it. */
function Confirmation({ gateway, axis }: { gateway: string; axis: string }) {
  const run = runs.get(gateway) ?? runs.get(all);
  const verdict = run?.verdictOn(gateway, axis, performance.now());
  if (!verdict) return null;
  return <span class={verdict === "confirmed" ? "confirmed" : "problem"}>{texts[verdict]}</span>;
}
