import { access } from "../access";
import { stopAll, stopReport } from "../stop_all";
import { texts } from "../texts";

export function StopAll() {
  const now = access.value;
  return (
    <div class="stop-all">
      <button
        class="red"
        title={texts.stopAllHelp}
        disabled={now.is !== "in"}
        // A finger that goes down stops, not one that goes up. A click comes from a screen reader, too.
        onPointerDown={() => void stopAll()}
        onClick={(event) => event.detail === 0 && void stopAll()}
      >
        {texts.stopAll}
      </button>
      {now.is === "ended" ? <p class="problem" role="alert">{texts.ended(now.why)}</p> : <Report />}
    </div>
  );
}

function Report() {
  const report = stopReport.value;
  if (!report) return <div role="status" class="report" />;
  const isGood = report.braking.length === 0 && report.failed.length === 0;
  return (
    <div role="status" class="report">
      {!report.isOver && isGood && <p>{texts.stopping}</p>}
      {!report.isOver && report.braking.length > 0 && <p>{texts.braking(report.braking)}</p>}
      {report.isOver && report.braking.length > 0 && <p class="problem">{texts.stillMoves(report.braking)}</p>}
      {report.failed.map((one) => (
        <p class="problem">{texts.notStopped(one.axis, one.why)}</p>
      ))}
      {report.isOver && isGood && <p class="good">{texts.allStand(report.stand)}</p>}
    </div>
  );
}
