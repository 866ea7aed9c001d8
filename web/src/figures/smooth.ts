import type { JointMotion, Num, Smooth, SmoothMethod } from '../documents';
import { curve, limitMarks, reach, suffix } from './rows';
import { axis, layout, plain, type Figure, type Layout, type Theme, type Trace } from './theme';

export const dashes = ['solid', '7px,3px', '2px,2px', '9px,3px,2px,3px', '4px,4px'];

interface Line {
  name: string;
  x: number[];
  y: number[];
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

/** Largest magnitude of the numbers. */
export function magnitude(values: number[]): number {
  return values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
}

/** Rows of curves over time, one above the other, each with its limit. */
function overTime(rows: Row[], duration: number, legend: boolean, theme: Theme): Figure {
  const data: Trace[] = [];
  const shapes: Layout[] = [];
  const annotations: Layout[] = [];
  const axes: Layout = {};
  const share = 1 / rows.length;
  rows.forEach((row, index) => {
    const most = Math.max(...row.lines.map((line) => magnitude(line.y)), 0);
    const inside = row.limit !== null && (most === 0 || row.limit <= reach * most);
    for (const line of row.lines) {
      const style = { color: line.color, width: 1.4, dash: line.dash };
      data.push(curve(index, line.name, row.unit, line.x, line.y, style, { legendgroup: line.name, showlegend: legend && index === 0 }));
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
export function speedFigure(smooth: Smooth, theme: Theme): Figure {
  const lines = (values: (method: SmoothMethod) => number[]): Line[] =>
    smooth.methods.map((method, i) => ({
      name: plain(method.name),
      x: method.motion.time_s,
      y: values(method),
      color: theme.series[i % theme.series.length]!,
      dash: dashes[i % dashes.length]!,
    }));
  const rows: Row[] = [
    { title: 'Tip (mm/s)', unit: 'mm/s', lines: lines((m) => m.motion.tip_speed_mm_per_s), limit: smooth.max_tip_speed_mm_per_s, both: false },
    { title: 'Axis (°/s)', unit: '°/s', lines: lines((m) => m.motion.axis_speed_deg_per_s), limit: smooth.max_axis_speed_deg_per_s, both: false },
  ];
  const durations = smooth.methods.map((method) => method.duration_s);
  return overTime(rows, Math.min(Math.max(...durations), longest * durations[0]!), smooth.methods.length > 1, theme);
}

/** Velocity, acceleration, jerk and tracking error of one joint over time. */
export function jointFigure(method: SmoothMethod, joint: JointMotion, theme: Theme): Figure {
  const row = (title: string, unit: string, y: number[], limit: Num): Row => ({
    title: `${title} (${unit})`,
    unit,
    lines: [{ name: title.toLowerCase(), x: method.motion.time_s, y, color: theme.accent, dash: 'solid' }],
    limit,
    both: true,
  });
  const unit = joint.unit;
  const rows = [
    row('Velocity', `${unit}/s`, joint.velocity, joint.max_velocity),
    row('Acceleration', `${unit}/s²`, joint.acceleration, joint.max_acceleration),
    row('Jerk', `${unit}/s³`, joint.jerk, joint.max_jerk),
  ];
  if (joint.tracking_error !== null) rows.push(row('Tracking error', unit, joint.tracking_error, null));
  return overTime(rows, method.duration_s, false, theme);
}
