import { useState } from "preact/hooks";
import { axes } from "../bench";
import { assign, assigned, busy, dryRun, fileAxes, mayRun, modes, plan, runPlan, settings, type Settings } from "../path_job";
import { texts } from "../texts";

const fields = ["tolerance", "velocity", "acceleration", "perTurn"] as const;

/** With which axes and settings a path is planned and run. */
export function PathForm() {
  const [toStart, setToStart] = useState(true);
  const change = (changes: Partial<Settings>) => (settings.value = { ...settings.value, ...changes });
  const submit = (event: Event) => {
    event.preventDefault();
    void dryRun();
  };
  return (
    <form class="row" onSubmit={submit}>
      {fileAxes.value.map((name) => (
        <AxisChoice key={name} name={name} />
      ))}
      <label>
        {texts.pathMode}
        <select value={settings.value.mode} onChange={(event) => change({ mode: event.currentTarget.value })}>
          {modes.map((mode) => (
            <option>{mode}</option>
          ))}
        </select>
      </label>
      {fields.map((field) => (
        <label>
          {texts.pathSettings[field]}
          <input size={8} value={settings.value[field]} onInput={(event) => change({ [field]: event.currentTarget.value })} />
        </label>
      ))}
      <label>
        <input
          type="checkbox"
          checked={settings.value.lenient}
          onChange={(event) => change({ lenient: event.currentTarget.checked })}
        />
        {texts.pathLenient}
      </label>
      <label>
        <input type="checkbox" checked={toStart} onChange={(event) => setToStart(event.currentTarget.checked)} />
        {texts.pathToStart}
      </label>
      <button disabled={busy.value !== ""}>{texts.dryRun}</button>
      <button type="button" disabled={busy.value !== "" || !mayRun.value} onClick={() => void runPlan(toStart)}>
        {texts.run}
      </button>
      <span class="help" role="status">
        {busy.value ? texts.pathBusy[busy.value] : !mayRun.value && texts.runHelp}
      </span>
    </form>
  );
}

function AxisChoice({ name }: { name: string }) {
  const index = fileAxes.value.indexOf(name);
  const planned = plan.value?.axes[index];
  return (
    <label>
      {texts.fileAxis(name)}
      <select value={assigned.value[name] ?? planned ?? ""} onChange={(event) => assign(name, event.currentTarget.value)}>
        <option value="">–</option>
        {axes.value.map((axis) => (
          <option>{axis.info.name}</option>
        ))}
      </select>
    </label>
  );
}
