// Plots one above the other that share the axis below them.
import type { Num } from '../documents';
import { thinSpace, type Layout, type Theme, type Trace } from './theme';

/** What the names of an axis end with in the index-th plot from above. */
export function suffix(index: number): string {
  return index === 0 ? '' : `${index + 1}`;
}

/** A curve in the index-th plot. */
export function curve(index: number, name: string, unit: string, x: Num[], y: Num[], line: object, more: Trace = {}): Trace {
  return {
    type: 'scatter',
    mode: 'lines',
    name,
    x,
    y,
    yaxis: `y${suffix(index)}`,
    line,
    hovertemplate: `%{y:.4g}${unit === '' ? '' : thinSpace}${unit}<extra>${name}</extra>`,
    ...more,
  };
}

/** A limit further above the curve than this would flatten it. */
export const reach = 3;

/** A limit of the index-th plot: dashed lines at these heights, if any, and words above the plot. */
export function limitMarks(index: number, heights: number[], text: string, theme: Theme): { shapes: Layout[]; annotation: Layout } {
  const y = `y${suffix(index)}`;
  const line = { color: theme.chatter, width: 1.5, dash: '6px,4px' };
  return {
    shapes: heights.map((at) => ({ type: 'line', xref: 'paper', yref: y, x0: 0, x1: 1, y0: at, y1: at, line })),
    annotation: {
      text,
      showarrow: false,
      font: { size: 11, color: theme.chatter },
      xref: 'paper',
      x: 1,
      xanchor: 'right',
      yref: `${y} domain`,
      y: 1,
      yanchor: 'bottom',
    },
  };
}
