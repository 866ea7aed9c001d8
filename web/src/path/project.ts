// From the program's millimetres to pixels and back to a block.
import { inAir, unstable, type PathData } from './contract';

export interface Point3 {
  x: number;
  y: number;
  z: number;
}

export interface Bounds {
  low: Point3;
  high: Point3;
  centre: Point3;
  radius: number; // of the sphere around the box [mm], > 0
}

/** Around every place that is known. */
export function boundsOf({ ends }: PathData): Bounds {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < ends.length; ++i) {
    const value = ends[i]!;
    if (Number.isNaN(value)) continue;
    if (value < low[i % 3]!) low[i % 3] = value;
    if (value > high[i % 3]!) high[i % 3] = value;
  }
  const point = (values: number[]): Point3 => ({ x: values[0]!, y: values[1]!, z: values[2]! });
  if (!low.every(Number.isFinite)) return { low: point([0, 0, 0]), high: point([0, 0, 0]), centre: point([0, 0, 0]), radius: 1 };
  const centre = low.map((value, k) => (value + high[k]!) / 2);
  const radius = Math.hypot(...low.map((value, k) => high[k]! - value)) / 2;
  return { low: point(low), high: point(high), centre: point(centre), radius: radius > 0 ? radius : 1 };
}

/** Blocks that can be drawn: from where the one before ended, if both places are known. */
export function drawn({ ends, kinds }: PathData, wanted: (kind: number) => boolean): number[] {
  const known = (i: number) => !Number.isNaN(ends[3 * i]! + ends[3 * i + 1]! + ends[3 * i + 2]!);
  const out: number[] = [];
  for (let i = 1; i < kinds.length; ++i) if (wanted(kinds[i]!) && known(i - 1) && known(i)) out.push(i);
  return out;
}

export const cutting = (kind: number): boolean => kind !== inAir;
export const isUnstable = (kind: number): boolean => kind === unstable;

/** Of each block's end x and y [px] and the depth away from the eye, by a 4 × 4 matrix of an orthographic camera in columns. */
export function project(ends: Float32Array, matrix: ArrayLike<number>, width: number, height: number): Float32Array {
  const out = new Float32Array(ends.length);
  const m = (k: number) => matrix[k]!;
  for (let i = 0; i < ends.length; i += 3) {
    const [x, y, z] = [ends[i]!, ends[i + 1]!, ends[i + 2]!];
    out[i] = ((m(0) * x + m(4) * y + m(8) * z + m(12) + 1) / 2) * width;
    out[i + 1] = ((1 - (m(1) * x + m(5) * y + m(9) * z + m(13))) / 2) * height;
    out[i + 2] = m(2) * x + m(6) * y + m(10) * z + m(14);
  }
  return out;
}

/** How far a point is from a straight line between two others. */
export function distance(px: number, py: number, ax: number, ay: number, bx: number, by: number): number {
  const [dx, dy] = [bx - ax, by - ay];
  const square = dx * dx + dy * dy;
  const share = square > 0 ? Math.min(1, Math.max(0, ((px - ax) * dx + (py - ay) * dy) / square)) : 0;
  return Math.hypot(px - ax - share * dx, py - ay - share * dy);
}

const reach = 12; // px
const asNear = 2; // px: then the one nearer to the eye

/** The cutting block under a point of the screen; null where none is near. */
export function pick(places: Float32Array, blocks: number[], x: number, y: number): number | null {
  let best: number | null = null;
  let least = reach;
  for (const i of blocks) {
    const [a, b] = [3 * i - 3, 3 * i];
    const far = distance(x, y, places[a]!, places[a + 1]!, places[b]!, places[b + 1]!);
    if (far > least + asNear || far > reach) continue;
    if (best === null || far < least - asNear || places[b + 2]! < places[3 * best + 2]!) best = i;
    least = Math.min(least, far);
  }
  return best;
}

/** A length of 1, 2 or 5 times a power of ten that is no longer than this. */
export function roundLength(most: number): number {
  const decade = 10 ** Math.floor(Math.log10(most));
  return (most >= 5 * decade ? 5 : most >= 2 * decade ? 2 : 1) * decade;
}
