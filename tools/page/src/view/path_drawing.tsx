import { useState } from "preact/hooks";
import { passage, type Plan } from "../path_job";
import { texts } from "../texts";
import { numberText } from "./number_text";
import { placeOnPath } from "./place_on_path";

const margin = 0.06;
const sizeOfMark = 0.012;

/** The path from above, or as two other axes see it; where the axes are now, and where they were seen. */
export function PathDrawing({ plan }: { plan: Plan }) {
  const names = plan.course.axes.map((one) => one.axis);
  const [across, setAcross] = useState(0);
  const [up, setUp] = useState(1);
  if (!plan.curve) return null;
  const frame = frameOf(plan, across, up);
  const at = (position: (number | null)[]) => [position[across] ?? 0, -(position[up] ?? 0)] as const;
  const tool = plan.axes.map(placeOnPath);
  const [toolX, toolY] = at(tool);
  const [startX, startY] = at(plan.curve.positions[0] ?? []);
  const mark = frame.size * sizeOfMark;
  const seen = passage.value?.seen?.positions ?? [];
  const [farthestX, farthestY] = at(passage.value?.off_path_at ?? []);
  return (
    <figure class="drawing">
      {names.length > 2 && (
        <div class="row">
          <Side label={texts.across} names={names} chosen={across} onChange={setAcross} />
          <Side label={texts.up} names={names} chosen={up} onChange={setUp} />
        </div>
      )}
      <svg viewBox={frame.viewBox} role="img" aria-label={texts.drawingOf(names[across] ?? "", names[up] ?? "")}>
        <polyline class="way" points={plan.curve.positions.map((position) => at(position).join()).join(" ")} />
        <path class="seen" d={seen.map((position) => `M${at(position).join(" ")}h0`).join("")} />
        {seen.length > 0 && <circle class="farthest" cx={farthestX} cy={farthestY} r={mark * 1.5} />}
        <circle class="start" cx={startX} cy={startY} r={mark} />
        {plan.course.slowest_corners.map((corner) => {
          const [x, y] = at(corner.position);
          return <circle class="slow" cx={x} cy={y} r={mark} />;
        })}
        {tool[across] !== null && tool[up] !== null && <circle class="tool" cx={toolX} cy={toolY} r={mark * 1.5} />}
      </svg>
      <figcaption class="help">{texts.drawingHelp}</figcaption>
    </figure>
  );
}

interface SideOf {
  label: string;
  names: string[];
  chosen: number;
  onChange: (index: number) => void;
}

function Side({ label, names, chosen, onChange }: SideOf) {
  return (
    <label>
      {label}
      <select value={chosen} onChange={(event) => onChange(Number(event.currentTarget.value))}>
        {names.map((name, index) => (
          <option value={index}>{name}</option>
        ))}
      </select>
    </label>
  );
}

function frameOf(plan: Plan, across: number, up: number): { viewBox: string; size: number } {
  const range = (index: number) => plan.course.axes[index] ?? { least: 0, greatest: 0 };
  const [x, y] = [range(across), range(up)];
  const size = Math.max(x.greatest - x.least, y.greatest - y.least) || 1;
  const edge = size * margin;
  const width = x.greatest - x.least + 2 * edge;
  const height = y.greatest - y.least + 2 * edge;
  return { viewBox: [x.least - edge, -y.greatest - edge, width, height].map(numberText).join(" "), size };
}
