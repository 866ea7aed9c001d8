// What the section of a program's blocks needs, made of blocks.json.
import { keys } from '#schema/blocks';
import type { BlockColumns, BlocksDocument, Fact, Num, Regime } from './documents';
import { thinSpace, type Theme } from './figures/theme';
import { inAir, stable, unstable, type PathColours, type PathData } from './path/contract';
import { dash, fixed, significant } from './text';

export type NumberColumn = { [K in keyof BlockColumns]-?: Num[] extends NonNullable<BlockColumns[K]> ? K : never }[keyof BlockColumns];

/** A value of blocks that is shown of each, and that the path can be coloured by. */
export interface Quantity {
  key: NumberColumn | 'regime';
  name: string;
  worse: 'low' | 'high';
}

/** What blocks.json says of the key. */
export function saidOf(key: Quantity['key']) {
  return keys[`blocks.${key}`];
}

/** "Peak force (N)". */
export function headingOf(key: Quantity['key'], name: string): string {
  const { unit } = saidOf(key);
  return unit === '' ? name : `${name} (${unit})`;
}

type NumberQuantity = Quantity & { key: NumberColumn };

const margins: NumberQuantity[] = [
  { key: 'stability_margin', name: 'Stability margin', worse: 'low' },
  { key: 'gain_margin', name: 'Gain margin', worse: 'low' },
];

/** What the cut does to robot, tool and part. */
const loads: NumberQuantity[] = [
  { key: 'peak_f_n', name: 'Peak force', worse: 'high' },
  { key: 'torque_n_m', name: 'Torque', worse: 'high' },
  { key: 'power_w', name: 'Power', worse: 'high' },
  { key: 'deflection_um', name: 'Deflection', worse: 'high' },
  { key: 'joint_torque_share', name: 'Joint load, share of the drive', worse: 'high' },
  { key: 'cut_joint_torque_n_m', name: 'Joint load of the cut', worse: 'high' },
  { key: 'surface_error_um', name: 'Surface error', worse: 'high' },
  { key: 'surface_left_um', name: 'Error of the finished surface', worse: 'high' },
  { key: 'vibration_um', name: 'Forced vibration', worse: 'high' },
  { key: 'condition_number', name: 'Condition number', worse: 'high' },
];

const all: Quantity[] = [
  ...margins,
  { key: 'limit_depth_mm', name: 'Limit depth', worse: 'low' },
  { key: 'regime', name: 'Regime', worse: 'high' },
  ...loads,
];

/** Those of which some block has a value. */
export function quantitiesOf(columns: BlockColumns): Quantity[] {
  return all.filter(({ key }) => columns[key]?.some((value) => value !== null));
}

export const regimes: { regime: Regime; name: string; colour: (theme: Theme) => string }[] = [
  { regime: 'regenerative', name: 'regenerative', colour: (theme) => theme.accent },
  { regime: 'mode-coupling', name: 'mode coupling', colour: (theme) => theme.series[3]! },
  { regime: 'low-frequency', name: 'low frequency', colour: (theme) => theme.series[4]! },
  { regime: 'none', name: 'no limit found', colour: (theme) => theme.stable },
];

export function numberAt(column: Num[] | undefined, index: number): Num {
  return column?.[index] ?? null;
}

export function cuts(columns: BlockColumns, index: number): boolean {
  return numberAt(columns.axial_depth_mm, index) !== null || numberAt(columns.spectral_radius, index) !== null;
}

export function isUnstable(columns: BlockColumns, index: number): boolean {
  return (numberAt(columns.spectral_radius, index) ?? 0) >= 1;
}

export function pathData(columns: BlockColumns): PathData {
  const count = columns.block.length;
  const ends = new Float32Array(3 * count);
  const kinds = new Uint8Array(count);
  for (let i = 0; i < count; ++i) {
    ends[3 * i] = columns.x_mm[i] ?? NaN;
    ends[3 * i + 1] = columns.y_mm[i] ?? NaN;
    ends[3 * i + 2] = columns.z_mm[i] ?? NaN;
    kinds[i] = !cuts(columns, i) ? inAir : isUnstable(columns, i) ? unstable : stable;
  }
  return { ends, kinds };
}

/** Whether the blocks of two paths end at the same places; a report has them to six digits, other documents to more. */
export function samePlaces({ ends: a }: PathData, { ends: b }: PathData): boolean {
  const same = (one: number, other: number) => Object.is(one, other) || Math.abs(one - other) <= 1e-3 + 1e-5 * Math.abs(one);
  return a === b || (a.length === b.length && a.every((value, i) => same(value, b[i]!)));
}

export interface ColourRange {
  low: number;
  high: number;
  below: boolean; // some value is lower than the scale
  above: boolean;
}

/** Of the values that there are; a few that are far from all others do not stretch it. */
export function rangeOf(values: Num[]): ColourRange {
  const sorted = values.filter((value): value is number => value !== null).sort((a, b) => a - b);
  if (sorted.length === 0) return { low: 0, high: 1, below: false, above: false };
  const at = (share: number) => sorted[Math.round(share * (sorted.length - 1))]!;
  const [first, last] = [sorted[0]!, sorted[sorted.length - 1]!];
  const [few, most] = [at(0.02), at(0.98)];
  const room = most - few;
  const low = few - first > room ? few : first;
  const high = last - most > room ? most : last;
  return { low, high, below: first < low, above: last > high };
}

function parsed(hex: string): [number, number, number] {
  const at = (from: number) => parseInt(hex.slice(from, from + 2), 16);
  return [at(1), at(3), at(5)];
}

/** On straight lines between the colours of a scale; a share of 1 is what to look at first. */
export function colourAt(scale: [number, string][], share: number): [number, number, number] {
  const inside = Math.min(1, Math.max(0, share));
  const next = Math.max(1, scale.findIndex(([at]) => at >= inside));
  const [from, first] = scale[next - 1]!;
  const [to, second] = scale[next]!;
  const part = (inside - from) / (to - from);
  const [a, b] = [parsed(first), parsed(second)];
  return [0, 1, 2].map((k) => Math.round(a[k]! + part * (b[k]! - a[k]!))) as [number, number, number];
}

/** How much a value stands out. */
function shareOf(value: number, { low, high }: ColourRange, worse: Quantity['worse']): number {
  const share = high > low ? (value - low) / (high - low) : 0.5;
  return worse === 'low' ? 1 - share : share;
}

export function coloursOf(columns: BlockColumns, quantity: Quantity, theme: Theme): PathColours {
  const count = columns.block.length;
  const blocks = new Uint8Array(3 * count);
  const none = parsed(theme.unknown);
  const { key, worse } = quantity;
  if (key === 'regime') {
    const known = new Map<Regime | null, number[]>(regimes.map(({ regime, colour }) => [regime, parsed(colour(theme))]));
    for (let i = 0; i < count; ++i) blocks.set(known.get(columns.regime?.[i] ?? null) ?? none, 3 * i);
  } else {
    const values = columns[key] ?? [];
    const range = rangeOf(values);
    for (let i = 0; i < count; ++i) {
      const value = values[i] ?? null;
      blocks.set(value === null ? none : colourAt(theme.scale, shareOf(value, range, worse)), 3 * i);
    }
  }
  return { blocks, air: theme.unknown, unstable: theme.chatter, text: theme.text, panel: theme.panel };
}

/** The colour bar from its low end to its high one, as CSS. */
export function gradient(theme: Theme, worse: Quantity['worse']): string {
  const stops = theme.scale.map(([at, colour]) => ({ at: worse === 'low' ? 1 - at : at, colour })).sort((a, b) => a.at - b.at);
  return `linear-gradient(to right, ${stops.map(({ at, colour }) => `${colour} ${(100 * at).toFixed(0)}%`).join(', ')})`;
}

/** The blocks nearest to chatter, as blocks.json ranks its worst: unstable before stable, then by gain margin, then by stability margin. */
export function worstBlocks(columns: BlockColumns, count: number): number[] {
  const known = columns.block.map((_, i) => i).filter((i) => numberAt(columns.stability_margin, i) !== null);
  const rank = (i: number) => [isUnstable(columns, i) ? 0 : 1, numberAt(columns.gain_margin, i) ?? Infinity, numberAt(columns.stability_margin, i)!];
  const ranks = new Map(known.map((i) => [i, rank(i)]));
  const order = (a: number, b: number) => {
    const [one, other] = [ranks.get(a)!, ranks.get(b)!];
    const k = one.findIndex((value, place) => value !== other[place]);
    return k < 0 ? a - b : one[k]! < other[k]! ? -1 : 1;
  };
  return known.sort(order).slice(0, count);
}

function withUnit(value: Num, unit: string): string {
  return value === null ? dash : `${significant(value)}${unit === '' ? '' : `${thinSpace}${unit}`}`;
}

/** "0.91 (0.83 – 1.02)": with its 5 and 95 % quantiles where they are known. */
export function limitOf(columns: BlockColumns, index: number): string {
  const limit = numberAt(columns.limit_depth_mm, index);
  const low = numberAt(columns.limit_5_percent_mm, index);
  const high = numberAt(columns.limit_95_percent_mm, index);
  const band = low === null ? '' : ` (${significant(low)}${thinSpace}–${thinSpace}${high === null ? 'none' : significant(high)})`;
  return `${limit === null ? 'none found' : significant(limit)}${band}`;
}

/** The same, "≥" before a lower bound. */
export function boundOf(columns: BlockColumns, index: number): string {
  return `${columns.lower_bound?.[index] && numberAt(columns.limit_depth_mm, index) !== null ? `≥${thinSpace}` : ''}${limitOf(columns, index)}`;
}

export function regimeName(columns: BlockColumns, index: number): string {
  const regime = columns.regime?.[index] ?? null;
  return regimes.find((known) => known.regime === regime)?.name ?? regime ?? dash;
}

/** What is known of a block. */
export function blockFacts(columns: BlockColumns, index: number): Fact[] {
  const at = (key: NumberColumn) => withUnit(numberAt(columns[key], index), saidOf(key).unit);
  const shown = ({ key, name }: NumberQuantity): Fact => ({ label: name, value: at(key), meaning: saidOf(key).meaning });
  const place: Fact[] = [
    { label: 'Block', value: fixed(columns.block[index]!, 0) },
    { label: 'Line', value: fixed(columns.line[index] ?? null, 0) },
    { label: 'Ends at x, y, z', value: `${[columns.x_mm, columns.y_mm, columns.z_mm].map((column) => significant(numberAt(column, index))).join(', ')}${thinSpace}mm` },
  ];
  const note = columns.note?.[index] ?? null;
  const said: Fact[] = note === null ? [] : [{ label: 'Note', value: note }];
  if (!cuts(columns, index)) return [...place, { label: 'Cut', value: 'none' }, ...said];
  const bound = columns.lower_bound?.[index] ? ', a lower bound' : '';
  const facts: Fact[] = [
    { label: 'Verdict', value: isUnstable(columns, index) ? 'unstable' : 'stable' },
    { label: '|μ|', value: at('spectral_radius') },
    { label: 'Axial, radial depth', value: `${significant(numberAt(columns.axial_depth_mm, index))}, ${at('radial_depth_mm')}` },
    { label: 'Limit (5\u00a0–\u00a095\u00a0%)', value: `${limitOf(columns, index)}${thinSpace}mm${bound}` },
    ...margins.map(shown),
    { label: 'Chatter frequency', value: at('chatter_frequency_hz') },
    { label: 'Mode', value: columns.mode?.[index] ?? dash },
    { label: 'Regime', value: regimeName(columns, index) },
    { label: 'Speed', value: at('spindle_speed_rpm') },
    { label: 'Feed', value: at('feed_mm_per_min') },
    ...loads.map(shown),
  ];
  if (columns.measured_nearby?.[index] === false) said.push({ label: 'Dynamics', value: 'far from every measured posture' });
  return [...place, ...facts.filter(({ value }) => value !== dash), ...said];
}

export function programFacts({ blocks, summary }: BlocksDocument): Fact[] {
  const away = blocks.measured_nearby?.filter((near) => near === false).length ?? 0;
  const worst = worstBlocks(blocks, 1)[0];
  const facts: Fact[] = [
    { label: 'Blocks', value: fixed(summary.blocks, 0) },
    { label: 'Cut', value: fixed(summary.cutting, 0) },
    { label: 'Unstable', value: fixed(summary.unstable, 0) },
  ];
  if (worst !== undefined) {
    const gain = numberAt(blocks.gain_margin, worst);
    const left = gain === null ? `margin ${significant(blocks.stability_margin![worst]!)}` : `gain margin ${significant(gain)}`;
    facts.push({ label: 'Nearest to chatter', value: `block ${blocks.block[worst]!}, ${left}` });
  }
  if (summary.engagement_lost > 0) facts.push({ label: 'Engagement lost', value: fixed(summary.engagement_lost, 0) });
  if (away > 0) facts.push({ label: 'Far from measured postures', value: fixed(away, 0) });
  facts.push({ label: 'Different cuts looked at', value: `${fixed(summary.evaluations, 0)} in ${significant(summary.seconds)}${thinSpace}s` });
  return facts;
}

const runs = 700;

/** Indices that draw long columns like the whole ones: of each run the lowest and the highest of each, and one without a value. */
export function thinned(columns: Num[][], count: number): number[] {
  if (count <= 4 * runs) return Array.from({ length: count }, (_, i) => i);
  const keep = new Set([0, count - 1]);
  for (let run = 0; run < runs; ++run) {
    const [begin, end] = [Math.floor((run * count) / runs), Math.floor(((run + 1) * count) / runs)];
    for (const column of columns) {
      let [low, high, none] = [-1, -1, -1];
      for (let i = begin; i < end; ++i) {
        const value = column[i] ?? null;
        if (value === null) none = i;
        else {
          if (low < 0 || value < column[low]!) low = i;
          if (high < 0 || value > column[high]!) high = i;
        }
      }
      for (const i of [low, high, none]) if (i >= 0) keep.add(i);
    }
  }
  return [...keep].sort((a, b) => a - b);
}
