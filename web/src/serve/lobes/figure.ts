// The lobes, or the map of a sweep, as a figure that keeps its place while it moves.
import type { SweepDocument } from '../../documents';
import { lobesFigure } from '../../figures/lobes';
import { sweepFigure } from '../../figures/sweep';
import { plain, type Figure, type Theme } from '../../figures/theme';
import { sweptOf } from '../../verb_views';
import type { Lobes } from '../../views';
import { sweptRanges } from './swept';

export interface LiveFigureInput {
  lobes: Lobes;
  name: string; // of its limit
  kept: { lobes: Lobes; name: string } | null; // overlaid
  moving: boolean; // with less to draw
}

const both = 430; // from this height on the frequencies have room below the depths

/** As high as the window permits, with what stands above the chart. */
export function chartHeight(window_px: number): number {
  return Math.min(640, Math.max(200, window_px - 245));
}

export function liveFigure({ lobes, name, kept, moving }: LiveFigureInput, theme: Theme, height: number): Figure {
  const shown = height < both ? { ...lobes, boundary: [] } : lobes;
  const { data, layout } = lobesFigure({ lobes: shown, otherLimits: [], cuts: [], recommendation: null, alternatives: [] }, theme, false);
  const limit = { name: plain(name), mode: moving ? 'lines' : 'lines+markers', line: { color: theme.accent, width: 2 }, marker: { color: theme.accent, size: 2 } };
  const named = data.map((trace) => (trace['name'] === 'limit' ? { ...trace, ...limit } : trace));
  if (kept) {
    named.push({
      type: 'scatter',
      mode: 'lines',
      name: plain(`kept: ${kept.name}`),
      x: kept.lobes.spindle_speed_rpm,
      y: kept.lobes.limit_mm,
      connectgaps: false,
      line: { color: theme.overlay, width: 2, dash: '6px,4px' },
      hovertemplate: 'kept: %{y:.3f} mm at %{x:.0f} rpm<extra></extra>',
    });
  }
  const margin = { l: 56, r: 36, t: 10, b: 44 };
  return { data: named, layout: { ...layout, height, margin, uirevision: 'lobes', hovermode: kept ? 'x' : 'closest', showlegend: kept !== null || height >= both } };
}

export interface LiveSweepInput {
  sweep: SweepDocument;
  kept: { sweep: SweepDocument; name: string } | null; // whose line is overlaid
}

/** The spectral radius over speed and what is swept. Its axes do not follow the values, so that the point keeps its place. */
export function liveSweepFigure({ sweep, kept }: LiveSweepInput, theme: Theme, height: number): Figure {
  const { data, layout } = sweepFigure({ ...sweep, points: [] }, theme);
  const { speed, depth } = sweptRanges(sweep);
  const axis = (name: string, range: [number, number]) => ({ ...(layout[name] as object), range, autorange: false });
  const drawn = [...data];
  if (kept && kept.sweep.sweep === sweep.sweep) {
    drawn.push({
      type: 'contour',
      name: plain(`kept: ${kept.name}`),
      x: kept.sweep.spindle_speed_rpm,
      y: sweptOf(kept.sweep).values,
      z: kept.sweep.spectral_radius,
      contours: { start: 1, end: 1, size: 1, coloring: 'none' },
      line: { color: theme.overlay, width: 2, dash: 'dash' },
      showscale: false,
      showlegend: true,
      hoverinfo: 'skip',
    });
  }
  const margin = { l: 56, r: 36, t: 10, b: 44 };
  return { data: drawn, layout: { ...layout, height, margin, uirevision: 'sweep', showlegend: kept !== null, xaxis: axis('xaxis', speed), yaxis: axis('yaxis', depth) } };
}

/** Where in a drawn figure its depth plot lies, in pixels, and what it spans. */
export interface Frame {
  left: number;
  top: number;
  width: number;
  height: number;
  x: [number, number];
  y: [number, number];
}

interface DrawnAxis {
  _offset: number;
  _length: number;
  range: [number, number];
}

/** What Plotly knows of a figure that it drew; null before. */
export function frameOf(root: HTMLElement): Frame | null {
  const drawn = (root as { _fullLayout?: { xaxis?: DrawnAxis; yaxis?: DrawnAxis } })._fullLayout;
  if (!drawn?.xaxis || !drawn.yaxis) return null;
  const { xaxis, yaxis } = drawn;
  return {
    left: root.offsetLeft + xaxis._offset,
    top: root.offsetTop + yaxis._offset,
    width: xaxis._length,
    height: yaxis._length,
    x: [...xaxis.range],
    y: [...yaxis.range],
  };
}

/** In pixels, kept inside the frame. */
export function toPixels({ left, top, width, height, x, y }: Frame, [speed, depth]: [number, number]): [number, number] {
  const share = (value: number, [low, high]: [number, number]) => Math.min(1, Math.max(0, (value - low) / (high - low)));
  return [left + width * share(speed, x), top + height * (1 - share(depth, y))];
}

export function fromPixels({ left, top, width, height, x, y }: Frame, [across, down]: [number, number]): [number, number] {
  return [x[0] + ((across - left) / width) * (x[1] - x[0]), y[1] - ((down - top) / height) * (y[1] - y[0])];
}
