// A force record beside the prediction, over one revolution.
import type { MeasuredForces, Num, Revolution } from '../documents';
import { forceCurves, turnTicks } from './forces';
import { stack, suffix, type Stacked } from './rows';
import { axis, layout, legendRow, lines, thinSpace, type Figure, type Theme } from './theme';

export const axesNames = ['x', 'y', 'z'] as const;

/** Mean revolution of a component and its deviation; null: not measured. */
export function measuredCourse(measured: MeasuredForces, index: number): { mean: Num[]; std: Num[] } | null {
  const mean = [measured.fx_n, measured.fy_n, measured.fz_n][index]!;
  const std = [measured.fx_std_n, measured.fy_std_n, measured.fz_std_n][index]!;
  return mean.some((value) => value !== null) ? { mean, std } : null;
}

function sum(a: Num[], b: Num[], sign: number): Num[] {
  return a.map((value, i) => (value === null || b[i] === null ? null : value + sign * b[i]!));
}

/** Components that were measured, one above the other: measured with a band of one deviation of its revolutions, predicted. */
export function measuredFigure(turn: Revolution, measured: MeasuredForces, theme: Theme, narrow = false): Figure {
  const x = turn.rotation_deg;
  const rows: Stacked[] = [];
  forceCurves(turn).forEach((predicted, i) => {
    const course = measuredCourse(measured, i);
    if (course === null) return;
    const first = rows.length === 0;
    const on = { yaxis: `y${suffix(rows.length)}` };
    const name = axesNames[i]!;
    const hover = (what: string) => `%{y:.4g}${thinSpace}N at %{x:.1f}°<extra>F${name} ${what}</extra>`;
    const edge = { color: theme.measured, width: 0 };
    rows.push({
      title: `F${name} (N)`,
      traces: [
        lines('', x, sum(course.mean, course.std, -1), edge, null, { ...on, showlegend: false }),
        lines('± one deviation', x, sum(course.mean, course.std, 1), edge, null, { ...on, fill: 'tonexty', fillcolor: theme.bandFill, showlegend: first, legendgroup: 'band' }),
        lines('measured', x, course.mean, { color: theme.text, width: 2 }, hover('measured'), { ...on, showlegend: first, legendgroup: 'measured' }),
        lines('predicted', x, predicted, { color: theme.accent, width: 2, dash: '7px,3px' }, hover('predicted'), { ...on, showlegend: first, legendgroup: 'predicted' }),
      ],
      axis: { nticks: 5, zeroline: true, zerolinecolor: theme.muted, exponentformat: 'none' },
    });
  });
  const { data, axes } = stack(rows, 0.05, theme);
  return {
    data,
    layout: layout(theme, 165 * rows.length + 80, {
      hovermode: 'x',
      margin: { l: 72, r: 36, t: 52, b: 48 },
      legend: legendRow({ y: 1 + 22 / (165 * Math.max(rows.length, 1)) }),
      xaxis: axis(theme, 'Rotation φ from +y (°)', { anchor: `y${suffix(Math.max(rows.length - 1, 0))}`, hoverformat: '.1f', ...turnTicks(x[0] ?? 0, x[x.length - 1] ?? 360, narrow) }),
      ...axes,
    }),
  };
}
