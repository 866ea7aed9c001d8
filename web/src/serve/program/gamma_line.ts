// A line of γ over the path: straight between its knots, constant beyond them.
import type { GammaMap, Num } from '../../documents';
import { marginAt } from '../../decision_views';

export type Knot = [path_mm: number, gamma_deg: number];
export type GammaLine = Knot[];

/** Where knots may be. */
export interface LineBounds {
  path: [number, number]; // mm
  gamma: [number, number]; // °
}

export const most_knots = 400; // of a request
const most_drawn = 24; // of a line that is made of a map's: as many as a hand can take
const near_deg = 0.05; // how far such a line may be from the map's
const apart_mm = 0.01; // between knots

function inside(value: number, [low, high]: [number, number]): number {
  return Math.min(high, Math.max(low, value));
}

export function boundsOf({ path_mm, gamma_deg }: GammaMap): LineBounds {
  return { path: [path_mm[0] ?? 0, path_mm[path_mm.length - 1] ?? 0], gamma: [Math.min(...gamma_deg), Math.max(...gamma_deg)] };
}

export function gammaAt(line: GammaLine, path_mm: number): number {
  const next = line.findIndex(([path]) => path >= path_mm);
  if (next <= 0) return line[next < 0 ? line.length - 1 : 0]![1];
  const [[from, first], [to, second]] = [line[next - 1]!, line[next]!];
  return first + ((path_mm - from) / (to - from)) * (second - first);
}

/** The places of a map at which γ is known, in order and apart. */
function knownPlaces({ path_mm }: GammaMap, gamma: Num[], bounds: LineBounds): GammaLine {
  const known: GammaLine = [];
  path_mm.forEach((path, i) => {
    const value = gamma[i] ?? null;
    const last = known[known.length - 1]?.[0] ?? -Infinity;
    if (value !== null && path - last >= apart_mm) known.push([path, inside(value, bounds.gamma)]);
  });
  return known;
}

/** A line with few knots along a γ of the map: each knot is where the line was furthest from it. γ = 0 where none is known. */
export function lineAlong(map: GammaMap, gamma: Num[], most = most_drawn): GammaLine {
  const bounds = boundsOf(map);
  const known = knownPlaces(map, gamma, bounds);
  if (known.length === 0) return [[bounds.path[0], inside(0, bounds.gamma)]];
  let line = known.length === 1 ? known : [known[0]!, known[known.length - 1]!];
  while (line.length < most) {
    const off = known.map(([path, value]) => Math.abs(value - gammaAt(line, path)));
    const worst = Math.max(...off);
    if (worst <= near_deg) break;
    line = [...line, known[off.indexOf(worst)]!].sort(([a], [b]) => a - b);
  }
  return line;
}

export function withGamma(line: GammaLine, index: number, gamma_deg: number, { gamma }: LineBounds): GammaLine {
  return line.map((knot, i) => (i === index ? [knot[0], inside(gamma_deg, gamma)] : knot));
}

/** A knot stays between its neighbours. */
export function withPath(line: GammaLine, index: number, path_mm: number, { path }: LineBounds): GammaLine {
  const low = index === 0 ? path[0] : line[index - 1]![0] + apart_mm;
  const high = index === line.length - 1 ? path[1] : line[index + 1]![0] - apart_mm;
  if (low > high) return line;
  return line.map((knot, i) => (i === index ? [inside(path_mm, [low, high]), knot[1]] : knot));
}

/** All of it, as far as the first of its knots may go. */
export function shifted(line: GammaLine, by_deg: number, { gamma: [low, high] }: LineBounds): GammaLine {
  const all = line.map(([, gamma]) => gamma);
  const by = inside(by_deg, [low - Math.min(...all), high - Math.max(...all)]);
  return line.map(([path, gamma]) => [path, gamma + by]);
}

/** A knot more, on the line; the same line where there is one already, or no more may be. */
export function withKnot(line: GammaLine, path_mm: number, { path }: LineBounds): GammaLine {
  const at = inside(path_mm, path);
  if (line.length >= most_knots || line.some(([known]) => Math.abs(known - at) < apart_mm)) return line;
  return [...line, [at, gammaAt(line, at)] as Knot].sort(([a], [b]) => a - b);
}

/** One knot stays. */
export function withoutKnot(line: GammaLine, index: number): GammaLine {
  return line.length > 1 ? line.filter((_, i) => i !== index) : line;
}

/** In the middle of the longest stretch without a knot. */
export function widestGap(line: GammaLine, { path: [first, last] }: LineBounds): number {
  const places = [first, ...line.map(([path]) => path), last];
  const gaps = places.slice(1).map((place, i) => place - places[i]!);
  const widest = gaps.indexOf(Math.max(...gaps));
  return (places[widest]! + places[widest + 1]!) / 2;
}

export function sameLine(a: GammaLine, b: GammaLine): boolean {
  return a.length === b.length && a.every(([path, gamma], i) => path === b[i]![0] && gamma === b[i]![1]);
}

/** The line at every place of the map, and the margin there. */
export function marginsAlong(map: GammaMap, line: GammaLine): Num[] {
  return map.path_mm.map((path, i) => marginAt(map, i, gammaAt(line, path)));
}

/** The margin at every place of the map with γ as chosen; null where none was. */
export function chosenMargins(map: GammaMap): Num[] {
  return map.path_mm.map((_, i) => marginAt(map, i, map.chosen_deg[i] ?? null));
}

export interface LineMargin {
  least: Num; // null: none is known
  index: number | null; // of the map's place where it is
  unstable: number; // places below 0
  without: number; // places at which the robot cannot stand
}

export function lineMargin(margins: Num[]): LineMargin {
  let index: number | null = null;
  margins.forEach((margin, i) => {
    if (margin !== null && (index === null || margin < margins[index]!)) index = i;
  });
  return {
    least: index === null ? null : margins[index]!,
    index,
    unstable: margins.filter((margin) => margin !== null && margin < 0).length,
    without: margins.filter((margin) => margin === null).length,
  };
}

/** Where a block ends along the path: between the places of its neighbours on a map that has not every block. */
export function placeOfBlock({ block, path_mm }: Pick<GammaMap, 'block' | 'path_mm'>, number: number): number {
  const next = block.findIndex((one) => one >= number);
  if (next <= 0) return path_mm[next < 0 ? path_mm.length - 1 : 0] ?? 0;
  const share = (number - block[next - 1]!) / (block[next]! - block[next - 1]!);
  return path_mm[next - 1]! + share * (path_mm[next]! - path_mm[next - 1]!);
}

/** A line and those before it. */
export interface LineHistory {
  line: GammaLine;
  past: GammaLine[];
  gesture: string | null; // what changes it now: one step back for all of it
}

const most_past = 100;

export function changed(history: LineHistory, line: GammaLine, gesture: string): LineHistory {
  if (sameLine(line, history.line)) return history;
  const goesOn = gesture === history.gesture;
  return { line, gesture, past: goesOn ? history.past : [...history.past, history.line].slice(-most_past) };
}

export function rested(history: LineHistory): LineHistory {
  return history.gesture === null ? history : { ...history, gesture: null };
}

export function undone({ line, past }: LineHistory): LineHistory {
  return { line: past[past.length - 1] ?? line, past: past.slice(0, -1), gesture: null };
}
