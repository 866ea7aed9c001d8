import type { ChartPoint, Cut, DepthCurve, LimitRow, LobesDocument, Num, Recommendation, Verdict } from '../documents';
import { modeName } from '../text';
import type { Lobes } from '../views';
import { highest, magnitude } from './rows';
import { axis, diverging, layout, legendRow, lines, plain, points, rpm, seriesColour, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

export interface LobesInput {
  lobes: Lobes;
  otherLimits: DepthCurve[];
  cuts: Cut[];
  recommendation: Recommendation | null;
  alternatives: Recommendation[];
  points?: ChartPoint[]; // that were asked for
}

const dashes = ['dash', 'dot', 'dashdot', 'longdash'];
const speedAxis = 'Spindle speed (rpm)';
const depthAxis = 'Axial depth (mm)';

/** Of several limits over the spindle speed. */
export function limitsLayout(theme: Theme): Figure['layout'] {
  return layout(theme, 460, {
    hovermode: 'closest',
    margin: { l: 56, r: 36, t: 40, b: 48 },
    xaxis: axis(theme, speedAxis, { tickformat: ',d', hoverformat: '.0f' }),
    yaxis: axis(theme, depthAxis, { rangemode: 'tozero' }),
  });
}

/** The depth up to which a cut is stable at each speed: the limit, or all that was searched where there is none. */
export function stableDepth(lobes: Lobes): number[] {
  const top = searchedDepth(lobes);
  return lobes.limit_mm.map((depth) => depth ?? top);
}

export function searchedDepth(lobes: Lobes): number {
  if (lobes.searched_depth_mm !== null) return lobes.searched_depth_mm;
  return highest(lobes.limit_mm);
}

/** Where the limit lies with all that is uncertain; up to the top where none was found. */
export function bandTraces(lobes: Lobes, theme: Theme): Trace[] {
  const { band } = lobes;
  if (band === null) return [];
  const top = searchedDepth(lobes);
  const side = (depths: Num[], more: Trace) => lines(plain(band.label), band.spindle_speed_rpm, depths.map((depth) => depth ?? top), { width: 0 }, null, more);
  return [side(band.low_mm, { showlegend: false }), side(band.high_mm, { fill: 'tonexty', fillcolor: theme.bandFill })];
}

export function limitTraces(lobes: Lobes, theme: Theme, name = 'limit', colour = theme.text): Trace[] {
  return [
    lines('', lobes.spindle_speed_rpm, stableDepth(lobes), { width: 0 }, null, { fill: 'tozeroy', fillcolor: theme.stableFill, showlegend: false }),
    // A limit at one speed between two without is a point.
    lines(name, lobes.spindle_speed_rpm, lobes.limit_mm, { color: colour, width: 2 }, `limit %{y:.3f}${thinSpace}mm at %{x:.0f}${thinSpace}rpm`, {
      mode: 'lines+markers',
      connectgaps: false,
      marker: { color: colour, size: 2 },
    }),
  ];
}

const looks: { result: Verdict | null; name: string; symbol: string }[] = [
  { result: 'stable', name: 'cut, stable', symbol: 'circle' },
  { result: 'borderline', name: 'cut, borderline', symbol: 'triangle-up' },
  { result: 'chatter', name: 'cut, chatter', symbol: 'x' },
  { result: null, name: 'cut, no result', symbol: 'circle-open' },
];

function verdictColour(theme: Theme, verdict: Verdict | null): string {
  return verdict === null ? theme.unknown : theme[verdict];
}

/** Speeds and depths. */
function placesOf(cuts: { spindle_speed_rpm: number; axial_depth_mm: number }[]): [number[], number[]] {
  return [cuts.map((cut) => cut.spindle_speed_rpm), cuts.map((cut) => cut.axial_depth_mm)];
}

function cutText(cut: Cut): string {
  const text = [`<b>${rpm(cut.spindle_speed_rpm)}, ${cut.axial_depth_mm} mm</b>`, `made: ${cut.result ?? 'not stated'}`, `predicted: ${cut.predicted ?? 'not known'}`];
  if (cut.limit_depth_mm !== null) text.push(`limit here: ${cut.limit_depth_mm.toFixed(3)} mm`);
  if (cut.agrees !== null) text.push(cut.agrees ? 'as predicted' : '<b>not as predicted</b>');
  if (cut.note !== '') text.push(plain(cut.note));
  return text.join('<br>');
}

/** One trace a result, and rings around the cuts that came out otherwise than predicted. */
export function cutTraces(cuts: Cut[], theme: Theme): Trace[] {
  const drawn = (name: string, chosen: Cut[], marker: Layout, hover: string | null): Trace[] =>
    chosen.length === 0 ? [] : [points(`${name} (${chosen.length})`, ...placesOf(chosen), marker, hover, { text: chosen.map(cutText) })];
  const made = looks.flatMap(({ result, name, symbol }): Trace[] => {
    const line = { width: result === null ? 1.5 : 1, color: result === null ? theme.unknown : theme.panel };
    return drawn(name, cuts.filter((cut) => cut.result === result), { symbol, size: 10, color: verdictColour(theme, result), line }, '%{text}');
  });
  return [...made, ...drawn('not as predicted', cuts.filter((cut) => cut.agrees === false), { symbol: 'circle-open', size: 19, color: theme.text, line: { width: 1.5 } }, null)];
}

function recommendationText(r: Recommendation): string {
  const text = [`<b>${rpm(r.spindle_speed_rpm)}, ${r.axial_depth_mm.toFixed(2)} mm</b>`, `${r.removal_rate_mm3_per_s.toPrecision(3)} mm³/s`];
  if (r.limited_by !== '') text.push(`limited by ${plain(r.limited_by)}`);
  return text.join('<br>');
}

function recommendationTraces(input: LobesInput, theme: Theme): Trace[] {
  const traces: Trace[] = [];
  if (input.alternatives.length > 0) {
    const disc = { symbol: 'circle', size: 17, color: theme.panel, line: { width: 1.5, color: theme.accent } };
    traces.push(
      points('alternatives', ...placesOf(input.alternatives), disc, '%{hovertext}<extra>alternative %{text}</extra>', {
        mode: 'markers+text',
        text: input.alternatives.map((_, i) => `${i + 1}`),
        textfont: { size: 10, color: theme.accent },
        hovertext: input.alternatives.map(recommendationText),
      }),
    );
  }
  const best = input.recommendation;
  if (best !== null) {
    const star = { symbol: 'star', size: 18, color: theme.accent, line: { width: 1, color: theme.panel } };
    traces.push(points('recommended', ...placesOf([best]), star, '%{hovertext}<extra>recommended</extra>', { hovertext: [recommendationText(best)] }));
  }
  return traces;
}

/** Points that were asked for; `height`: where each stands. */
export function pointTraces(asked: ChartPoint[], height: (point: ChartPoint) => Num, theme: Theme): Trace[] {
  const looks = [
    { stable: true, name: 'asked for, stable', symbol: 'circle-open', colour: theme.stable },
    { stable: false, name: 'asked for, chatter', symbol: 'x-open', colour: theme.chatter },
  ];
  return looks.flatMap(({ stable, name, symbol, colour }): Trace[] => {
    const chosen = asked.filter((point) => point.stable === stable);
    if (chosen.length === 0) return [];
    const speeds = chosen.map((point) => point.spindle_speed_rpm);
    const marker = { symbol, size: 11, color: colour, line: { width: 2 } };
    return [points(name, speeds, chosen.map(height), marker, `%{x:.0f}${thinSpace}rpm, %{y:.4g}: spectral radius %{customdata:.3f}`, { customdata: chosen.map((point) => point.spectral_radius) })];
  });
}

/** From the recommended point to both axes. */
function guides(best: Recommendation | null, left: number, theme: Theme): Layout[] {
  if (best === null) return [];
  const line = { color: theme.accent, width: 1, dash: 'dot' };
  const { spindle_speed_rpm: x, axial_depth_mm: y } = best;
  return [
    { type: 'line', xref: 'x', yref: 'y', x0: x, x1: x, y0: 0, y1: y, line, layer: 'below' },
    { type: 'line', xref: 'x', yref: 'y', x0: left, x1: x, y0: y, y1: y, line, layer: 'below' },
  ];
}

const kinds = [
  { kind: 'hopf', symbol: 'circle' },
  { kind: 'flip', symbol: 'diamond' },
  { kind: 'fold', symbol: 'square' },
] as const;

/** Chatter frequency along the boundary, coloured by mode; only the points that are the limit at their speed are what occurs first. */
export function frequencyTraces({ boundary }: Lobes, theme: Theme): Trace[] {
  const groups = new Map<string, { mode: number; ofWorkpiece: boolean; points: LimitRow[] }>();
  for (const point of boundary) {
    if (point.chatter_frequency_hz == null) continue;
    const mode = point.mode ?? 0;
    const ofWorkpiece = point.mode_of === 'workpiece';
    const name = modeName(point) || 'mode unknown';
    const group = groups.get(name) ?? { mode, ofWorkpiece, points: [] };
    group.points.push(point);
    groups.set(name, group);
  }
  return [...groups.entries()]
    .sort(([, a], [, b]) => Number(a.ofWorkpiece) - Number(b.ofWorkpiece) || a.mode - b.mode)
    .map(([name, { mode, ofWorkpiece, points }]) => ({
      type: 'scatter',
      mode: 'markers',
      name,
      legend: 'legend2',
      xaxis: 'x2',
      yaxis: 'y2',
      x: points.map((point) => point.spindle_speed_rpm),
      y: points.map((point) => point.chatter_frequency_hz),
      customdata: points.map((point) => [point.kind, point.axial_depth_mm]),
      hovertemplate:
        `chatter at %{y:.1f}${thinSpace}Hz (%{customdata[0]})<br>%{x:.0f}${thinSpace}rpm, ` +
        `%{customdata[1]:.3f}${thinSpace}mm<extra>${mode > 0 ? name : ''}</extra>`,
      marker: {
        size: 4,
        color: mode > 0 ? seriesColour(theme, mode - 1) : theme.unknown,
        symbol: points.map((point) => (kinds.find((k) => k.kind === point.kind)?.symbol ?? 'circle') + (ofWorkpiece ? '-open' : '')),
      },
    }));
}

function speedRange(lobes: Lobes): [number, number] {
  return [lobes.spindle_speed_rpm[0] ?? 0, lobes.spindle_speed_rpm[lobes.spindle_speed_rpm.length - 1] ?? 1];
}

/** Top of the depth axis: what was searched, or the highest point that must be seen. */
export function depthTop(input: LobesInput): number {
  const shown: Num[] = [searchedDepth(input.lobes), input.recommendation?.axial_depth_mm ?? 0];
  for (const cut of input.cuts) shown.push(cut.axial_depth_mm);
  for (const point of input.points ?? []) shown.push(point.axial_depth_mm ?? null);
  return 1.04 * highest(shown);
}

/** The other limits that come into view at all. */
export function visibleLimits(input: LobesInput): DepthCurve[] {
  const top = depthTop(input);
  return input.otherLimits.filter((curve) => curve.axial_depth_mm.some((depth) => depth <= top));
}

export function lobesFigure(input: LobesInput, theme: Theme, narrow: boolean): Figure {
  const { lobes } = input;
  const frequencies = frequencyTraces(lobes, theme);
  const two = frequencies.length > 0;
  const data: Trace[] = [
    ...bandTraces(lobes, theme),
    ...limitTraces(lobes, theme),
    ...visibleLimits(input).map(({ label, spindle_speed_rpm: speed, axial_depth_mm: depth }, i) =>
      lines(plain(label), speed, depth, { color: theme.muted, width: 1.5, dash: dashes[i % dashes.length] }, `${plain(label)}: %{y:.3f}${thinSpace}mm`),
    ),
    ...cutTraces(input.cuts, theme),
    ...pointTraces(input.points ?? [], (point) => point.axial_depth_mm ?? null, theme),
    ...recommendationTraces(input, theme),
    ...frequencies,
  ];
  const [left, right] = speedRange(lobes);
  const speeds = { range: [left, right], hoverformat: '.0f', tickformat: ',d' };
  return {
    data,
    layout: layout(theme, two ? (narrow ? 700 : 720) : 480, {
      hovermode: 'closest',
      xaxis: axis(theme, two ? '' : speedAxis, { ...speeds, showticklabels: !two, anchor: 'y' }),
      yaxis: axis(theme, depthAxis, { range: [0, depthTop(input)], domain: two ? [0.42, 1] : [0, 1] }),
      ...(two
        ? {
            xaxis2: axis(theme, speedAxis, { ...speeds, anchor: 'y2', matches: 'x' }),
            yaxis2: axis(theme, 'Chatter frequency (Hz)', { domain: [0, 0.3], anchor: 'x2' }),
            legend2: legendRow({ y: 0.31 }),
          }
        : {}),
      shapes: guides(input.recommendation, left, theme),
    }),
  };
}

/** Some modes alone, over the limit of all in grey. */
export function pairFigure(part: Lobes, all: Lobes, cuts: Cut[], theme: Theme): Figure {
  return {
    data: [
      lines('all modes', all.spindle_speed_rpm, all.limit_mm, { color: theme.unknown, width: 1.2 }, null),
      ...limitTraces(part, theme, plain(part.label), theme.accent),
      ...cutTraces(cuts, theme).map((trace) => ({ ...trace, showlegend: false })),
    ],
    layout: layout(theme, 320, {
      title: { text: plain(part.label), font: { size: 14 }, x: 0.02, xanchor: 'left', y: 0.97 },
      margin: { l: 52, r: 32, t: 34, b: 44 },
      showlegend: false,
      hovermode: 'closest',
      xaxis: axis(theme, speedAxis, { range: speedRange(all), tickformat: ',d' }),
      yaxis: axis(theme, depthAxis, { range: [0, 1.04 * Math.max(searchedDepth(part), searchedDepth(all))] }),
    }),
  };
}

/** Values of a grid, a row an y. */
interface Grid {
  x: number[];
  y: number[];
  z: Num[][];
}

/** The spectral radius on a grid, with the line where it is 1. */
export function radiusMap(points: Grid, height: { title: string; unit: string }, theme: Theme): Figure {
  return {
    data: [
      {
        type: 'heatmap',
        ...points,
        zmid: 1,
        zmin: 0,
        zmax: 2,
        colorscale: diverging(theme.accent, theme, theme.chatter),
        colorbar: { title: { text: 'Spectral radius', side: 'right' }, thickness: 12, outlinewidth: 0 },
        hovertemplate: `%{x:.0f}${thinSpace}rpm, %{y:.3f}${height.unit}: %{z:.3f}<extra></extra>`,
      },
      {
        type: 'contour',
        ...points,
        contours: { start: 1, end: 1, size: 1, coloring: 'none' },
        line: { color: theme.text, width: 2 },
        showscale: false,
        hoverinfo: 'skip',
      },
    ],
    layout: layout(theme, 460, {
      xaxis: axis(theme, speedAxis, { tickformat: ',d' }),
      yaxis: axis(theme, height.title),
    }),
  };
}

const depths = { title: depthAxis, unit: `${thinSpace}mm` };

/** The spectral radius over speed and depth. */
export function mapFigure({ map }: Lobes, theme: Theme): Figure {
  if (map === null) return { data: [], layout: layout(theme, 200) };
  return radiusMap({ x: map.spindle_speed_rpm, y: map.axial_depth_mm, z: map.spectral_radius }, depths, theme);
}

/** The error of the surface over speed and depth, where a cut is stable. */
export function surfaceFigure(surface: NonNullable<LobesDocument['surface']>, theme: Theme): Figure {
  const z = surface.surface_location_error_um;
  const most = magnitude(z.flat()) || 1;
  return {
    data: [
      {
        type: 'heatmap',
        x: surface.spindle_speed_rpm,
        y: surface.axial_depth_mm,
        z,
        zmin: -most,
        zmax: most,
        hoverongaps: false,
        colorscale: diverging(theme.accent, theme, theme.chatter),
        colorbar: { title: { text: 'Surface error (µm)', side: 'right' }, thickness: 12, outlinewidth: 0 },
        hovertemplate: `%{x:.0f}${thinSpace}rpm, %{y:.3f}${thinSpace}mm: %{z:.2f}${thinSpace}µm<extra></extra>`,
      },
    ],
    layout: layout(theme, 460, {
      plot_bgcolor: theme.unknown, // shows where a cut chatters
      xaxis: axis(theme, speedAxis, { tickformat: ',d', showgrid: false }),
      yaxis: axis(theme, depthAxis, { showgrid: false }),
    }),
  };
}
