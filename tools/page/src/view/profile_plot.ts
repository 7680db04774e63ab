// Draws what the chips make of a move, over time, with the values of all chips in one picture.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { chips } from "../chips";
import type { Recording } from "../profile_recording";
import type { Simulation } from "../profiles";
import { texts } from "../texts";
import { colours } from "./colours";

const height = 220;
const axisWidth = 90;
const gridColour = "#8884";

type Curve = NonNullable<Simulation["curve"]>;
/** No module tells its acceleration. */
const pictures: [string, (curve: Curve) => number[], (made: Recording) => (number | null)[]][] = [
  [texts.positionIn, (curve) => curve.positions_microsteps, (made) => made.positions],
  [texts.velocityIn, (curve) => curve.velocities_pps, (made) => made.velocities],
  [texts.accelerationIn, (curve) => curve.accelerations_pps2, (made) => made.times.map(() => null)],
];

/** Until the function that it gives is called. */
export function drawProfiles(place: HTMLElement, simulations: (Simulation | null)[], recorded: Recording | null): () => void {
  const plots = pictures.map(([label, valuesOf, recordedOf]) => {
    const tables = simulations.map((one): uPlot.AlignedData => (one?.curve ? [one.curve.times_s, valuesOf(one.curve)] : [[], []]));
    if (recorded) tables.push([recorded.times, recordedOf(recorded)]);
    return new uPlot(optionsOf(label, recorded?.axis ?? null, place), uPlot.join(tables), place);
  });
  const resize = new ResizeObserver(() => {
    for (const plot of plots) plot.setSize({ width: place.clientWidth, height });
  });
  resize.observe(place);
  return () => {
    resize.disconnect();
    for (const plot of plots) plot.destroy();
  };
}

function optionsOf(label: string, recordedAxis: string | null, place: HTMLElement): uPlot.Options {
  const stroke = getComputedStyle(place).color;
  const grid = { stroke: gridColour };
  return {
    width: place.clientWidth,
    height,
    scales: { x: { time: false } },
    axes: [
      { label: texts.time, stroke, grid },
      { label, stroke, grid, size: axisWidth },
    ],
    // Each chip has times of its own: what lies between them is drawn on.
    series: [
      { label: texts.time },
      ...chips.map((chip, index) => ({ label: chip.name, stroke: colours[index]!, width: 2, spanGaps: true })),
      ...(recordedAxis === null ? [] : [{ label: recordedAxis, stroke, width: 2, dash: [6, 4], spanGaps: true }]),
    ],
  };
}
