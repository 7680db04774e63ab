import { useState } from "preact/hooks";
import { choose, file, kind, kinds, type Kind } from "../path_file";
import { busy, dryRun } from "../path_job";
import { texts } from "../texts";

/** A file is dropped here, or chosen; its path is planned at once. */
export function PathFileForm() {
  const [refusal, setRefusal] = useState("");
  const take = async (files: FileList | null | undefined) => {
    const chosen = files?.[0];
    if (!chosen || busy.value) return;
    const why = await choose(chosen);
    setRefusal(why);
    if (!why && kind.value !== "mint") await dryRun();
  };
  return (
    <div
      class="drop"
      onDragOver={(event) => event.preventDefault()}
      onDrop={(event) => {
        event.preventDefault();
        void take(event.dataTransfer?.files);
      }}
    >
      <label>
        {texts.pathFile}
        <input
          type="file"
          disabled={busy.value !== ""}
          accept=".ngc,.nc,.gcode,.tap,.csv,.txt,.mnt,.mint"
          onChange={(event) => void take(event.currentTarget.files)}
        />
      </label>
      <span class="help">{texts.dropHelp}</span>
      {refusal && <p class="problem" role="alert">{refusal}</p>}
      {file.value && (
        <div class="row">
          <strong>{file.value.name}</strong>
          <label>
            {texts.pathKind}
            <select value={kind.value} onChange={(event) => (kind.value = event.currentTarget.value as Kind)}>
              {kinds.map((one) => (
                <option value={one}>{texts.pathKinds[one]}</option>
              ))}
            </select>
          </label>
        </div>
      )}
    </div>
  );
}
