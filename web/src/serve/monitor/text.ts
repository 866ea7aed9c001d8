// What is said of monitored spindles.
import type { MonitorState } from '../../documents';
import { chatterNotes, reasonText } from '../../monitor_views';
import { dash, fixed, withDeviation } from '../../text';
import type { MonitorFrame, MonitorRow, MonitorSummary } from './documents';

const stateNames: Record<MonitorState, string> = { stable: 'stable', transition: 'transition', chatter: 'chatter', blind: 'undetermined' };

export function nameOf({ id, input }: Pick<MonitorSummary, 'id' | 'input'>): string {
  return `Spindle ${id}: ${input}`;
}

/** "undetermined: samples lost". */
export function stateText({ state, reason }: Pick<MonitorFrame, 'state' | 'reason'>): string {
  return state === 'blind' ? `${stateNames.blind}: ${reasonText(reason)}` : stateNames[state];
}

export function isOver({ status }: Pick<MonitorSummary, 'status'>): boolean {
  return status === 'done' || status === 'failed';
}

/** How a session stands where that is no state of the cut. */
export function statusText({ status, frame }: Pick<MonitorSummary, 'status' | 'frame'>): string | null {
  if (status === 'failed') return 'failed';
  if (status === 'done') return 'ended';
  if (status === 'starting') return 'starting';
  return frame === null ? 'no samples yet' : null;
}

/** "683.20 ± 0.60 Hz". */
export function chatterText({ chatter_frequency_hz: frequency, chatter_frequency_std_hz: deviation }: Pick<MonitorFrame, 'chatter_frequency_hz' | 'chatter_frequency_std_hz'>): string {
  return frequency === null ? dash : `${withDeviation(frequency, deviation, 1, 1)} Hz`;
}

/** "7:59:12.3" of seconds. */
export function timeText(seconds: number): string {
  const tenths = Math.round(10 * seconds);
  const [hours, minutes, rest] = [Math.floor(tenths / 36000), Math.floor(tenths / 600) % 60, tenths % 600];
  const last = `${rest < 100 ? '0' : ''}${(rest / 10).toFixed(1)}`;
  return hours > 0 ? `${hours}:${String(minutes).padStart(2, '0')}:${last}` : `${minutes}:${last}`;
}

/** When a row began: by the clock of a stream, in the time of a recording. */
export function beganText({ clock_s, from_s }: MonitorRow, { speed, started }: Pick<MonitorSummary, 'speed' | 'started'>): string {
  if (speed !== null) return timeText(from_s);
  const at = new Date(Date.parse(started) + 1000 * clock_s);
  return Number.isNaN(at.getTime()) ? timeText(clock_s) : at.toLocaleTimeString();
}

export function lastedText({ from_s, to_s }: MonitorRow): string {
  return to_s === null ? 'lasts' : fixed(to_s - from_s, 2);
}

export function rowState({ kind, reason }: MonitorRow): string {
  if (kind === 'notice') return 'input';
  return stateText({ state: kind, reason });
}

export function rowNote(row: MonitorRow): string {
  if (row.kind !== 'notice') return chatterNotes(row).join('; ');
  return `${row.message ?? row.what ?? ''}${row.count > 1 ? ` (${row.count} times)` : ''}`;
}

const most_rows = 500;

/** Those that changed in the place of what was known of them; the newest first, no more than 500. */
export function withRows(rows: MonitorRow[], changed: MonitorRow[]): MonitorRow[] {
  if (changed.length === 0) return rows;
  const numbers = new Set(changed.map(({ number }) => number));
  const all = [...changed, ...rows.filter(({ number }) => !numbers.has(number))];
  return all.sort((a, b) => b.number - a.number).slice(0, most_rows);
}

/** The lowest of the choices that shows chatter, and two kilohertz. */
export function highestFor(choices: number[], chatter_hz: number | null): number {
  const wanted = Math.max(2000, 1.25 * (chatter_hz ?? 0));
  return choices.find((choice) => choice >= wanted) ?? choices[choices.length - 1]!;
}

/** Highest frequencies to choose from, up to that of the bands. */
export function highestChoices(edges_hz: number[]): number[] {
  const top = Math.floor(edges_hz[edges_hz.length - 1] ?? 0);
  return [...[200, 500, 1000, 2000, 5000].filter((choice) => choice < 0.95 * top), top];
}
