// Draws what the scope has recorded, at most once a frame.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { isPaused, rows, scaleOf, windowSeconds, type Trace } from "../scope";
import { texts } from "../texts";
import { colours } from "./colours";

const height = 320;
const gridColour = "#8884";

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

  let frame = requestAnimationFrame(draw);
  let drawnUntil = -1;
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
    resize.disconnect();
    plot.destroy();
  };
}
