import { bandCurve, type Band } from '../bands';
import type { Motion, MotionDocument, Num, SmoothDocument, SmoothedBy } from '../documents';
import { jointUnit, smoothedBy } from '../smooth_views';
import { scaled } from '../text';
import { overTime, type Line, type Row } from './rows';
import { plain, seriesColour, type Figure, type Theme } from './theme';

export const dashes = ['solid', '7px,3px', '2px,2px', '9px,3px,2px,3px', '4px,4px'];

const longest = 3; // of the first method's duration: a far slower one would squeeze all others

/** Speed of the tip and of the axis over time, each method a line. */
export function speedFigure(smooth: SmoothDocument, { motions }: MotionDocument, theme: Theme): Figure {
  const methods = smoothedBy(smooth);
  const lines = (band: (motion: Motion) => Band): Line[] =>
    motions.map((motion, i) => ({
      name: plain(methods[i]!.method),
      ...bandCurve(band(motion), motion.run_s),
      color: seriesColour(theme, i),
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
