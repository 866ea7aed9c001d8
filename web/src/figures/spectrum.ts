import type { Peak, Recording } from '../documents';
import { highest } from './rows';
import { axis, layout, lines, plain, points, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

/** Multiples of `base` up to `most`; those of `skip` left out. */
export function harmonics(base: number, most: number, skip = Infinity): number[] {
  if (!(base > 0)) return [];
  const at: number[] = [];
  for (let k = 1; k * base <= most && at.length < 400; ++k) if (k % skip !== 0) at.push(k * base);
  return at;
}

/** Vertical lines as one trace, so that the legend can switch them. */
export function verticals(name: string, at: number[], base: number, top: number, bottom: number, line: Layout): Trace {
  const x: (number | null)[] = [];
  const y: (number | null)[] = [];
  const text: string[] = [];
  for (const frequency of at) {
    x.push(frequency, frequency, null);
    y.push(bottom, top, null);
    const label = `${Math.round(frequency / base)} × ${name}: ${frequency.toFixed(2)} Hz`;
    text.push(label, label, '');
  }
  return lines(name, x, y, line, '%{text}', { text });
}

export const looks: Record<Peak['kind'], { name: string; symbol: string; colour: keyof Theme }> = {
  chatter: { name: 'chatter', symbol: 'x', colour: 'chatter' },
  'cut or chatter': { name: 'the cut or chatter', symbol: 'diamond-open', colour: 'borderline' },
  unexplained: { name: 'neither', symbol: 'diamond', colour: 'borderline' },
  'tooth passing': { name: 'tooth-passing peak', symbol: 'circle', colour: 'accent' },
  rotation: { name: 'rotation peak', symbol: 'circle-open', colour: 'muted' },
};

/** The axis of a spectrum's amplitudes and its ends: a logarithmic one reaches four decades below the highest line. */
export function amplitudes(most: number, logarithmic: boolean, unit: string, theme: Theme): { top: number; bottom: number; heights: Layout } {
  const top = most * (logarithmic ? 3 : 1.15);
  const bottom = logarithmic ? most * 1e-4 : 0;
  const range = logarithmic ? [Math.log10(bottom), Math.log10(top)] : [0, top];
  return { top, bottom, heights: axis(theme, `Amplitude (${unit})`, { type: logarithmic ? 'log' : 'linear', range, exponentformat: 'power' }) };
}

export function overFrequency(to: number, heights: Layout, theme: Theme): Layout {
  return layout(theme, 420, { hovermode: 'closest', xaxis: axis(theme, 'Frequency (Hz)', { range: [0, to], hoverformat: '.2f' }), yaxis: heights });
}

export function spectrumFigure(recording: Recording, logarithmic: boolean, theme: Theme): Figure {
  const to = recording.frequency_hz[recording.frequency_hz.length - 1] ?? 1;
  const unit = plain(recording.amplitude_unit);
  const { top, bottom, heights } = amplitudes(highest(recording.amplitude) || 1, logarithmic, unit, theme);
  const { rotation_hz: rotation, tooth_passing_hz: passing } = recording;
  const data: Trace[] = [
    verticals('rotation', harmonics(rotation, to, recording.teeth), rotation, top, bottom, { color: theme.unknown, width: 0.8, dash: '2px,4px' }),
    verticals('tooth passing', harmonics(passing, to), passing, top, bottom, { color: theme.accent, width: 1, dash: '6px,4px' }),
    lines('spectrum', recording.frequency_hz, recording.amplitude, { color: theme.text, width: 1.2 }, `%{x:.2f}${thinSpace}Hz: %{y:.4g}${thinSpace}${unit}`),
  ];
  for (const kind of ['rotation', 'tooth passing', 'unexplained', 'cut or chatter', 'chatter'] as const) {
    const peaks = recording.peaks.filter((peak) => peak.kind === kind);
    if (peaks.length === 0) continue;
    const look = looks[kind];
    const named = kind !== 'rotation' && kind !== 'tooth passing';
    const marker = { symbol: look.symbol, size: 9, color: theme[look.colour], line: { width: 1, color: theme.panel } };
    data.push(
      points(look.name, peaks.map((peak) => peak.frequency_hz), peaks.map((peak) => peak.amplitude), marker, `%{x:.2f}${thinSpace}Hz<br>%{hovertext}`, {
        mode: named ? 'markers+text' : 'markers',
        text: peaks.map((peak) => `${peak.frequency_hz.toFixed(1)}`),
        textposition: 'top center',
        textfont: { color: theme[look.colour], size: 12 },
        hovertext: peaks.map((peak) => plain(peak.text)),
      }),
    );
  }
  return { data, layout: overFrequency(to, heights, theme) };
}
