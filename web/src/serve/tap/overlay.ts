// Single hits over each other: in time, and their own frequency responses.
import type { Num } from '../../documents';
import { axis, layout, lines, thinSpace, type Figure, type Layout, type Theme, type Trace } from '../../figures/theme';
import type { TapCurve, TapHitCurves } from '../documents';

/** A hit among the others. */
export interface Overlaid {
  hit: TapHitCurves;
  used: boolean;
  newest: boolean;
}

/** What may be drawn in time: "force", or a response's direction. */
export function timeNames(hits: TapHitCurves[]): string[] {
  const responses = new Set(hits.flatMap(({ responses: of }) => Object.keys(of ?? {})));
  return ['force', ...responses];
}

/** Names of the FRFs that a hit has. */
export function frfNames(hits: TapHitCurves[]): string[] {
  return [...new Set(hits.flatMap(({ frf }) => Object.keys(frf?.magnitude_m_per_n ?? {})))];
}

interface Line {
  number: number;
  x: number[];
  y: Num[];
}

/** Several lines as one trace: hundreds of hits stay three traces. */
function joined(name: string, hits: Line[], style: Layout, hover: string): Trace {
  const x: Num[] = [];
  const y: Num[] = [];
  const customdata: number[] = [];
  for (const line of hits) {
    x.push(...line.x, null);
    y.push(...line.y, null);
    customdata.push(...line.x.map(() => line.number), line.number);
  }
  return lines(name, x, y, style, `hit %{customdata}: ${hover}`, { customdata });
}

/** Used hits, those that are not, and the newest over them. */
function traces(all: Overlaid[], lineOf: (hit: TapHitCurves) => Omit<Line, 'number'> | null, hover: string, theme: Theme): Trace[] {
  const hits = all.flatMap((one) => {
    const line = lineOf(one.hit);
    return line ? [{ ...one, line: { number: one.hit.number, ...line } }] : [];
  });
  const of = (which: (one: (typeof hits)[number]) => boolean) => hits.filter(which).map(({ line }) => line);
  const parts: [string, Line[], Layout][] = [
    ['used', of(({ used, newest }) => used && !newest), { color: theme.measured, width: 1.2 }],
    ['not used', of(({ used, newest }) => !used && !newest), { color: theme.chatter, width: 1.2, dash: '5px,4px' }],
    ['newest', of(({ newest }) => newest), { color: theme.accent, width: 2.6, ...(hits.some(({ newest, used }) => newest && !used) ? { dash: '5px,4px' } : {}) }],
  ];
  return parts.flatMap(([name, some, style]) => (some.length > 0 ? [joined(name, some, style, hover)] : []));
}

/** From three widths of the newest pulse before its peak to eight behind it [ms]; null: nothing is known. */
export function pulseRange(force: TapCurve | undefined): [number, number] | null {
  const peak = Math.max(...(force?.values.map((value) => value ?? 0) ?? []), 0);
  const above = force?.time_s.filter((_, i) => (force.values[i] ?? 0) > peak / 2) ?? [];
  const near = above.filter((t) => Math.abs(t - above[0]!) < 0.1);
  if (!(peak > 0) || near.length === 0) return null;
  const width = Math.max(near[near.length - 1]! - near[0]!, 5e-5);
  return [-3e3 * width, 8e3 * width];
}

/** @param which  "force" or a response's direction; @param pulse  the pulse alone, not all that is known */
export function timeFigure(all: Overlaid[], which: string, pulse: boolean, theme: Theme): Figure {
  const curveOf = (hit: TapHitCurves) => (which === 'force' ? hit.force : hit.responses?.[which]);
  const lineOf = (hit: TapHitCurves) => {
    const curve = curveOf(hit);
    return curve ? { x: curve.time_s.map((t) => 1e3 * t), y: curve.values } : null;
  };
  const newest = all.find((one) => one.newest) ?? all[all.length - 1];
  const range = pulse ? pulseRange(newest?.hit.force) : null;
  const unit = which === 'force' ? `${thinSpace}N` : '';
  return {
    data: traces(all, lineOf, `%{y:.4g}${unit} at %{x:.3f}${thinSpace}ms`, theme),
    layout: layout(theme, 340, {
      margin: { l: 64, r: 24, t: 32, b: 48 },
      xaxis: axis(theme, 'Time from the peak of the force (ms)', range ? { range } : {}),
      yaxis: axis(theme, which === 'force' ? 'Force (N)' : `Response in ${which} (as recorded)`),
      uirevision: `${which} ${String(pulse)}`,
    }),
  };
}

export function hitFrfFigure(all: Overlaid[], name: string, logarithmic: boolean, theme: Theme): Figure {
  const lineOf = ({ frf }: TapHitCurves) => {
    const y = frf?.magnitude_m_per_n[name];
    return frf && y ? { x: frf.frequency_hz, y: y.map((value) => (value === null ? null : 1e6 * value)) } : null;
  };
  return {
    data: traces(all, lineOf, `%{y:.4g}${thinSpace}µm/N at %{x:.2f}${thinSpace}Hz`, theme),
    layout: layout(theme, 340, {
      margin: { l: 64, r: 24, t: 32, b: 48 },
      xaxis: axis(theme, 'Frequency (Hz)', logarithmic ? { type: 'log' } : {}),
      yaxis: axis(theme, `|${name}| (µm/N)`, { type: 'log', exponentformat: 'power', dtick: 1 }),
      uirevision: `${name} ${String(logarithmic)}`,
    }),
  };
}
