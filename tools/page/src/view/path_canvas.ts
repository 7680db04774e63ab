// Draws a path in space on a canvas.
import { edgesOf, projection, type Box, type Look, type Place } from "../projection";

export interface Scene {
  box: Box;
  /** Of the axes, at the ends of the box. */
  names: string[];
  way: Place[];
  seen: Place[];
  slow: Place[];
  farthest: Place | null;
  /** Where the axes are now; null where that has no place on the path. */
  tool: Place | null;
}

const sizeOfMark = 4;
const sizeOfDot = 1.5;

/** As large as it is shown; its style has the colours: that of the border for the box, fill for what is good, stroke for what is not. */
export function drawScene(canvas: HTMLCanvasElement, scene: Scene, look: Look): void {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const context = canvas.getContext("2d");
  if (!context || width === 0 || height === 0) return;
  const ratio = window.devicePixelRatio;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  context.scale(ratio, ratio);
  const style = getComputedStyle(canvas);
  const at = projection(scene.box, look, width, height);
  const line = (places: Place[]) => {
    context.beginPath();
    for (const place of places) context.lineTo(...at(place));
    context.stroke();
  };
  const disc = (place: Place, size: number) => {
    context.beginPath();
    context.arc(...at(place), size, 0, 2 * Math.PI);
  };

  context.font = style.font;
  context.lineWidth = 1;
  context.strokeStyle = style.borderTopColor;
  for (const edge of edgesOf(scene.box)) line(edge);
  context.fillStyle = context.strokeStyle = style.color;
  scene.names.forEach((name, index) => {
    const end = scene.box.least.map((value, place) => (place === index ? scene.box.greatest[place]! : value)) as Place;
    const [x, y] = at(end);
    context.fillText(name, x + sizeOfMark, y - sizeOfMark);
  });
  context.lineWidth = 1.5;
  line(scene.way);
  const start = scene.way[0];
  if (start) {
    disc(start, sizeOfMark);
    context.stroke();
  }
  context.fillStyle = style.fill;
  for (const place of scene.seen) {
    disc(place, sizeOfDot);
    context.fill();
  }
  context.fillStyle = context.strokeStyle = style.stroke;
  for (const place of scene.slow) {
    disc(place, sizeOfMark);
    context.fill();
  }
  if (scene.farthest) {
    disc(scene.farthest, sizeOfMark * 1.5);
    context.stroke();
  }
  if (!scene.tool) return;
  context.fillStyle = style.fill;
  disc(scene.tool, sizeOfMark * 1.5);
  context.fill();
}
