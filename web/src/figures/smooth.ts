import { bandCurve, type Band, type TimeCurve } from '../bands';
import type { Motion, MotionDocument, Num, SmoothDocument, SmoothedBy } from '../documents';
import { jointUnit, scaled, smoothedBy } from '../smooth_views';
import { curve, limitMarks, reach, suffix } from './rows';
import { axis, layout, plain, type Figure, type Layout, type Theme, type Trace } from './theme';

export const dashes = ['solid', '7px,3px', '2px,2px', '9px,3px,2px,3px', '4px,4px'];

interface Line extends TimeCurve {
  name: string;
  color: string;
  dash: string;
}

interface Row {
  title: string;
  unit: string;
  lines: Line[];
  limit: Num;
  both: boolean; // signs
}

/** Largest magnitude of the numbers that there are. */
export function magnitude(values: Num[]): number {
  return values.reduce<number>((most, value) => Math.max(most, Math.abs(value ?? 0)), 0);
}

/** Rows of curves over time, one above the other, each with its limit. */
function overTime(rows: Row[], duration: number, legend: boolean, theme: Theme): Figure {
  const data: Trace[] = [];
  const shapes: Layout[] = [];
  const annotations: Layout[] = [];
  const axes: Layout = {};
  const share = 1 / rows.length;
  rows.forEach((row, index) => {
    const most = Math.max(...row.lines.map((line) => magnitude(line.values)), 0);
    const inside = row.limit !== null && (most === 0 || row.limit <= reach * most);
    for (const line of row.lines) {
      const style = { color: line.color, width: 1.4, dash: line.dash };
      data.push(curve(index, line.name, row.unit, line.time_s, line.values, style, { legendgroup: line.name, showlegend: legend && index === 0 }));
    }
    if (row.limit !== null) {
      const text = `limit ${Number(row.limit.toPrecision(4))} ${row.unit}${inside ? '' : ', beyond this plot'}`;
      const heights = row.both ? [row.limit, -row.limit] : [row.limit];
      const marks = limitMarks(index, inside ? heights : [], text, theme);
      shapes.push(...marks.shapes);
      annotations.push(marks.annotation);
    }
    const top = 1 - index * share;
    const high = 1.1 * Math.max(most, inside ? row.limit! : 0) || 1;
    axes[`yaxis${suffix(index)}`] = axis(theme, row.title, {
      domain: [Math.max(0, top - share + 0.05), top],
      range: [row.both ? -high : 0, high],
      nticks: 5,
      zeroline: row.both,
      exponentformat: 'none',
    });
  });
  return {
    data,
    layout: layout(theme, 165 * rows.length + 80, {
      hovermode: 'x',
      margin: { l: 72, r: 36, t: legend ? 52 : 32, b: 48 },
      legend: { orientation: 'h', yanchor: 'bottom', y: 1 + 22 / (165 * rows.length), xanchor: 'left', x: 0, font: { size: 12 } },
      xaxis: axis(theme, 'Time (s)', { anchor: `y${rows.length}`, range: [0, duration], hoverformat: '.3f', exponentformat: 'none' }),
      ...axes,
      shapes,
      annotations,
    }),
  };
}

const longest = 3; // of the first method's duration: a far slower one would squeeze all others

/** Speed of the tip and of the axis over time, each method a line. */
export function speedFigure(smooth: SmoothDocument, { motions }: MotionDocument, theme: Theme): Figure {
  const methods = smoothedBy(smooth);
  const lines = (band: (motion: Motion) => Band): Line[] =>
    motions.map((motion, i) => ({
      name: plain(methods[i]!.method),
      ...bandCurve(band(motion), motion.run_s),
      color: theme.series[i % theme.series.length]!,
      dash: dashes[i % dashes.length]!,
    }));
  const rows: Row[] = [
    { title: 'Tip (mm/s)', unit: 'mm/s', lines: lines((m) => m.tip_speed_mm_per_s), limit: smooth.tip.limit_velocity_mm_per_s, both: false },
    { title: 'Axis (°/s)', unit: '°/s', lines: lines((m) => m.axis_speed_deg_per_s), limit: smooth.axis.limit_velocity_deg_per_s, both: false },
  ];
  const durations = methods.map((method) => method.duration_s);
  return overTime(rows, Math.min(Math.max(...durations), longest * durations[0]!), methods.length > 1, theme);
}

/** Velocity, acceleration, jerk and tracking error of one joint over time. */
export function jointFigure(method: SmoothedBy, motion: Motion, index: number, theme: Theme): Figure {
  const joint = motion.joints[index]!;
  const limits = method.joints[index]!;
  const [unit, factor] = jointUnit(limits);
  const row = (title: string, per: string, band: Band, limit: Num): Row => ({
    title: `${title} (${unit}${per})`,
    unit: `${unit}${per}`,
    lines: [{ name: title.toLowerCase(), ...bandCurve(band, motion.run_s), color: theme.accent, dash: 'solid' }],
    limit: scaled(limit, factor),
    both: true,
  });
  const rows = [
    row('Velocity', '/s', joint.velocity, limits.limit_velocity),
    row('Acceleration', '/s²', joint.acceleration, limits.limit_acceleration),
    row('Jerk', '/s³', joint.jerk, limits.limit_jerk),
  ];
  if (joint.tracking_error !== null) rows.push(row('Tracking error', '', joint.tracking_error, null));
  return overTime(rows, method.duration_s, false, theme);
}
