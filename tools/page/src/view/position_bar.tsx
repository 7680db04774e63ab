import type { Axis } from "../bench";
import { limitsOf, numberText, positionOf, targetOf } from "./number_text";

const width = 1000;

/** Where the axis is between its soft limits, and where it goes; nothing for an axis without limits. */
export function PositionBar({ axis }: { axis: Axis }) {
  const limits = limitsOf(axis);
  const position = positionOf(axis);
  const target = targetOf(axis);
  if (!limits || position === null) return null;
  const [least, greatest] = limits;
  const at = (value: number) => Math.min(Math.max((value - least) / (greatest - least), 0), 1) * width;
  return (
    <div class="bar">
      <svg viewBox={`0 0 ${width} 40`} preserveAspectRatio="none" aria-hidden="true">
        <rect class="way" width={width} y="14" height="12" />
        <rect class="done" width={at(position)} y="14" height="12" />
        {target !== null && <rect class="target" x={at(target) - 3} width="6" y="6" height="28" />}
        <rect class="here" x={at(position) - 6} width="12" height="40" />
      </svg>
      <span>{numberText(least)}</span>
      <span>{numberText(greatest)}</span>
    </div>
  );
}
