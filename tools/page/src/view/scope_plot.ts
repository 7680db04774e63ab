// Draws what the scope has recorded, at most once a frame.
import { effect } from "@preact/signals";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { forecasts, valuesOf } from "../forecast";
import { hasForecast, isPaused, rows, scaleOf, secondsOf, windowSeconds, type Trace } from "../scope";
import { addCursor, cursors } from "../scope_cursors";
import { firedAt } from "../scope_trigger";
import { texts } from "../texts";
import { colours } from "./colours";

const height = 320;
const heightOfDifferences = 140;
// Ahead of now, of what is shown.
const mostAhead = 0.3;
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

interface Ahead {
  times: number[];
  values: number[];
}

/** What a trace will do from `now` on; nothing where that is not foreseen. */
function aheadOf(trace: Trace, now: number): Ahead | null {
  const forecast = forecasts.get(trace.axis);
  const values = forecast && valuesOf(forecast, trace.value);
  if (!forecast || !values) return null;
  const begin = secondsOf(forecast.beginMs);
  const first = forecast.times.findIndex((time) => begin + time >= now);
  return first < 0 ? null : { times: forecast.times.slice(first).map((time) => begin + time), values: values.slice(first) };
}

/** Dotted, ahead of what is recorded. */
function drawAhead(plot: uPlot, traces: Trace[]): void {
  const now = rows.times[rows.times.length - 1];
  if (now === undefined) return;
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.lineWidth = 2 * devicePixelRatio;
  ctx.setLineDash([2 * devicePixelRatio, 4 * devicePixelRatio]);
  traces.forEach((trace, index) => {
    const ahead = aheadOf(trace, now);
    if (!ahead) return;
    ctx.strokeStyle = colours[index]!;
    ctx.beginPath();
    ahead.times.forEach((time, point) => ctx.lineTo(plot.valToPos(time, "x", true), plot.valToPos(ahead.values[point]!, scaleOf(trace), true)));
    ctx.stroke();
  });
  ctx.restore();
}

/** Until when the picture goes, and between which values: also what is ahead is to be seen. */
function farthest(traces: Trace[], now: number): number {
  const ends = traces.map((trace) => aheadOf(trace, now)?.times.at(-1) ?? now);
  return Math.min(Math.max(now, ...ends), now + mostAhead * windowSeconds.peek());
}

function rangeWithAhead(traces: Trace[], scale: string, least: number | null, greatest: number | null): uPlot.Range.MinMax {
  const now = rows.times[rows.times.length - 1] ?? 0;
  const until = farthest(traces, now);
  const values = traces
    .filter((trace) => scaleOf(trace) === scale)
    .flatMap((trace) => {
      const ahead = aheadOf(trace, now);
      return ahead ? ahead.values.filter((_, point) => ahead.times[point]! <= until) : [];
    });
  const all = [least, greatest, ...values].filter((one) => one !== null);
  if (all.length === 0) return [null, null];
  return uPlot.rangeNum(Math.min(...all), Math.max(...all), 0.1, true);
}

/** Until the function that it gives is called. */
export function drawScope(place: HTMLElement, traces: Trace[]): () => void {
  const colour = getComputedStyle(place).color;
  const grid = { stroke: gridColour };
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
      scales: {
        x: { time: false },
        ...Object.fromEntries(
          scales.map((scale): [string, uPlot.Scale] => [scale, { range: (_, least, greatest) => rangeWithAhead(traces, scale, least, greatest) }]),
        ),
      },
      hooks: { draw: [drawMarks, (drawn) => drawAhead(drawn, traces)] },
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
  let differences: uPlot | null = null;
  const endDifferences = effect(() => {
    if (hasForecast.value) differences ??= drawDifferences(place, traces, colour, grid);
    else if (differences) {
      differences.destroy();
      differences = null;
    }
  });
  const resize = new ResizeObserver(() => {
    plot.setSize({ width: place.clientWidth, height });
    differences?.setSize({ width: place.clientWidth, height: heightOfDifferences });
  });
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
      plot.setScale("x", { min: Math.max(last - windowSeconds.peek(), rows.times[0]!), max: farthest(traces, last) });
    });
    differences?.batch(() => {
      differences!.setData([rows.times, ...rows.differences], true);
      differences!.setScale("x", { min: plot.scales.x!.min!, max: plot.scales.x!.max! });
    });
  }
  return () => {
    cancelAnimationFrame(frame);
    endMarks();
    endDifferences();
    differences?.destroy();
    resize.disconnect();
    plot.destroy();
  };
}

/** How far traces are off what was foreseen of them, under the same times. */
function drawDifferences(place: HTMLElement, traces: Trace[], stroke: string, grid: uPlot.Axis.Grid): uPlot {
  const scales = [...new Set(traces.map(scaleOf))];
  return new uPlot(
    {
      width: place.clientWidth,
      height: heightOfDifferences,
      scales: { x: { time: false } },
      axes: [
        { stroke, grid },
        ...scales.map((scale, index) => ({ scale, label: scale, side: (index % 2 === 0 ? 3 : 1) as uPlot.Axis.Side, stroke, grid: { show: index === 0, ...grid } })),
      ],
      series: [
        { label: texts.time },
        ...traces.map((trace, index) => ({
          label: texts.offForecast(texts.trace(trace.axis, trace.value)),
          scale: scaleOf(trace),
          stroke: colours[index]!,
          width: 2,
        })),
      ],
    },
    [[], ...traces.map(() => [])],
    place,
  );
}
