import type { Calibration, Monitor, RocPoint } from '../documents';
import { bandCurves } from '../bands';
import { curve, suffix } from './rows';
import { axis, layout, plain, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

/** Where the monitor said chatter, as shaded stretches over the whole height. */
export function alarms(monitor: Monitor, theme: Theme): Layout[] {
  return monitor.stays
    .filter((stay) => stay.state !== 'stable')
    .map((stay) => ({
      type: 'rect',
      xref: 'x',
      yref: 'paper',
      x0: stay.from_s,
      x1: stay.to_s,
      y0: 0,
      y1: 1,
      layer: 'below',
      fillcolor: stay.state === 'chatter' ? theme.chatter : theme.borderline,
      opacity: 0.16,
      line: { width: 0 },
    }));
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
export function waveFigure(monitor: Monitor, theme: Theme): Figure {
  const unit = plain(monitor.unit);
  const { time_s: time, values } = bandCurves(monitor.channels.map((channel) => channel.wave), monitor.wave_run_s);
  const data: Trace[] = monitor.channels.map((channel, i) => ({
    type: 'scatter',
    mode: 'lines',
    name: plain(channel.name),
    x: time,
    y: values[i],
    opacity: monitor.channels.length > 1 ? 0.7 : 1,
    line: { color: theme.series[i % theme.series.length], width: 0.8 },
    hovertemplate: `%{x:.3f}${thinSpace}s: %{y:.4g}${thinSpace}${unit}<extra></extra>`,
  }));
  return {
    data,
    layout: layout(theme, 240, {
      showlegend: data.length > 1,
      margin: { l: 72, r: 36, t: data.length > 1 ? 32 : 16, b: 48 },
      xaxis: timeAxis(monitor, theme),
      yaxis: axis(theme, unit === '' ? 'Signal' : `Signal (${unit})`, { exponentformat: 'none' }),
      shapes: alarms(monitor, theme),
    }),
  };
}

const deepest = -50; // dB; below, noise hides what stands above it

/** The synchrosqueezed spectrogram, with the frequencies that were reported. */
export function spectrogramFigure(monitor: Monitor, theme: Theme): Figure {
  const spectrogram = monitor.spectrogram!;
  const columns = spectrogram.level_db[0]?.length ?? 0;
  const reported = monitor.events.filter((event) => event.event === 'state' && event.state === 'chatter' && event.chatter_frequency_hz !== null);
  const last = spectrogram.frequency_hz[spectrogram.frequency_hz.length - 1] ?? 1;
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
      colorbar: { title: { text: 'dB', side: 'top' }, thickness: 12, outlinewidth: 0 },
      hovertemplate: `%{x:.3f}${thinSpace}s, %{y:.1f}${thinSpace}Hz: %{z}${thinSpace}dB<extra></extra>`,
    },
    {
      type: 'scatter',
      mode: 'markers',
      name: 'reported',
      x: reported.map((event) => event.time_s),
      y: reported.map((event) => event.chatter_frequency_hz),
      marker: { symbol: 'circle-open', size: 11, color: theme.chatter, line: { width: 2 } },
      showlegend: false,
      hovertemplate: `%{x:.3f}${thinSpace}s: chatter at %{y:.1f}${thinSpace}Hz<extra></extra>`,
    },
  ];
  return {
    data,
    layout: layout(theme, 380, {
      margin: { l: 72, r: 12, t: 16, b: 48 },
      xaxis: timeAxis(monitor, theme),
      yaxis: axis(theme, 'Frequency (Hz)', { range: [0, last], exponentformat: 'none' }),
    }),
  };
}

interface Row {
  title: string;
  unit: string;
  y: number[];
  against: number[] | null;
}

/** Score against threshold, entropy and tracked speed, one above the other. */
export function scoreFigure(monitor: Monitor, theme: Theme): Figure {
  const { run_s, score, threshold, energy_entropy, spindle_speed_rpm } = monitor.decisions;
  const { time_s: time, values } = bandCurves([score, threshold, energy_entropy, spindle_speed_rpm], run_s);
  const rows: Row[] = [
    { title: 'Score', unit: '', y: values[0]!, against: values[1]! },
    { title: 'Entropy', unit: '', y: values[2]!, against: null },
  ];
  if (spindle_speed_rpm.high.some((speed) => speed > 0)) rows.push({ title: 'Speed', unit: 'rpm', y: values[3]!, against: null });
  const data: Trace[] = [];
  const axes: Layout = {};
  rows.forEach((row, index) => {
    const line = (label: string, y: number[], style: object): Trace =>
      curve(index, label, row.unit, time, y, style, { showlegend: index === 0 });
    data.push(line(row.title.toLowerCase(), row.y, { color: theme.accent, width: 1.4 }));
    if (row.against) data.push(line('threshold', row.against, { color: theme.chatter, width: 1.4, dash: '6px,4px' }));
    const top = 1 - index / rows.length;
    axes[`yaxis${suffix(index)}`] = axis(theme, row.unit === '' ? row.title : `${row.title} (${row.unit})`, {
      domain: [index === rows.length - 1 ? 0 : top - 1 / rows.length + 0.05, top],
      nticks: 5,
      rangemode: 'tozero',
      exponentformat: 'SI',
    });
  });
  return {
    data,
    layout: layout(theme, 150 * rows.length + 110, {
      hovermode: 'x',
      margin: { l: 72, r: 36, t: 40, b: 48 },
      xaxis: timeAxis(monitor, theme, { anchor: `y${suffix(rows.length - 1)}` }),
      ...axes,
      shapes: alarms(monitor, theme),
    }),
  };
}

/** Share found against share of false alarms. */
export function rocFigure(calibration: Calibration, theme: Theme, narrow: boolean): Figure {
  const { setting, verifying } = calibration;
  const halves: [string, RocPoint[]][] = [
    ['set', setting.roc],
    ['verified', verifying.roc],
  ];
  const data: Trace[] = halves.map(([name, roc], i) => ({
    type: 'scatter',
    mode: 'lines',
    name,
    x: roc.map((point) => 100 * point.false_alarm_rate),
    y: roc.map((point) => 100 * point.detection_rate),
    customdata: roc.map((point) => point.threshold),
    line: { color: theme.series[i % theme.series.length], width: 2, shape: 'hv', dash: i % 2 === 0 ? 'solid' : '7px,3px' },
    hovertemplate: `%{x:.2f}${thinSpace}% false, %{y:.1f}${thinSpace}% found at %{customdata:.4g}<extra></extra>`,
  }));
  data.push({
    type: 'scatter',
    mode: 'markers',
    name: 'chosen',
    x: [100 * verifying.chosen.false_alarm_rate],
    y: [100 * verifying.chosen.detection_rate],
    marker: { symbol: 'diamond', size: 12, color: theme.chatter },
    hovertemplate: `%{x:.2f}${thinSpace}% false, %{y:.1f}${thinSpace}% found<extra>chosen</extra>`,
  });
  return {
    data,
    layout: layout(theme, narrow ? 340 : 420, {
      margin: { l: 72, r: 36, t: 32, b: 48 },
      xaxis: axis(theme, 'False alarms (% of stable recordings)', { range: [-2, 102] }),
      yaxis: axis(theme, 'Found (% of chatter recordings)', { range: [-2, 102] }),
    }),
  };
}
