import type { Peak, Recording } from '../documents';
import { axis, layout, plain, thinSpace, type Figure, type Theme, type Trace } from './theme';

/** Multiples of `base` up to `most`; those of `skip` left out. */
export function harmonics(base: number, most: number, skip = Infinity): number[] {
  if (!(base > 0)) return [];
  const lines: number[] = [];
  for (let k = 1; k * base <= most && lines.length < 400; ++k) if (k % skip !== 0) lines.push(k * base);
  return lines;
}

/** Vertical lines as one trace, so that the legend can switch them. */
export function verticals(name: string, at: number[], base: number, top: number, bottom: number, line: object): Trace {
  const x: (number | null)[] = [];
  const y: (number | null)[] = [];
  const text: string[] = [];
  for (const frequency of at) {
    x.push(frequency, frequency, null);
    y.push(bottom, top, null);
    const label = `${Math.round(frequency / base)} × ${name}: ${frequency.toFixed(2)} Hz`;
    text.push(label, label, '');
  }
  return { type: 'scatter', mode: 'lines', name, x, y, text, hovertemplate: '%{text}<extra></extra>', line };
}

export const looks: Record<Peak['kind'], { name: string; symbol: string; colour: keyof Theme }> = {
  chatter: { name: 'chatter', symbol: 'x', colour: 'chatter' },
  'cut or chatter': { name: 'the cut or chatter', symbol: 'diamond-open', colour: 'borderline' },
  unexplained: { name: 'neither', symbol: 'diamond', colour: 'borderline' },
  'tooth passing': { name: 'tooth-passing peak', symbol: 'circle', colour: 'accent' },
  rotation: { name: 'rotation peak', symbol: 'circle-open', colour: 'muted' },
};

export function spectrumFigure(recording: Recording, logarithmic: boolean, theme: Theme): Figure {
  const values = recording.amplitude.filter((value): value is number => value !== null && value > 0);
  const highest = values.reduce((most, value) => Math.max(most, value), 0) || 1;
  const to = recording.frequency_hz[recording.frequency_hz.length - 1] ?? 1;
  const top = highest * (logarithmic ? 3 : 1.15);
  const bottom = logarithmic ? highest * 1e-4 : 0;
  const unit = plain(recording.amplitude_unit);
  const { rotation_hz: rotation, tooth_passing_hz: passing } = recording;
  const data: Trace[] = [
    verticals('rotation', harmonics(rotation, to, recording.teeth), rotation, top, bottom, { color: theme.unknown, width: 0.8, dash: '2px,4px' }),
    verticals('tooth passing', harmonics(passing, to), passing, top, bottom, { color: theme.accent, width: 1, dash: '6px,4px' }),
    {
      type: 'scatter',
      mode: 'lines',
      name: 'spectrum',
      x: recording.frequency_hz,
      y: recording.amplitude,
      line: { color: theme.text, width: 1.2 },
      hovertemplate: `%{x:.2f}${thinSpace}Hz: %{y:.4g}${thinSpace}${unit}<extra></extra>`,
    },
  ];
  for (const kind of ['rotation', 'tooth passing', 'unexplained', 'cut or chatter', 'chatter'] as const) {
    const peaks = recording.peaks.filter((peak) => peak.kind === kind);
    if (peaks.length === 0) continue;
    const look = looks[kind];
    const named = kind !== 'rotation' && kind !== 'tooth passing';
    data.push({
      type: 'scatter',
      mode: named ? 'markers+text' : 'markers',
      name: look.name,
      x: peaks.map((peak) => peak.frequency_hz),
      y: peaks.map((peak) => peak.amplitude),
      text: peaks.map((peak) => `${peak.frequency_hz.toFixed(1)}`),
      textposition: 'top center',
      textfont: { color: theme[look.colour], size: 12 },
      hovertext: peaks.map((peak) => plain(peak.text)),
      hovertemplate: `%{x:.2f}${thinSpace}Hz<br>%{hovertext}<extra></extra>`,
      marker: { symbol: look.symbol, size: 9, color: theme[look.colour], line: { width: 1, color: theme.panel } },
    });
  }
  return {
    data,
    layout: layout(theme, 420, {
      hovermode: 'closest',
      xaxis: axis(theme, 'Frequency (Hz)', { range: [0, to], hoverformat: '.2f' }),
      yaxis: axis(theme, `Amplitude (${unit})`, {
        type: logarithmic ? 'log' : 'linear',
        range: logarithmic ? [Math.log10(bottom), Math.log10(top)] : [0, top],
        exponentformat: 'power',
      }),
    }),
  };
}
