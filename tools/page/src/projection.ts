// From places in space to places on the screen: seen from far away, without perspective.

export type Place = [number, number, number];

export interface Box {
  least: Place;
  greatest: Place;
}

/** Angles in degrees: how far it is turned about the third axis, and how far one looks down on it; 90 is from above. */
export interface Look {
  turn: number;
  tilt: number;
}

export const usualLook: Look = { turn: -30, tilt: 30 };

const steepest = 90;
const margin = 0.88;

/** From above at most, and from below. */
export function turned({ turn, tilt }: Look, byTurn: number, byTilt: number): Look {
  return { turn: (turn + byTurn) % 360, tilt: Math.min(steepest, Math.max(-steepest, tilt + byTilt)) };
}

/** Into a picture of this size, in whose middle the box stays however it is turned. */
export function projection({ least, greatest }: Box, { turn, tilt }: Look, width: number, height: number): (place: Place) => [number, number] {
  const middle = least.map((value, index) => (value + greatest[index]!) / 2);
  const radius = Math.hypot(...least.map((value, index) => (greatest[index]! - value) / 2)) || 1;
  const scale = (Math.min(width, height) / 2 / radius) * margin;
  const [sinTurn, cosTurn] = [Math.sin((turn * Math.PI) / 180), Math.cos((turn * Math.PI) / 180)];
  const [sinTilt, cosTilt] = [Math.sin((tilt * Math.PI) / 180), Math.cos((tilt * Math.PI) / 180)];
  return (place) => {
    const [x, y, z] = place.map((value, index) => value - middle[index]!) as Place;
    const right = x * cosTurn - y * sinTurn;
    const away = x * sinTurn + y * cosTurn;
    const up = away * sinTilt + z * cosTilt;
    return [width / 2 + scale * right, height / 2 - scale * up];
  };
}

/** The twelve edges of a box, each from one corner to another. */
export function edgesOf({ least, greatest }: Box): [Place, Place][] {
  const corner = (bits: number) => least.map((value, index) => (bits & (1 << index) ? greatest[index]! : value)) as Place;
  const edges: [Place, Place][] = [];
  for (let bits = 0; bits < 8; ++bits)
    for (let index = 0; index < 3; ++index) if (!(bits & (1 << index))) edges.push([corner(bits), corner(bits | (1 << index))]);
  return edges;
}
