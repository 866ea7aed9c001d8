// The lobes, or the map of a sweep, as a figure that keeps its place while it moves.
import type { SweepDocument } from '../../documents';
import { lobesFigure } from '../../figures/lobes';
import { sweepFigure } from '../../figures/sweep';
import { lines, plain, type Figure, type Theme } from '../../figures/theme';
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
    const { spindle_speed_rpm: speed, limit_mm: limit } = kept.lobes;
    named.push(lines(plain(`kept: ${kept.name}`), speed, limit, { color: theme.overlay, width: 2, dash: '6px,4px' }, 'kept: %{y:.3f} mm at %{x:.0f} rpm', { connectgaps: false }));
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
