import { useEffect } from "preact/hooks";
import { may } from "../access";
import { chips } from "../chips";
import { distance, refusals, simulations, watchInputs } from "../profiles";
import { texts } from "../texts";
import { ChipForm } from "./chip_form";
import { numberText } from "./number_text";
import { ProfilePlots } from "./profile_plots";
import { ProfileRecord } from "./profile_record";
import { TextTable } from "./table";

/** The same move with each ramp generator; no module is needed for that. */
export function Profiles() {
  useEffect(watchInputs, []);
  const refused = refusals.value.find((one) => one?.at === "distance");
  return (
    <section class="profiles" aria-label={texts.tabs.profiles}>
      <p class="help">{texts.profilesHelp}</p>
      <label>
        {texts.distance}
        <input
          inputMode="numeric"
          value={distance.value}
          aria-invalid={refused ? "true" : "false"}
          onInput={(event) => (distance.value = event.currentTarget.value)}
        />
        {refused && <span class="problem" role="alert">{refused.text}</span>}
      </label>
      <div class="cards">
        {chips.map((chip, index) => (
          <ChipForm key={chip.name} chip={chip} index={index} />
        ))}
      </div>
      {may("subscribe") && <ProfileRecord />}
      <ProfilePlots />
      <Results />
    </section>
  );
}

function Results() {
  const of = (text: (made: NonNullable<(typeof simulations.value)[number]>) => string) =>
    simulations.value.map((made) => (made ? text(made) : "–"));
  const orNone = (value: number | null) => (value === null ? texts.neverArrives : numberText(value));
  return (
    <TextTable
      caption={texts.results}
      heads={[texts.value, ...chips.map((chip) => chip.name)]}
      rows={[
        [texts.moduleOf, ...chips.map((chip) => (chip.models.length > 0 ? chip.model : texts.inNoModule))],
        [texts.moveTime, ...of((made) => orNone(made.move_s))],
        [texts.topSpeedPps, ...of((made) => numberText(made.top_speed_pps))],
        [texts.topAcceleration, ...of((made) => numberText(Math.max(0, ...(made.curve?.accelerations_pps2 ?? []))))],
        [texts.longestPhase, ...of((made) => numberText(made.longest_phase_s))],
      ]}
    />
  );
}
