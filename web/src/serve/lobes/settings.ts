// What the sliders say, what of it differs from the file or from a kept curve, and what is known of the operating point.
import type { ChartPoint, LimitRow, Num } from '../../documents';
import { general, modeName } from '../../text';
import { valueAt, type Lobes } from '../../views';
import type { Movable, Value } from '../documents';
import { nameOf } from '../files/fields';

export type Point = [spindle_speed_rpm: number, axial_depth_mm: number];

export interface Settings {
  set: Record<string, number>; // keys that were moved
  modes: number[] | null; // kept ones; null: as the file says
  point: Point | null; // not known before the first curve
}

/** What the file says. */
export interface FileValues {
  fields: Record<string, Movable>;
  modes: number[]; // kept ones
}

export const modesKey = 'dynamics.keep_modes';

export function valueOf(key: string, settings: Settings, file: FileValues): number {
  return settings.set[key] ?? file.fields[key]?.value ?? 0;
}

export function modesIn(settings: Settings, file: FileValues): number[] {
  return settings.modes ?? file.modes;
}

/** With every value in it: it stays what it is when the file changes. */
export function resolved(settings: Settings, file: FileValues): Settings {
  const set = Object.fromEntries(Object.keys(file.fields).map((key) => [key, valueOf(key, settings, file)]));
  return { ...settings, set, modes: modesIn(settings, file) };
}

/** What the server is to put in the place of the file's keys. */
export function keysOf({ set, modes }: Settings): Record<string, Value> {
  return modes === null ? set : { ...set, [modesKey]: modes };
}

/** Whether two settings have the same curves; the operating point may differ. */
export function sameCurves(a: Settings, b: Settings): boolean {
  return JSON.stringify(sorted(a)) === JSON.stringify(sorted(b));
}

function sorted(settings: Settings): [string, Value][] {
  return Object.entries(keysOf(settings)).sort(([a], [b]) => (a < b ? -1 : 1));
}

/** Points with the settings that they were evaluated with. */
export interface Evaluated {
  points: ChartPoint[];
  settings: Settings;
}

/** Those that hold with the settings as they are; of others none. */
export function pointsOf(evaluated: Evaluated | null, settings: Settings): ChartPoint[] {
  return evaluated !== null && sameCurves(evaluated.settings, settings) ? evaluated.points : [];
}

export interface Change {
  key: string;
  before: Value;
  after: Value;
}

/** What would be written into the file. */
export function changesOf(settings: Settings, file: FileValues): Change[] {
  const changes: Change[] = Object.entries(file.fields)
    .filter(([key, { value }]) => valueOf(key, settings, file) !== value)
    .map(([key, { value }]) => ({ key, before: value, after: valueOf(key, settings, file) }));
  const modes = modesIn(settings, file);
  if (String(modes) !== String(file.modes)) changes.push({ key: modesKey, before: file.modes, after: modes });
  return changes;
}

function partText(key: string, value: number): string {
  const { name, unit } = nameOf(key);
  return `${name.toLowerCase()} ${general(value, 4)}${unit ? ` ${unit.symbol}` : ''}`;
}

/** What tells two settings apart, in the words of each. */
export function differences(a: Settings, b: Settings, file: FileValues): [string, string] {
  const keys = Object.keys(file.fields).filter((key) => valueOf(key, a, file) !== valueOf(key, b, file));
  const words = (settings: Settings) => {
    const parts = keys.map((key) => partText(key, valueOf(key, settings, file)));
    if (String(modesIn(a, file)) !== String(modesIn(b, file))) parts.push(`modes ${modesIn(settings, file).join(', ')}`);
    return parts.length === 0 ? 'same settings' : parts.join(', ');
  };
  return [words(a), words(b)];
}

export interface Ranges {
  speed: [number, number]; // rpm
  depth: [number, number]; // mm
}

export function rangesOf(lobes: Lobes): Ranges {
  const speeds = lobes.spindle_speed_rpm;
  return { speed: [speeds[0] ?? 0, speeds[speeds.length - 1] ?? 1], depth: [0, lobes.searched_depth_mm ?? 1] };
}

/** Inside the ranges, in steps that a person would choose. */
export function placed([speed, depth]: Point, { speed: speeds, depth: depths }: Ranges): Point {
  const inside = (value: number, [low, high]: [number, number], step: number) =>
    Number(Math.min(high, Math.max(low, Math.round(value / step) * step)).toPrecision(10));
  return [inside(speed, speeds, 1), inside(depth, depths, stepOf(depths))];
}

/** A thousandth of a range or less, of 1, 2 or 5 times a power of ten. */
export function stepOf([low, high]: [number, number]): number {
  const most = (high - low) / 1000;
  const power = 10 ** Math.floor(Math.log10(most));
  return Number((power * ([5, 2].find((head) => head * power <= most) ?? 1)).toPrecision(1));
}

/** In the middle, at half of the limit there. */
export function firstPoint(lobes: Lobes): Point {
  const { speed, depth } = rangesOf(lobes);
  const middle = (speed[0] + speed[1]) / 2;
  const limit = valueAt(lobes.spindle_speed_rpm, lobes.limit_mm, middle) ?? depth[1];
  return placed([middle, limit / 2], { speed, depth });
}

/** What is known of the operating point. */
export interface PointFacts {
  stable: boolean;
  evaluated: boolean; // this very point; else read off the curve
  limit_mm: Num; // null: none up to the searched depth
  searched_mm: Num;
  margin: Num; // 1 - depth/limit
  frequency_hz: Num; // at which it chatters, or would above the limit
  mode: string;
}

function nearest(rows: LimitRow[], speed: number): LimitRow | undefined {
  const away = (row: LimitRow) => Math.abs(row.spindle_speed_rpm - speed);
  return rows.filter((row) => row.axial_depth_mm !== null && row.chatter_frequency_hz != null).reduce<LimitRow | undefined>((best, row) => (best && away(best) <= away(row) ? best : row), undefined);
}

export function pointFacts([speed, depth]: Point, lobes: Lobes, limit: LimitRow[], points: ChartPoint[]): PointFacts {
  const here = points.find((point) => isHere(point.spindle_speed_rpm, speed) && isHere(point.axial_depth_mm, depth));
  const limit_mm = here?.limit_depth_mm === undefined ? valueAt(lobes.spindle_speed_rpm, lobes.limit_mm, speed) : here.limit_depth_mm;
  const stable = here?.stable ?? (limit_mm === null || depth < limit_mm);
  const chatters = !stable && here?.dominant_frequency_hz != null;
  const next = chatters ? undefined : nearest(limit, speed);
  return {
    stable,
    evaluated: here !== undefined,
    limit_mm,
    searched_mm: lobes.searched_depth_mm,
    margin: here?.margin ?? (limit_mm === null || limit_mm === 0 ? null : 1 - depth / limit_mm),
    frequency_hz: (chatters ? here.dominant_frequency_hz : next?.chatter_frequency_hz) ?? null,
    mode: modeName(chatters ? here : next),
  };
}

/** Whether a number that came back is the one that was asked for. */
export function isHere(number: Num | undefined, asked: number): boolean {
  return number != null && Math.abs(number - asked) < 1e-6 * Math.max(1, Math.abs(asked));
}
