// Plots one above the other that share the axis below them.
import type { TimeCurve } from '../bands';
import type { Num } from '../documents';
import { axis, layout, legendRow, lines, stacked, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

/** What the names of an axis end with in the index-th plot from above. */
export function suffix(index: number): string {
  return index === 0 ? '' : `${index + 1}`;
}

/** A curve in the index-th plot. */
export function curve(index: number, name: string, unit: string, x: Num[], y: Num[], line: Layout, more: Trace = {}): Trace {
  return lines(name, x, y, line, `%{y:.4g}${unit === '' ? '' : thinSpace}${unit}<extra>${name}</extra>`, { yaxis: `y${suffix(index)}`, ...more });
}

/** A limit further above the curve than this would flatten it. */
export const reach = 3;

/** A limit of the index-th plot: dashed lines at these heights, if any, and words above the plot. */
export function limitMarks(index: number, heights: number[], text: string, theme: Theme): { shapes: Layout[]; annotation: Layout } {
  const y = `y${suffix(index)}`;
  const line = { color: theme.chatter, width: 1.5, dash: '6px,4px' };
  return {
    shapes: heights.map((at) => ({ type: 'line', xref: 'paper', yref: y, x0: 0, x1: 1, y0: at, y1: at, line })),
    annotation: { text, showarrow: false, font: { size: 11, color: theme.chatter }, xref: 'paper', x: 1, xanchor: 'right', yref: `${y} domain`, y: 1, yanchor: 'bottom' },
  };
}

/** A curve of a row. */
export interface Line extends TimeCurve {
  name: string;
  color: string;
  dash: string;
}

/** One of the plots. */
export interface Row {
  title: string;
  unit: string;
  lines: Line[];
  limit: Num;
  both: boolean; // signs
}

/** Highest of the numbers; 0 where there is none above it. */
export function highest(values: Num[]): number {
  return values.reduce<number>((most, value) => Math.max(most, value ?? 0), 0);
}

/** Largest magnitude of the numbers that there are. */
export function magnitude(values: Num[]): number {
  return values.reduce<number>((most, value) => Math.max(most, Math.abs(value ?? 0)), 0);
}

/** A plot among others above each other. */
export interface Stacked {
  title: string;
  traces: Trace[]; // of the curves: curve()
  axis: Layout;
  marks?: ReturnType<typeof limitMarks>;
}

/** All of them; `gap` is between two, as a share of the whole height. */
export function stack(rows: Stacked[], gap: number, theme: Theme): { data: Trace[]; axes: Layout; shapes: Layout[]; annotations: Layout[] } {
  const axes = rows.map(({ title, axis: own }, i) => [`yaxis${suffix(i)}`, axis(theme, title, { domain: stacked(i, rows.length, gap), ...own })]);
  return {
    data: rows.flatMap(({ traces }) => traces),
    axes: Object.fromEntries(axes),
    shapes: rows.flatMap(({ marks }) => marks?.shapes ?? []),
    annotations: rows.flatMap(({ marks }) => (marks ? [marks.annotation] : [])),
  };
}

/** Rows of curves over time, one above the other, each with its limit. */
export function overTime(rows: Row[], duration: number, legend: boolean, theme: Theme): Figure {
  const named = new Set<string>();
  const { data, axes, shapes, annotations } = stack(
    rows.map((row, index) => {
      const most = Math.max(...row.lines.map((line) => magnitude(line.values)), 0);
      const inside = row.limit !== null && (most === 0 || row.limit <= reach * most);
      const high = 1.1 * Math.max(most, inside ? row.limit! : 0) || 1;
      const traces = row.lines.map(({ name, time_s, values, color, dash }) => {
        const showlegend = legend && !named.has(name);
        named.add(name);
        return curve(index, name, row.unit, time_s, values, { color, width: 1.4, dash }, { legendgroup: name, showlegend });
      });
      const own = { title: row.title, traces, axis: { range: [row.both ? -high : 0, high], nticks: 5, zeroline: row.both, exponentformat: 'none' } };
      if (row.limit === null) return own;
      const text = `limit ${Number(row.limit.toPrecision(4))} ${row.unit}${inside ? '' : ', beyond this plot'}`;
      const heights = row.both ? [row.limit, -row.limit] : [row.limit];
      return { ...own, marks: limitMarks(index, inside ? heights : [], text, theme) };
    }),
    0.05,
    theme,
  );
  return {
    data,
    layout: layout(theme, 165 * rows.length + 80, {
      hovermode: 'x',
      margin: { l: 72, r: 36, t: legend ? 52 : 32, b: 48 },
      legend: legendRow({ y: 1 + 22 / (165 * rows.length) }),
      xaxis: axis(theme, 'Time (s)', { anchor: `y${rows.length}`, range: [0, duration], hoverformat: '.3f', exponentformat: 'none' }),
      ...axes,
      shapes,
      annotations,
    }),
  };
}
