import { useState } from "preact/hooks";
import { may } from "../access";
import { axes, isConnected } from "../bench";
import { texts } from "../texts";
import { AxisErrors } from "./axis_errors";
import { Parameters } from "./parameters";
import { Program } from "./program";
import { Settings } from "./settings";

/** A module by one of its axes: faults, parameters, settings, and its program. */
export function Modules() {
  const [chosen, setChosen] = useState("");
  if (!may("parameter.list")) return null;
  const axis = axes.value.find((one) => one.info.name === chosen) ?? axes.value[0];
  return (
    <section class="part" aria-label={texts.tabs.modules}>
      {isConnected.value && !axis && <p class="notice">{texts.noAxes}</p>}
      {axis && (
        <label>
          {texts.axis}
          <select value={axis.info.name} onChange={(event) => setChosen(event.currentTarget.value)}>
            {axes.value.map(({ info }) => (
              <option value={info.name}>{texts.axisOfModule(info.name, info.bus, info.address, info.model ?? "")}</option>
            ))}
          </select>
        </label>
      )}
      {axis && isConnected.value && (
        <>
          <AxisErrors key={`errors ${axis.info.name}`} axis={axis.info.name} />
          <Parameters key={`parameters ${axis.info.name}`} axis={axis.info.name} />
          <Settings key={`settings ${axis.info.bus} ${axis.info.address}`} bus={axis.info.bus} address={axis.info.address} />
          <Program key={`program ${axis.info.bus} ${axis.info.address}`} bus={axis.info.bus} address={axis.info.address} model={axis.info.model} />
        </>
      )}
    </section>
  );
}
