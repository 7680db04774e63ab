import { useEffect, useRef, useState } from "preact/hooks";
import { passage, type Plan } from "../path_job";
import { turned, usualLook, type Place } from "../projection";
import { texts } from "../texts";
import { drawScene, type Scene } from "./path_canvas";
import { placeOnPath } from "./place_on_path";

const degreesOfKey = 5;
const degreesOfPixel = 0.5;
const keys: Record<string, [number, number]> = {
  ArrowLeft: [-degreesOfKey, 0],
  ArrowRight: [degreesOfKey, 0],
  ArrowUp: [0, degreesOfKey],
  ArrowDown: [0, -degreesOfKey],
};

/** The path in space, by the first three axes of its file; pointer and arrow keys turn it. */
export function PathInSpace({ plan }: { plan: Plan }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [look, setLook] = useState(usualLook);
  const [size, setSize] = useState(0);
  useEffect(() => {
    const resize = new ResizeObserver(() => setSize(canvas.current?.clientWidth ?? 0));
    if (canvas.current) resize.observe(canvas.current);
    return () => resize.disconnect();
  }, []);
  const scene = sceneOf(plan);
  useEffect(() => {
    if (canvas.current && scene && size > 0) drawScene(canvas.current, scene, look);
  });
  if (!scene) return null;
  const byKey = (event: KeyboardEvent) => {
    const step = keys[event.key];
    if (!step || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    setLook(turned(look, ...step));
  };
  const byPointer = (event: PointerEvent & { currentTarget: HTMLCanvasElement }) => {
    if (event.buttons === 0) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    setLook(turned(look, event.movementX * degreesOfPixel, event.movementY * degreesOfPixel));
  };
  return (
    <figure class="drawing">
      <div role="group" aria-label={texts.turnedByKeys} tabIndex={0} onKeyDown={byKey}>
        <canvas ref={canvas} role="img" aria-label={texts.inSpaceOf(scene.names)} data-turn={look.turn} data-tilt={look.tilt} onPointerMove={byPointer} />
      </div>
      <div class="row">
        <button onClick={() => setLook(usualLook)}>{texts.usualLook}</button>
      </div>
      <figcaption class="help">{texts.inSpaceHelp}</figcaption>
    </figure>
  );
}

/** Null for a plan without a curve. */
function sceneOf(plan: Plan): Scene | null {
  if (!plan.curve) return null;
  const bounds = (side: "least" | "greatest") => placeOf(plan.course.axes.map((one) => one[side]));
  const tool = plan.axes.slice(0, 3).map(placeOnPath);
  return {
    box: { least: bounds("least"), greatest: bounds("greatest") },
    names: plan.course.axes.slice(0, 3).map((one) => one.axis),
    way: plan.curve.positions.map(placeOf),
    seen: (passage.value?.seen?.positions ?? []).map(placeOf),
    slow: plan.course.slowest_corners.map((one) => placeOf(one.position)),
    farthest: passage.value?.seen && passage.value.off_path_at ? placeOf(passage.value.off_path_at) : null,
    tool: tool.every((one) => one !== null) ? placeOf(tool as number[]) : null,
  };
}

/** A path of fewer axes is flat. */
function placeOf(position: number[]): Place {
  return [position[0] ?? 0, position[1] ?? 0, position[2] ?? 0];
}
