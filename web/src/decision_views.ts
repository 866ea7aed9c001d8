// What the section of a decision needs, made of plan.json's "decision".
import type { Decision, Fact, GammaMap, Num, Outcome, Stretch, Violation } from './documents';
import { thinSpace } from './figures/theme';
import { capital, dash, fixed, percent, significant } from './text';
import { valueAt } from './views';

export const unknown = 'not known';

/** A number of an outcome, and the name of its limit. */
export interface Measure {
  name: string;
  unit: string;
  limit?: Violation['limit'];
  chatters?: (outcome: Outcome) => boolean; // it says that some block is unstable
  text: (outcome: Outcome) => string;
}

function time(value: number): string {
  return fixed(value, 1);
}

function whole(value: number): string {
  return fixed(value, 0);
}

function said(value: Num, text: (value: number) => string = significant): string {
  return value === null ? unknown : text(value);
}

/** "9600 – 12 000", or one number where both are the same. */
export function rangeText(low: Num, high: Num, text: (value: number) => string): string {
  const [from, to] = [low ?? high, high ?? low];
  if (from === null || to === null) return unknown;
  return text(from) === text(to) ? text(from) : `${text(from)}${thinSpace}–${thinSpace}${text(to)}`;
}

export function speedText({ lowest_spindle_speed_rpm: low, highest_spindle_speed_rpm: high }: Outcome): string {
  return rangeText(low, high, whole);
}

export function cuttingTimeText({ cutting_time_s: value }: Outcome): string {
  return said(value, time);
}

/** The robot's time for the program where there is a trajectory of it, else that of the feeds. */
export function decidedTime(before: Outcome, decided: Outcome): { label: string; before: Num; decided: Num } {
  if (decided.robot_time_s !== null) return { label: 'Robot’s time', before: before.robot_time_s, decided: decided.robot_time_s };
  return { label: 'Cutting time at the feeds', before: before.cutting_time_s, decided: decided.cutting_time_s };
}

export function timeText(value: Num): string {
  return said(value, time);
}

/** Those with a limit. */
export const limited: Measure[] = [
  { name: 'Least stability margin, of the limit’s 5 % quantile', unit: '', limit: 'stability', chatters: ({ least_stability_margin: least }) => (least ?? 0) < 0, text: (outcome) => said(outcome.least_stability_margin) },
  { name: 'Peak force', unit: 'N', limit: 'force', text: (outcome) => said(outcome.peak_force_n) },
  { name: 'Torque, mean of a revolution', unit: 'N·m', limit: 'torque', text: (outcome) => said(outcome.revolution_torque_n_m) },
  { name: 'Sustained power', unit: 'W', limit: 'power', text: (outcome) => said(outcome.sustained_power_w) },
  { name: 'Peak deflection', unit: 'µm', limit: 'deflection', text: (outcome) => said(outcome.peak_deflection_um) },
  { name: 'Surface error', unit: 'µm', limit: 'surface_error', text: (outcome) => said(outcome.worst_surface_error_um) },
  { name: 'Forced vibration, amplitude about the mean', unit: 'µm', limit: 'forced_vibration', text: (outcome) => said(outcome.peak_vibration_um) },
];

export const measures: Measure[] = [
  { name: 'Robot’s time, whole program', unit: 's', text: (outcome) => said(outcome.robot_time_s, time) },
  { name: 'Cutting time at the feeds', unit: 's', text: cuttingTimeText },
  { name: 'Time at the feeds, without rapids', unit: 's', text: (outcome) => said(outcome.total_time_s, time) },
  { name: 'Spindle speed', unit: 'rpm', text: speedText },
  { name: 'Unstable blocks', unit: '', chatters: ({ unstable_blocks: count }) => (count ?? 0) > 0, text: (outcome) => said(outcome.unstable_blocks, whole) },
  { name: 'Blocks that may chatter, within the uncertainty', unit: '', chatters: ({ uncertain_blocks: count }) => (count ?? 0) > 0, text: (outcome) => said(outcome.uncertain_blocks, whole) },
  ...limited,
];

export function withUnit(text: string, unit: string): string {
  return unit === '' || text === dash || text === unknown ? text : `${text}${thinSpace}${unit}`;
}

/** The violation of a measure's limit; null where it stays within. */
export function violationOf(outcome: Outcome, { limit }: Measure): Violation | null {
  if (limit === undefined) return null;
  return outcome.violations.find((violation) => violation.limit === limit) ?? null;
}

/** Stability is violated as a spectral radius, of which 1 is allowed, or as a margin, of which less than 1 is asked for. */
function isRadius({ limit, allowed }: Violation): boolean {
  return limit === 'stability' && (allowed ?? 1) >= 1;
}

/** "9.1 kW"; a posture has no number. */
export function valueText({ limit, value, unit }: Violation): string {
  return limit === 'posture' ? dash : withUnit(significant(value), unit);
}

/** "at most 7.5 kW", "at least 0.1" */
export function allowedText({ limit, value, allowed, unit }: Violation): string {
  if (limit === 'posture' || allowed === null) return dash;
  return `${value !== null && value < allowed ? 'at least' : 'at most'} ${withUnit(significant(allowed), unit)}`;
}

/** The same below a measure, which is no spectral radius. */
export function beyondText(violation: Violation): string {
  return isRadius(violation) ? 'chatter' : allowedText(violation);
}

/** "Spindle power" of "spindle_power" */
export function limitName(violation: Violation): string {
  const { limit } = violation;
  if (limit === 'stability') return isRadius(violation) ? 'Stability, |μ|' : 'Stability margin';
  return capital(limit.replace(/_/g, ' '));
}

/** How the tool leans in a stretch from where the program has it: lead and tilt; empty: as there. */
export function leanText({ lead_deg: lead, tilt_deg: tilt }: Pick<Stretch, 'lead_deg' | 'tilt_deg'>): string {
  return lead || tilt ? `${fixed(lead, 1)}°, ${fixed(tilt, 1)}°` : '';
}

/** From the lowest to the highest feed of all stretches. */
export function feedText(stretches: Stretch[]): string {
  const feeds = stretches.flatMap(({ lowest_feed_mm_per_min: low, highest_feed_mm_per_min: high }) => [low, high]);
  return feeds.length === 0 ? unknown : rangeText(Math.min(...feeds), Math.max(...feeds), significant);
}

/** "18 % less than the 52.4 s programmed"; empty where one of the times is not known. */
export function savedText(programmed: Num, decided: Num): string {
  if (programmed === null || decided === null || !(programmed > 0)) return '';
  const share = decided / programmed - 1;
  const before = withUnit(time(programmed), 's');
  if (Math.abs(share) < 0.005) return `as the ${before} programmed`;
  return `${percent(Math.abs(share), 0)} ${share < 0 ? 'less' : 'more'} than the ${before} programmed`;
}

function counted(count: number, one: string): string {
  return `${fixed(count, 0)} ${one}${count === 1 ? '' : 's'}`;
}

function changesText({ lines, speeds, feeds }: Decision['changes']): string {
  return [...(lines === null ? [] : [counted(lines, 'line')]), counted(speeds, 'spindle speed'), counted(feeds, 'feed')].join(', ');
}

function goalText({ goal, decided }: Decision): string {
  if (goal === 'removal_rate') return 'highest removal rate';
  return (decided?.robot_time_s ?? null) === null ? 'shortest cutting time at the feeds' : 'shortest time of the robot';
}
const freedoms: Record<Decision['free'][number], string> = { spindle_speed: 'spindle speed', feed: 'feed', gamma: 'γ', axial_depth: 'axial depth', lead: 'lead', tilt: 'tilt' };

export function decisionFacts(decision: Decision): Fact[] {
  const { free, changes, collisions_checked, evaluations, exact_runs, seconds } = decision;
  return [
    { label: 'Goal', value: goalText(decision) },
    { label: 'Free to choose', value: free.map((name) => freedoms[name]).join(', ') || 'nothing' },
    { label: 'Collisions', value: collisions_checked ? 'checked' : 'not checked' },
    { label: 'Changed in the program', value: changesText(changes) },
    { label: 'Evaluations', value: `${fixed(evaluations, 0)}, ${counted(exact_runs, 'exact run')} in ${withUnit(significant(seconds), 's')}` },
  ];
}

/** What to do before the program is run as decided. */
export function collisionCaution({ collisions_checked, decided, free }: Decision): string {
  if (collisions_checked || decided === null) return '';
  const why = free.includes('gamma') ? ' Other turns γ move the holder, the spindle and the arm.' : '';
  return `Collisions were not checked.${why} Run the program in the air first.`;
}

function column({ margin }: GammaMap, index: number): Num[] {
  return margin.map((row) => row[index] ?? null);
}

/** Between the rows of the map; null where γ is not known or the robot cannot stand. */
export function marginAt(map: GammaMap, index: number, gamma: Num): Num {
  return gamma === null ? null : valueAt(map.gamma_deg, column(map, index), gamma);
}

/** The least margin along a line over the map; null where none is known. */
export function leastAlong(map: GammaMap, gamma: Num[]): Num {
  return map.block.reduce<Num>((least, _, index) => {
    const at = marginAt(map, index, gamma[index] ?? null);
    return at === null ? least : Math.min(least ?? at, at);
  }, null);
}

/** The index of the value nearest to another: of a map's places, or of its blocks, which may be some of the program's. */
export function nearest(values: number[], to: number): number {
  return values.reduce((best, value, index) => (Math.abs(value - to) < Math.abs(values[best]! - to) ? index : best), 0);
}

/** What the map says of one column. */
export function columnFacts(map: GammaMap, index: number): Fact[] {
  const known = column(map, index).flatMap((margin, row) => (margin === null ? [] : [{ margin, gamma: map.gamma_deg[row]! }]));
  const best = known.length === 0 ? null : known.reduce((a, b) => (b.margin > a.margin ? b : a));
  const at = (gamma: number) => `${significant(gamma)}°, margin ${significant(marginAt(map, index, gamma))}`;
  return [
    { label: 'Block', value: fixed(map.block[index]!, 0) },
    { label: 'Along the path', value: withUnit(fixed(map.path_mm[index]!, 1), 'mm') },
    { label: 'γ as programmed', value: at(map.programmed_deg[index]!) },
    { label: 'γ as chosen', value: at(map.chosen_deg[index]!) },
    { label: 'Highest margin', value: best === null ? 'the robot cannot stand here' : `${significant(best.margin)} at ${significant(best.gamma)}°` },
  ];
}
