import type { Frf, Mode } from '../views';
import { axis, layout, lines, logTicks, plain, points, shadedBetween, thinSpace, verticalLine, type Figure, type Layout, type Theme, type Trace } from './theme';

/** Breaks a phase curve where it jumps by more than half a turn, so that no line crosses the plot. */
export function breakJumps(frequency: number[], phase: (number | null)[]): { x: number[]; y: (number | null)[] } {
  const x: number[] = [];
  const y: (number | null)[] = [];
  phase.forEach((value, i) => {
    const before = i > 0 ? phase[i - 1] : null;
    if (value !== null && before != null && Math.abs(value - before) > 180) {
      x.push(frequency[i]!);
      y.push(null);
    }
    x.push(frequency[i]!);
    y.push(value);
  });
  return { x, y };
}

const energy = 'suspect: the holder would create energy';
const amplified = 'unreliable: the measurement is amplified';

/** The axis that a figure spans. */
function axisOf({ predicted, measured, fitted }: Frf): number[] {
  return (predicted ?? measured ?? fitted)?.frequency_hz ?? [];
}

/** Lowest frequency above zero, and the highest. */
function band(frf: Frf): [number, number] {
  const frequencies = axisOf(frf);
  return [frequencies.find((f) => f > 0) ?? 1, frequencies[frequencies.length - 1] ?? 1];
}

/** A logarithmic axis serves where the band spans more than a decade and a half. */
export function prefersLogFrequency(frf: Frf): boolean {
  const [from, to] = band(frf);
  return to / from > 30;
}

function untrusted(frf: Frf, theme: Theme): Layout[] {
  const [from, to] = band(frf);
  const shade = (from: number, to: number) => shadedBetween(from, to, theme.muted, 0.13);
  const bands: Layout[] = [];
  if (frf.trusted_from_hz !== null && frf.trusted_from_hz > from) bands.push(shade(from, Math.min(to, frf.trusted_from_hz)));
  if (frf.trusted_to_hz !== null && frf.trusted_to_hz < to) bands.push(shade(Math.max(from, frf.trusted_to_hz), to));
  return bands;
}

/** Where the prediction is not to be trusted: suspect bands are tinted, unreliable ones stand between dotted lines. */
function marked(frf: Frf, theme: Theme): { shapes: Layout[]; keys: Trace[] } {
  const shade = ([from, to]: [number, number], fill: string, opacity: number) => shadedBetween(Math.max(from, band(frf)[0]), to, fill, opacity);
  const suspect = frf.suspect_bands_hz.map((part) => shade(part, theme.borderline, 0.25));
  const unreliable = frf.unreliable_bands_hz.map((part) => ({ ...shade(part, 'rgba(0,0,0,0)', 1), line: { width: 1.5, dash: 'dot', color: theme.borderline } }));
  const key = (name: string, symbol: string) => points(name, [null], [null], { symbol, size: 12, color: theme.borderline, line: { width: 1.5, color: theme.borderline } }, null);
  const keys = [...(suspect.length > 0 ? [key(energy, 'square')] : []), ...(unreliable.length > 0 ? [key(amplified, 'square-open')] : [])];
  return { shapes: [...suspect, ...unreliable], keys };
}

function modeMarks(frf: Frf, modes: Mode[], logarithmic: boolean, theme: Theme): { shapes: Layout[]; annotations: Layout[] } {
  const frequencies = axisOf(frf);
  const [from, to] = [frequencies[0] ?? 0, frequencies[frequencies.length - 1] ?? 0];
  // The FRFs are those of the tool.
  const inside = modes.filter((mode) => mode.mode_of === 'tool' && mode.frequency_hz >= from && mode.frequency_hz <= to);
  const place = (f: number) => (logarithmic ? Math.log10(f) : f);
  const width = Math.max(place(to) - place(Math.max(from, logarithmic ? 0.1 : 0)), 1e-9);
  let level = 0;
  let last = -Infinity;
  const annotations = [...inside]
    .sort((a, b) => a.frequency_hz - b.frequency_hz)
    .map((mode) => {
      const at = place(mode.frequency_hz);
      level = at - last < 0.025 * width ? (level + 1) % 4 : 0;
      last = at;
      return {
        x: at,
        y: 1,
        xref: 'x',
        yref: 'paper',
        yanchor: 'bottom',
        yshift: 11 * level,
        text: `${mode.mode}`,
        showarrow: false,
        font: { size: 10, color: theme.muted },
        hovertext: `mode ${mode.mode}: ${mode.frequency_hz} Hz`,
      };
    });
  const shapes = inside.map((mode) => verticalLine(mode.frequency_hz, { color: theme.unknown, width: 1, dash: '1px,3px' }, { layer: 'below' }));
  return { shapes, annotations };
}

function curves(frf: Frf, theme: Theme): Trace[] {
  const data: Trace[] = [];
  const unit = plain(frf.unit);
  const magnitudeText = `%{y:.4g}${thinSpace}${unit} at %{x:.2f}${thinSpace}Hz`;
  const add = (which: 'measured' | 'predicted' | 'fitted', line: Layout) => {
    const curve = frf[which];
    if (curve === null) return;
    const { frequency_hz: frequency } = curve;
    const { x, y } = breakJumps(frequency, curve.phase_deg);
    data.push(
      lines(which, frequency, curve.magnitude, line, `${magnitudeText}<extra>${which}</extra>`, { legendgroup: which, yaxis: 'y' }),
      lines(which, x, y, line, `%{y:.1f}° at %{x:.2f}${thinSpace}Hz<extra>${which}</extra>`, { legendgroup: which, yaxis: 'y2', showlegend: false }),
    );
  };
  add('measured', { color: theme.measured, width: 3.5 });
  add('predicted', { color: theme.accent, width: 2.2 });
  add('fitted', { color: theme.chatter, width: 1.5, ...(frf.predicted === null ? {} : { dash: '4px,3px' }) });
  if (frf.coherence !== null) {
    const { frequency_hz: frequency, values } = frf.coherence;
    data.push(lines('coherence', frequency, values, { color: theme.stable, width: 1.2 }, `%{y:.3f} at %{x:.2f}${thinSpace}Hz<extra>coherence</extra>`, { yaxis: 'y3', showlegend: false }));
  }
  return data;
}

/** Magnitude, phase and coherence over one frequency axis: measured, predicted and fitted. */
export function frfFigure(frf: Frf, modes: Mode[], logarithmic: boolean, theme: Theme): Figure {
  const coherent = frf.coherence !== null;
  const marks = modeMarks(frf, modes, logarithmic, theme);
  const doubts = marked(frf, theme);
  const [from, to] = band(frf);
  const domains = coherent ? [[0.46, 1], [0.2, 0.42], [0, 0.16]] : [[0.34, 1], [0, 0.3]];
  return {
    data: [...curves(frf, theme), ...doubts.keys],
    layout: layout(theme, coherent ? 620 : 540, {
      hovermode: 'x',
      margin: { l: 64, r: 36, t: 64, b: 48 },
      legend: { orientation: 'h', yanchor: 'bottom', y: 1.07, xanchor: 'left', x: 0 },
      xaxis: axis(theme, 'Frequency (Hz)', {
        anchor: coherent ? 'y3' : 'y2',
        hoverformat: '.2f',
        ...(logarithmic
          ? { type: 'log', range: [Math.log10(from), Math.log10(to)], tickmode: 'array', ...logTicks(from, to) }
          : { type: 'linear', range: [axisOf(frf)[0] ?? 0, to] }),
      }),
      yaxis: axis(theme, `|${plain(frf.name)}| (${plain(frf.unit)})`, { type: 'log', domain: domains[0], exponentformat: 'power', dtick: 1 }),
      yaxis2: axis(theme, 'Phase (°)', { domain: domains[1], range: [-185, 185], tickvals: [-180, -90, 0, 90, 180] }),
      ...(coherent ? { yaxis3: axis(theme, 'Coherence', { domain: domains[2], range: [0, 1.05], tickvals: [0, 0.5, 1] }) } : {}),
      shapes: [...untrusted(frf, theme), ...doubts.shapes, ...marks.shapes],
      annotations: marks.annotations,
    }),
  };
}
