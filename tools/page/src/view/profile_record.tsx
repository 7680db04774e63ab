import { useEffect, useState } from "preact/hooks";
import { axes } from "../bench";
import { endRecording, phase, recordNextMove, recording, recordingProblem } from "../profile_recording";
import { texts } from "../texts";

/** Lays what an axis really does over the pictures. */
export function ProfileRecord() {
  const [axis, setAxis] = useState("");
  useEffect(() => () => void endRecording(), []);
  const names = axes.value.map((one) => one.info.name);
  if (names.length === 0) return null;
  const chosen = names.includes(axis) ? axis : names[0]!;
  const made = recording.value;
  return (
    <div class="row">
      <label>
        {texts.axis}
        <select value={chosen} onChange={(event) => setAxis(event.currentTarget.value)}>
          {names.map((name) => (
            <option>{name}</option>
          ))}
        </select>
      </label>
      {phase.value === "" ? (
        <button onClick={() => void recordNextMove(chosen)}>{texts.recordNextMove}</button>
      ) : (
        <button onClick={() => void endRecording()}>{texts.endRecording}</button>
      )}
      {made && phase.value === "" && <button onClick={() => (recording.value = null)}>{texts.removeRecording}</button>}
      <span role="status">
        {phase.value === "waiting" && texts.waitsForMove}
        {phase.value === "recording" && texts.recordsMove}
        {phase.value === "" && made && texts.recorded(made.axis, made.times.at(-1) ?? 0)}
      </span>
      {recordingProblem.value && <p class="problem" role="alert">{recordingProblem.value}</p>}
    </div>
  );
}
