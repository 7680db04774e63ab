import { axes } from "../bench";
import type { Plan } from "../path_job";
import { texts } from "../texts";
import { numberText, positionOf, unitOf } from "./number_text";
import { TextTable } from "./table";

/** What the plan says in numbers. */
export function PathTables({ plan }: { plan: Plan }) {
  const { course, expected, warnings } = plan;
  return (
    <>
      <p>{texts.courseOf(numberText(course.length), numberText(course.duration_s), course.legs)}</p>
      {warnings.map((warning) => (
        <p class="problem">{warning}</p>
      ))}
      <TextTable
        caption={texts.pathBounds}
        heads={[texts.fileAxisHead, texts.axis, texts.least, texts.greatest, texts.topSpeed, texts.now]}
        rows={course.axes.map((one, index) => [
          one.axis,
          plan.axes[index] ?? "",
          numberText(one.least),
          numberText(one.greatest),
          numberText(one.top_speed),
          nowOf(plan.axes[index] ?? ""),
        ])}
      />
      {course.slowest_corners.length > 0 && (
        <TextTable
          caption={texts.slowestCorners}
          heads={[texts.pathLine, texts.time, texts.pathFeed, texts.position]}
          rows={course.slowest_corners.map((one) => [
            String(one.line),
            numberText(one.time_s),
            numberText(one.speed),
            one.position.map(numberText).join("; "),
          ])}
        />
      )}
      {course.words.length > 0 && (
        <TextTable
          caption={texts.pathWords}
          heads={[texts.word, texts.switches, texts.times, texts.firstLine]}
          rows={course.words.map((one) => [`M${one.number}`, one.switches, String(one.times), String(one.line)])}
        />
      )}
      {course.waits > 0 && <p>{texts.pathWaitsAtM0(course.waits)}</p>}
      {expected.length > 0 && (
        <TextTable
          caption={texts.expected}
          heads={[texts.pathMode, texts.pathDeviation, texts.lag, texts.keepsTolerance]}
          rows={expected.map((one) => [
            one.mode,
            one.refused === null ? numberText(one.off_path) : "–",
            one.refused === null ? numberText(one.lag_s) : "–",
            one.refused ?? (one.keeps_tolerance ? texts.yes : texts.no),
          ])}
        />
      )}
    </>
  );
}

function nowOf(name: string): string {
  const axis = axes.value.find((one) => one.info.name === name);
  const position = axis ? positionOf(axis) : null;
  return axis && position !== null ? `${numberText(position)} ${unitOf(axis)}` : "–";
}
