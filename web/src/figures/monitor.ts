import type { Calibration, Monitor, MonitorState, Num, RocPoint } from '../documents';
import { bandCurves } from '../bands';
import { chatterMarks, multiplesOver, shadedStays, speedStretches, type SpeedStretch } from '../monitor_views';
import { curve, stack, suffix, type Stacked } from './rows';
import { scaled } from '../text';
import { axis, barBelow, layout, lines, plain, points, seriesColour, shadedBetween, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

const shades: { state: MonitorState; name: string; colour: (theme: Theme) => string; opacity: number }[] = [
  { state: 'chatter', name: 'chatter', colour: (theme) => theme.chatter, opacity: 0.2 },
  { state: 'transition', name: 'transition', colour: (theme) => theme.borderline, opacity: 0.2 },
  { state: 'blind', name: 'cannot tell', colour: (theme) => theme.unknown, opacity: 0.3 },
];

/** The state as a colour over the whole height, where it was not stable, wide enough to be seen; each colour once in the legend. */
export function states(monitor: Monitor, theme: Theme): Layout[] {
  const [begin, end] = span(monitor);
  const named = new Set<MonitorState>();
  return shadedStays(monitor.stays).map(({ state, from_s, to_s }) => {
    const { name, colour, opacity } = shades.find((shade) => shade.state === state)!;
    const first = !named.has(state);
    named.add(state);
    return { ...shadedBetween(from_s, Math.max(to_s, from_s + (end - begin) / 500), colour(theme), opacity), name, legendgroup: state, showlegend: first };
  });
}

/** From the first to the last moment of the recording. */
export function span(monitor: Monitor): [number, number] {
  const { stays } = monitor;
  return stays.length > 0 ? [stays[0]!.from_s, stays[stays.length - 1]!.to_s] : [0, 1];
}

function timeAxis(monitor: Monitor, theme: Theme, more: Layout = {}): Layout {
  return axis(theme, 'Time (s)', { range: span(monitor), hoverformat: '.3f', exponentformat: 'none', ...more });
}

/** Each channel's samples over time. */
export function waveFigure(monitor: Monitor, theme: Theme, narrow: boolean): Figure {
  const unit = plain(monitor.unit);
  const { time_s: time, values } = bandCurves(monitor.channels.map((channel) => channel.wave), monitor.wave_run_s);
  const several = monitor.channels.length > 1;
  const data = monitor.channels.map((channel, i) =>
    lines(plain(channel.name), time, values[i]!, { color: seriesColour(theme, i), width: 0.8 }, `%{x:.3f}${thinSpace}s: %{y:.4g}${thinSpace}${unit}`, { showlegend: several, opacity: several ? 0.7 : 1 }),
  );
  return {
    data,
    layout: layout(theme, narrow ? 320 : 240, {
      showlegend: true,
      margin: { l: 72, r: 36, t: 32, b: 48 },
      xaxis: timeAxis(monitor, theme),
      yaxis: axis(theme, unit === '' ? 'Signal (as recorded)' : `Signal (${unit})`, { exponentformat: 'none' }),
      shapes: states(monitor, theme),
    }),
  };
}

const deepest = -50; // dB; below, noise hides what stands above it

const mostMultiples = 12;

function count(to: number): number[] {
  return Array.from({ length: Math.max(0, to) }, (_, i) => i + 1);
}

/** Tooth passing and its multiples; rotation up to its third multiple, or up to tooth passing where that comes first. */
function cutLines(monitor: Monitor, theme: Theme, highest_hz: number): Trace[] {
  const stretches = speedStretches(monitor);
  const teeth = monitor.teeth ?? 0;
  const line = (name: string, perTurn: number, multiples: number[], style: Layout): Trace[] => {
    const { x, y } = multiplesOver(stretches, perTurn, multiples, highest_hz);
    return x.length === 0 ? [] : [lines(name, x, y, style, null)];
  };
  return [
    ...line('rotation', 1, count(teeth > 0 ? Math.min(3, teeth - 1) : 3), { color: theme.overlay, width: 1, dash: '1px,4px' }),
    ...(teeth > 0 ? line('tooth passing', teeth, count(mostMultiples), { color: theme.overlay, width: 1.2, dash: '6px,5px' }) : []),
  ];
}

/** The synchrosqueezed spectrogram up to what is worth drawing, with the frequencies of chatter and those of the cut. */
export function spectrogramFigure(monitor: Monitor, theme: Theme): Figure {
  const spectrogram = monitor.spectrogram!;
  const columns = spectrogram.level_db[0]?.length ?? 0;
  const [begin, end] = span(monitor);
  const marks = chatterMarks(monitor, end - begin);
  const highest = spectrogram.max_frequency_hz;
  const data: Trace[] = [
    {
      type: 'heatmap',
      x: Array.from({ length: columns }, (_, k) => spectrogram.begin_s + k * spectrogram.step_s),
      y: spectrogram.frequency_hz,
      z: spectrogram.level_db,
      zmin: deepest,
      zmax: 0,
      zsmooth: false,
      colorscale: [[0, theme.panel], ...theme.scale.map(([at, colour]) => [0.25 + 0.75 * at, colour])],
      colorbar: barBelow('Level (dB below the highest)', -0.16, { tickvals: [-50, -40, -30, -20, -10, 0], ticktext: ['50', '40', '30', '20', '10', '0'] }),
      hovertemplate: `%{x:.3f}${thinSpace}s, %{y:.1f}${thinSpace}Hz: %{z}${thinSpace}dB<extra></extra>`,
    },
    ...cutLines(monitor, theme, highest),
  ];
  if (marks.time_s.length > 0) {
    const ring = { symbol: 'circle-open', size: 11, color: theme.chatter, line: { width: 2 } };
    data.push(points('chatter reported', marks.time_s, marks.frequency_hz, ring, `%{x:.3f}${thinSpace}s: chatter at %{y:.1f}${thinSpace}Hz`));
  }
  return {
    data,
    layout: layout(theme, 460, {
      showlegend: data.length > 1,
      margin: { l: 72, r: 36, t: 32, b: 108 },
      xaxis: timeAxis(monitor, theme),
      yaxis: axis(theme, 'Frequency (Hz)', { range: [0, highest], exponentformat: 'none' }),
    }),
  };
}

/** About the curve, a hundredth of it at least: a speed that hardly moves is no zigzag. */
function speedRange(stretches: SpeedStretch[]): [number, number] {
  const low = Math.min(...stretches.flatMap(({ low_rpm }) => low_rpm));
  const high = Math.max(...stretches.flatMap(({ high_rpm }) => high_rpm));
  const margin = Math.max(0.08 * (high - low), 0.005 * high);
  return [Math.max(0, low - margin), high + margin];
}

/** The tracked speed between one standard deviation less and more; a gap where it is unknown. */
function speedRow(stretches: SpeedStretch[], index: number, theme: Theme): Stacked {
  const gapped = <T>(of: (stretch: SpeedStretch) => T[]) => stretches.flatMap((stretch) => [...of(stretch), null]);
  const there = gapped(({ time_s }) => time_s);
  const doubtful = stretches.some(({ low_rpm, speed_rpm }) => low_rpm.some((low, i) => low < speed_rpm[i]!));
  return {
    title: 'Speed (rpm)',
    axis: { range: speedRange(stretches), nticks: 5, exponentformat: 'none' },
    traces: [
      ...(doubtful
        ? [
            curve(
              index,
              'speed ± its standard deviation',
              'rpm',
              gapped(({ time_s }) => [...time_s, ...[...time_s].reverse()]),
              gapped(({ low_rpm, high_rpm }) => [...low_rpm, ...[...high_rpm].reverse()]),
              { width: 0 },
              { fill: 'toself', fillcolor: theme.accent, opacity: 0.3, hoverinfo: 'skip', hovertemplate: undefined },
            ),
          ]
        : []),
      curve(index, 'speed', 'rpm', there, gapped(({ speed_rpm }) => speed_rpm), { color: theme.accent, width: 1.4 }, { showlegend: false }),
    ],
  };
}

/** Score against threshold, entropy and tracked speed, one above the other, over the state. */
export function scoreFigure(monitor: Monitor, theme: Theme): Figure {
  const { run_s, score, threshold, energy_entropy } = monitor.decisions;
  const { time_s: time, values } = bandCurves([score, threshold, energy_entropy], run_s);
  const fromZero = { rangemode: 'tozero', nticks: 5, exponentformat: 'SI' };
  const line = (index: number, label: string, y: Num[], style: Layout): Trace => curve(index, label, '', time, y, style, { showlegend: index === 0 });
  const own = { color: theme.accent, width: 1.4 };
  const stretches = speedStretches(monitor);
  const rows: Stacked[] = [
    { title: 'Score', axis: fromZero, traces: [line(0, 'score', values[0]!, own), line(0, 'threshold', values[1]!, { color: theme.chatter, width: 1.4, dash: '6px,4px' })] },
    { title: 'Entropy', axis: fromZero, traces: [line(1, 'entropy', values[2]!, own)] },
    ...(stretches.length > 0 ? [speedRow(stretches, 2, theme)] : []),
  ];
  const { data, axes } = stack(rows, 0.05, theme);
  return {
    data,
    layout: layout(theme, 150 * rows.length + 110, {
      hovermode: 'x',
      margin: { l: 72, r: 36, t: 40, b: 48 },
      xaxis: timeAxis(monitor, theme, { anchor: `y${suffix(rows.length - 1)}` }),
      ...axes,
      shapes: states(monitor, theme),
    }),
  };
}

/** Share found against share of false alarms. */
export function rocFigure(calibration: Calibration, theme: Theme, narrow: boolean): Figure {
  const { status, setting, verifying } = calibration;
  const mark = status === 'found' ? 'chosen' : 'best that was tried';
  const halves: [string, RocPoint[]][] = [
    ['set', setting.roc],
    ['verified', verifying.roc],
  ];
  const hover = `%{x:.2f}${thinSpace}% false, %{y:.1f}${thinSpace}% found`;
  const wrong = (roc: RocPoint[]) => roc.map((point) => scaled(point.false_alarm_rate, 100));
  const found = (roc: RocPoint[]) => roc.map((point) => scaled(point.detection_rate, 100));
  const data = halves.map(([name, roc], i) => {
    const line = { color: seriesColour(theme, i), width: 2, shape: 'hv', dash: i % 2 === 0 ? 'solid' : '7px,3px' };
    return lines(name, wrong(roc), found(roc), line, `${hover} at %{customdata:.4g}`, { customdata: roc.map((point) => point.threshold) });
  });
  data.push(points(mark, wrong([verifying.chosen]), found([verifying.chosen]), { symbol: 'diamond', size: 12, color: theme.chatter }, `${hover}<extra>${mark}</extra>`));
  return {
    data,
    layout: layout(theme, narrow ? 340 : 420, {
      margin: { l: 72, r: 36, t: 32, b: 48 },
      xaxis: axis(theme, 'False alarms (% of stable recordings)', { range: [-2, 102] }),
      yaxis: axis(theme, 'Found (% of chatter recordings)', { range: [-2, 102] }),
    }),
  };
}
