// What tables and plots need of a study: its statistics, and its points.
import type { Num, ProbabilityResult, ProbabilityRow, SensitivityRow, Settled, StudyColumn, StudyPoints } from './documents';
import { percent, significant } from './text';

/** "cut.radial_depth_mm"; "limit@8000 (mm)": the unit where the name does not end with it. */
export function columnTitle({ name, unit }: Pick<StudyColumn, 'name' | 'unit'>): string {
  const suffix = `_${unit.toLowerCase().replace(/\//g, '_per_').replace(/ /g, '_').replace(/\^/g, '')}`;
  return unit === '' || unit === '1' || name.endsWith(suffix) ? name : `${name} (${unit})`;
}

/** The end of each dotted name that no other one has: "damping_ratio" of "dynamics.x[0].damping_ratio". */
export function shortNames(names: string[]): string[] {
  return names.map((name) => {
    const parts = name.split('.');
    for (let count = 1; count < parts.length; ++count) {
      const end = parts.slice(-count).join('.');
      if (names.every((other) => other === name || !`.${other}`.endsWith(`.${end}`))) return end;
    }
    return name;
  });
}

/** A text without its quotes, unless it would be read as a list; any other value as TOML writes it. */
function unquoted(value: string): string {
  return value.replace(/^"(?!\[)(.*)"$/, '$1');
}

/** "tool.teeth = 2, cut.radial_depth_mm = 6"; empty of none. */
export function settledText(at: Settled, keys: string[] = Object.keys(at)): string {
  return keys.map((key) => `${key} = ${unquoted(at[key] ?? '')}`).join(', ');
}

/** "limit@8000 at tool.teeth = 2". */
export function rowName({ value, at }: { value: string; at: Settled }): string {
  const where = settledText(at);
  return where === '' ? value : `${value} at ${where}`;
}

/** "0.562 (0.441 to 0.677)". */
export function estimateText({ value, low, high }: { value: Num; low: Num; high: Num }): string {
  return value === null ? significant(null) : `${value.toFixed(3)} (${low?.toFixed(3) ?? '?'} to ${high?.toFixed(3) ?? '?'})`;
}

/** Why a value has no indices; empty: it has. */
export function statusText({ status }: SensitivityRow): string {
  return status === 'constant' ? 'does not vary: no key matters' : status === 'too_few' ? 'too few samples have a value' : '';
}

/** "limit@8000 at tool.teeth = 2: 3 of 64 samples", a text a row that left samples out. */
export function leftOutTexts(rows: { value: string; at: Settled; left_out: number; of: number }[]): string[] {
  return rows.filter(({ left_out: left }) => left > 0).map((row) => `${rowName(row)}: ${row.left_out} of ${row.of} samples`);
}

/** Probabilities as a map: values across, combinations of the other keys down. */
export interface ProbabilityMap {
  values: string[];
  keys: string[]; // that vary between combinations
  fixed: string; // the other keys, as "cut.radial_depth_mm = 6"
  combinations: string[]; // "2", "2, 6": what those keys are set to
  rows: (ProbabilityRow | null)[][]; // a list a combination
  optimum: [across: number, down: number] | null;
}

export function probabilityMap({ rows, optimum }: ProbabilityResult): ProbabilityMap {
  const values = [...new Set(rows.map(({ value }) => value))];
  const all = Object.keys(rows[0]?.at ?? {});
  const keys = all.filter((key) => rows.some(({ at }) => at[key] !== rows[0]!.at[key]));
  const fixed = rows.length === 0 ? '' : settledText(rows[0]!.at, all.filter((key) => !keys.includes(key)));
  const settings = ({ at }: ProbabilityRow) => keys.map((key) => at[key] ?? '');
  const placeOf = (row: ProbabilityRow) => settings(row).join(', '); // in quotes: the text "2" is not the number 2
  const places = new Map<string, { name: string; cells: (ProbabilityRow | null)[] }>();
  for (const row of rows) {
    const place = placeOf(row);
    if (!places.has(place)) places.set(place, { name: settings(row).map(unquoted).join(', '), cells: values.map(() => null) });
    places.get(place)!.cells[values.indexOf(row.value)] = row;
  }
  const combinations = [...places.values()];
  const best = optimum ?? null;
  return {
    values,
    keys,
    fixed,
    combinations: combinations.map(({ name }) => name),
    rows: combinations.map(({ cells }) => cells),
    optimum: best && [values.indexOf(best.value), [...places.keys()].indexOf(placeOf(best))],
  };
}

/** "3 mm" of a value that is collected; without a unit where that is not known. */
export function valueText(value: Num, name: string, points: StudyPoints | null): string {
  const unit = points?.values.find((column) => column.name === name)?.unit ?? '';
  return unit === '' || unit === '1' ? significant(value) : `${significant(value)} ${unit}`;
}

/** "at least 3 mm". */
export function conditionText({ at_least: least, at_most: most, rows }: Pick<ProbabilityResult, 'at_least' | 'at_most' | 'rows'>, points: StudyPoints | null): string {
  const value = rows[0]?.value ?? '';
  return least === null ? `at most ${valueText(most, value, points)}` : `at least ${valueText(least, value, points)}`;
}

/** What the robust optimum is; empty where there is none, or nothing to choose from. */
export function optimumText({ optimum, rows, at_least: least, worst_share: share, equal }: ProbabilityResult, points: StudyPoints | null): string {
  if (!optimum || rows.length < 2) return '';
  const worst = optimum.worst === null ? 'infinity: no limit in the range searched' : valueText(optimum.worst, optimum.value, points);
  const others = equal === 0 ? '' : ` ${equal} ${equal === 1 ? 'other is' : 'others are'} equal in that.`;
  return `Robust optimum: ${rowName(optimum)}. At most ${percent(share, 0)} of its samples are ${least === null ? 'above' : 'below'} ${worst}.${others}`;
}

/** How many a plot has, and of how many. */
export function shownText(shown: number, all: number, what: string): string {
  return shown < all ? `${shown} of ${all} ${what}, evenly chosen.` : `${all} ${what}.`;
}

/** What a plot of a value over the points does not have. */
export function notShownTexts({ points, rejected }: StudyPoints, { numbers, infinite }: StudyColumn): string[] {
  const empty = numbers.filter((value) => value === null).length - infinite;
  const texts = [];
  if (rejected > 0) texts.push(`${rejected} of all ${points} points were rejected: their document is not valid.`);
  if (infinite > 0) texts.push(`${infinite} are infinite and not drawn, as a limit beyond the depths searched.`);
  if (empty > 0) texts.push(`${empty} without a value are not drawn.`);
  return texts;
}

/** Two different keys across and up where one of both is chosen anew: the other one takes the old place if it must. */
export function chosenAxes([across, up]: [number, number], which: 0 | 1, key: number): [number, number] {
  if (which === 0) return [key, key === up ? across : up];
  return [key === across ? up : across, key];
}
