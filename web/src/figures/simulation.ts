import { bandCurve, type Band } from '../bands';
import type { Num, SimulationDocument, VibrationDocument } from '../documents';
import { overTime, type Line } from './rows';
import { dashes } from './smooth';
import { harmonics, verticals } from './spectrum';
import { axis, directionSeries, layout, thinSpace, type Figure, type Theme, type Trace } from './theme';

const axes = ['x', 'y', 'z'] as const;

/** Displacement and force over time, each direction a line. */
export function timeFigure(vibration: VibrationDocument, theme: Theme): Figure {
  const lines = (of: Record<string, Band>): Line[] =>
    axes.flatMap((name, i) => {
      const band = of[name];
      return band ? { name, ...bandCurve(band, vibration.run_s), color: theme.series[directionSeries[i]!]!, dash: dashes[i]! } : [];
    });
  const rows = [
    { title: 'Displacement (µm)', unit: 'µm', lines: lines(vibration.displacement_um), limit: null, both: true },
    { title: 'Force (N)', unit: 'N', lines: lines(vibration.force_n), limit: null, both: true },
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
  const lines = axes.flatMap((name, i) => {
    const values: Num[] | undefined = spectrum[`${name}_um`];
    return values ? { name, values, color: theme.series[directionSeries[i]!]!, dash: dashes[i]! } : [];
  });
  const all = spectrum.frequency_hz;
  const highest = Math.max(...lines.map(({ values }) => values.reduce<number>((most, value) => Math.max(most, value ?? 0), 0)), 0) || 1;
  const seen = all.filter((_, i) => lines.some(({ values }) => (values[i] ?? 0) >= faint * highest));
  const to = Math.min(all[all.length - 1] ?? 1, 1.1 * Math.max(seen[seen.length - 1] ?? 0, simulation.chatter_frequency_hz ?? 0) || 1);
  const top = highest * (logarithmic ? 3 : 1.15);
  const bottom = logarithmic ? highest * 1e-4 : 0;
  const rotation = simulation.spindle_speed_rpm / 60;
  const data: Trace[] = [
    verticals('rotation', harmonics(rotation, to), rotation, top, bottom, { color: theme.unknown, width: 0.8, dash: '2px,4px' }),
    ...lines.map(({ name, values, color, dash }) => ({
      type: 'scatter',
      mode: 'lines',
      name,
      x: all,
      y: values,
      line: { color, width: 1.4, dash },
      hovertemplate: `%{x:.2f}${thinSpace}Hz: %{y:.4g}${thinSpace}µm<extra>${name}</extra>`,
    })),
  ];
  const chatter = simulation.chatter_frequency_hz;
  if (chatter !== null) data.push({ type: 'scatter', mode: 'lines', name: `chatter, ${chatter.toFixed(1)} Hz`, x: [chatter, chatter], y: [bottom, top], line: { color: theme.chatter, width: 1.5, dash: '6px,4px' }, hoverinfo: 'skip' });
  return {
    data,
    layout: layout(theme, 420, {
      hovermode: 'closest',
      xaxis: axis(theme, 'Frequency (Hz)', { range: [0, to], hoverformat: '.2f' }),
      yaxis: axis(theme, 'Amplitude (µm)', {
        type: logarithmic ? 'log' : 'linear',
        range: logarithmic ? [Math.log10(bottom), Math.log10(top)] : [0, top],
        exponentformat: 'power',
      }),
    }),
  };
}
