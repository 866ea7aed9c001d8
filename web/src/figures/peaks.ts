import type { ExplanationDocument, PeakKind } from '../documents';
import { readingText, reachOf } from '../verb_views';
import { harmonics, looks, verticals } from './spectrum';
import { axis, layout, plain, points, thinSpace, type Figure, type Theme, type Trace } from './theme';

const kinds = ['rotation', 'tooth passing', 'chatter', 'cut or chatter', 'unexplained'] as const;

/** One trace a kind: filled where it names the peak, open where it is one of several readings. */
function marks(document: ExplanationDocument, kind: PeakKind, row: number, theme: Theme): Trace[] {
  const { colour } = looks[kind];
  const drawn = (name: string, symbol: string, at: { f: number; text: string }[]): Trace[] => {
    const marker = { symbol, size: 11, color: theme[colour], line: { width: 1.5, color: theme[colour] } };
    const text = at.map((one) => plain(one.text));
    return at.length === 0 ? [] : [points(name, at.map(({ f }) => f), at.map(() => row), marker, `%{x:.2f}${thinSpace}Hz<br>%{text}`, { text })];
  };
  const own = document.peaks.filter((peak) => peak.kind === kind).map((peak) => ({ f: peak.frequency_hz, text: readingText(peak) }));
  const other = document.peaks.flatMap((peak) =>
    peak.others.filter((reading) => reading.kind === kind).map((reading) => ({ f: peak.frequency_hz, text: `or ${readingText(reading)}` })),
  );
  return [...drawn(kind, 'circle', own), ...drawn(`${kind}, another reading`, 'circle-open', other)];
}

/** The peaks over frequency, a row a kind, with the multiples of the rotation. */
export function peaksFigure(document: ExplanationDocument, theme: Theme): Figure {
  const rows = kinds.filter((kind) => document.peaks.some((peak) => peak.kind === kind || peak.others.some((other) => other.kind === kind)));
  const to = reachOf(document);
  const rotation = document.spindle_speed_rpm / 60;
  const last = rows.length - 1;
  return {
    data: [
      verticals('rotation', harmonics(rotation, to), rotation, last + 0.5, -0.5, { color: theme.unknown, width: 0.8, dash: '2px,4px' }),
      ...rows.flatMap((kind, i) => marks(document, kind, last - i, theme)),
    ],
    layout: layout(theme, 120 + 56 * rows.length, {
      hovermode: 'closest',
      margin: { l: 56, r: 36, t: 64, b: 48 },
      xaxis: axis(theme, 'Frequency (Hz)', { range: [0, to], hoverformat: '.2f' }),
      yaxis: axis(theme, '', { range: [-0.5, last + 0.5], tickvals: rows.map((_, i) => last - i), ticktext: [...rows], zeroline: false }),
    }),
  };
}
