// Draws what the scope has recorded, at most once a frame.
import { effect } from "@preact/signals";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { isPaused, rows, scaleOf, windowSeconds, type Trace } from "../scope";
import { addCursor, cursors } from "../scope_cursors";
import { firedAt } from "../scope_trigger";
import { texts } from "../texts";
import { colours } from "./colours";

const height = 320;
const gridColour = "#8884";
const markColour = "#888";

/** Across the picture, at these times. */
function drawMarks(plot: uPlot): void {
  const { ctx, bbox } = plot;
  const marks: [string, number | null][] = [["A", cursors.peek()[0]], ["B", cursors.peek()[1]], ["", firedAt.peek()]];
  ctx.save();
  ctx.strokeStyle = ctx.fillStyle = markColour;
  ctx.setLineDash([6, 4]);
  for (const [name, at] of marks) {
    if (at === null) continue;
    const x = plot.valToPos(at, "x", true);
    if (x < bbox.left || x > bbox.left + bbox.width) continue;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.fillText(name, x + 4, bbox.top + 12);
  }
  ctx.restore();
}

/** Until the function that it gives is called. */
export function drawScope(place: HTMLElement, traces: Trace[]): () => void {
  const colour = getComputedStyle(place).color;
  const scales = [...new Set(traces.map(scaleOf))];
  const axisOf = (scale: string, index: number): uPlot.Axis => ({
    scale,
    label: scale,
    side: index % 2 === 0 ? 3 : 1,
    stroke: colour,
    grid: { show: index === 0, stroke: gridColour },
  });
  const plot = new uPlot(
    {
      width: place.clientWidth,
      height,
      scales: { x: { time: false } },
      hooks: { draw: [drawMarks] },
      axes: [{ label: texts.time, stroke: colour, grid: { stroke: gridColour } }, ...scales.map(axisOf)],
      series: [
        { label: texts.time },
        ...traces.map((trace, index) => ({
          label: texts.trace(trace.axis, trace.value),
          scale: scaleOf(trace),
          stroke: colours[index]!,
          width: 2,
        })),
      ],
    },
    [[], ...traces.map(() => [])],
    place,
  );
  const resize = new ResizeObserver(() => plot.setSize({ width: place.clientWidth, height }));
  resize.observe(place);

  plot.over.addEventListener("click", () => {
    const { left } = plot.cursor;
    if (isPaused.peek() && left !== undefined && left >= 0) addCursor(plot.posToVal(left, "x"));
  });

  let frame = requestAnimationFrame(draw);
  let drawnUntil = -1;
  const endMarks = effect(() => {
    void [cursors.value, firedAt.value];
    if (drawnUntil >= 0) plot.redraw(false);
  });
  function draw(): void {
    frame = requestAnimationFrame(draw);
    const last = rows.times[rows.times.length - 1];
    // While it is paused a person may have zoomed.
    if (last === undefined || isPaused.peek() || last === drawnUntil) return;
    drawnUntil = last;
    plot.batch(() => {
      plot.setData([rows.times, ...rows.columns], true);
      plot.setScale("x", { min: Math.max(last - windowSeconds.peek(), rows.times[0]!), max: last });
    });
  }
  return () => {
    cancelAnimationFrame(frame);
    endMarks();
    resize.disconnect();
    plot.destroy();
  };
}
