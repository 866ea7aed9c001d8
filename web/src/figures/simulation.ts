import { bandCurve, type Band } from '../bands';
import type { Num, SimulationDocument, VibrationDocument } from '../documents';
import { highest, overTime, type Line } from './rows';
import { dashes } from './smooth';
import { amplitudes, harmonics, overFrequency, verticals } from './spectrum';
import { directionSeries, lines, thinSpace, type Figure, type Theme, type Trace } from './theme';

const axes = ['x', 'y', 'z'] as const;

/** Displacement and force over time, each direction a line. */
export function timeFigure(vibration: VibrationDocument, theme: Theme): Figure {
  const curves = (of: Record<string, Band>): Line[] =>
    axes.flatMap((name, i) => {
      const band = of[name];
      return band ? { name, ...bandCurve(band, vibration.run_s), color: theme.series[directionSeries[i]!]!, dash: dashes[i]! } : [];
    });
  const rows = [
    { title: 'Displacement (µm)', unit: 'µm', lines: curves(vibration.displacement_um), limit: null, both: true },
    { title: 'Force (N)', unit: 'N', lines: curves(vibration.force_n), limit: null, both: true },
  ];
  const runs = [...Object.values(vibration.displacement_um), ...Object.values(vibration.force_n)].map(({ low }) => low.length);
  return overTime(rows, Math.max(...runs, 1) * vibration.run_s, true, theme);
}

/** Below this share of the highest line nothing is to be seen. */
const faint = 1e-3;

/** Amplitude over frequency, with the multiples of the rotation, and where chatter is. */
export function vibrationSpectrumFigure(
  simulation: SimulationDocument,
  spectrum: NonNullable<VibrationDocument['spectrum']>,
  logarithmic: boolean,
  theme: Theme,
): Figure {
  const curves = axes.flatMap((name, i) => {
    const values: Num[] | undefined = spectrum[`${name}_um`];
    return values ? { name, values, color: theme.series[directionSeries[i]!]!, dash: dashes[i]! } : [];
  });
  const all = spectrum.frequency_hz;
  const most = highest(curves.flatMap(({ values }) => values)) || 1;
  const seen = all.filter((_, i) => curves.some(({ values }) => (values[i] ?? 0) >= faint * most));
  const to = Math.min(all[all.length - 1] ?? 1, 1.1 * Math.max(seen[seen.length - 1] ?? 0, simulation.chatter_frequency_hz ?? 0) || 1);
  const { top, bottom, heights } = amplitudes(most, logarithmic, 'µm', theme);
  const rotation = simulation.spindle_speed_rpm / 60;
  const data: Trace[] = [
    verticals('rotation', harmonics(rotation, to), rotation, top, bottom, { color: theme.unknown, width: 0.8, dash: '2px,4px' }),
    ...curves.map(({ name, values, color, dash }) => lines(name, all, values, { color, width: 1.4, dash }, `%{x:.2f}${thinSpace}Hz: %{y:.4g}${thinSpace}µm<extra>${name}</extra>`)),
  ];
  const chatter = simulation.chatter_frequency_hz;
  if (chatter !== null) data.push(lines(`chatter, ${chatter.toFixed(1)} Hz`, [chatter, chatter], [bottom, top], { color: theme.chatter, width: 1.5, dash: '6px,4px' }, null));
  return { data, layout: overFrequency(to, heights, theme) };
}
