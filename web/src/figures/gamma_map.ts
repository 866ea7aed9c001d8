import type { GammaMap, Num } from '../documents';
import { rangeOf } from '../path_views';
import { axis, barBelow, diverging, layout, lines, points, thinSpace, verticalLine, type Figure, type Layout, type Theme, type Trace } from './theme';

/** Where the scale ends on both sides of zero: how far below it a cut chatters matters less than how far above it stays. */
export function scaleEnd(margin: Num[][]): number {
  const { low, high } = rangeOf(margin.flat());
  return Math.min(1, Math.max(high, Math.min(-low, 0.5))) || 1;
}

/** Five numbers along the scale; its ends say so where a margin is beyond them. */
function scaleTicks(margin: Num[][], end: number): Layout {
  const beyond = (outside: (value: number) => boolean) => margin.some((row) => row.some((value) => value !== null && outside(value)));
  const below = beyond((value) => value < -end) ? `≤${thinSpace}` : '';
  const above = beyond((value) => value > end) ? `≥${thinSpace}` : '';
  const tickvals = [-1, -0.5, 0, 0.5, 1].map((share) => share * end);
  const text = (value: number) => String(Number(value.toPrecision(2))).replace('-', '−');
  return { tickvals, ticktext: tickvals.map((value, i) => `${i === 0 ? below : i === 4 ? above : ''}${text(value)}`) };
}

/** A line over the map with an edge that keeps it apart from every colour. */
function over(map: GammaMap, gamma: Num[], name: string, colour: string, dash: string, theme: Theme): Trace[] {
  if (!gamma.some((value) => value !== null)) return [];
  return [
    lines(name, map.path_mm, gamma, { color: theme.panel, width: 5 }, null, { connectgaps: false, showlegend: false }),
    lines(name, map.path_mm, gamma, { color: colour, width: 2.4, dash }, `${name}: γ %{y:.1f}°`, { connectgaps: false }),
  ];
}

function level(map: GammaMap, at: number, dash: string, theme: Theme, named: boolean): Trace {
  return {
    type: 'contour',
    x: map.path_mm,
    y: map.gamma_deg,
    z: map.margin,
    name: `margin ${at}`,
    contours: { start: at, end: at, size: 1, coloring: 'none' },
    line: { color: theme.text, width: 1.4, dash },
    connectgaps: false,
    showscale: false,
    showlegend: named,
    hoverinfo: 'skip',
  };
}

/** The margin over path and γ, its lines at zero and at what is asked for, γ as programmed and as chosen. `selected` is a column. */
export function gammaFigure(map: GammaMap, selected: number | null, theme: Theme, narrow: boolean): Figure {
  const end = scaleEnd(map.margin);
  const shapes = selected === null ? [] : [verticalLine(map.path_mm[selected]!, { color: theme.text, width: 2 })];
  const data: Trace[] = [
    {
      type: 'heatmap',
      x: map.path_mm,
      y: map.gamma_deg,
      z: map.margin,
      zmin: -end,
      zmax: end,
      zsmooth: false,
      hoverongaps: false,
      customdata: map.margin.map(() => map.block),
      colorscale: diverging(theme.chatter, theme, theme.accent),
      colorbar: barBelow('Stability margin (below 0: chatter)', narrow ? -0.24 : -0.18, scaleTicks(map.margin, end)),
      hovertemplate: `block %{customdata}, %{x:.1f}${thinSpace}mm, γ %{y:.1f}°: margin %{z:.3f}<extra></extra>`,
    },
    level(map, 0, 'solid', theme, !narrow),
  ];
  if (map.least_margin !== null && map.least_margin > 0) data.push(level(map, map.least_margin, 'dot', theme, !narrow));
  data.push(...over(map, map.programmed_deg, 'as programmed', theme.text, '7px,4px', theme), ...over(map, map.chosen_deg, 'chosen', theme.overlay, 'solid', theme));
  if (map.margin.some((row) => row.includes(null))) {
    data.push(points('no posture', [null], [null], { symbol: 'square', size: 11, color: theme.unknown }, null));
  }
  return {
    data,
    layout: layout(theme, narrow ? 460 : 480, {
      hovermode: 'closest',
      uirevision: 'gamma',
      plot_bgcolor: theme.unknown, // shows where the map has no value
      margin: { l: 60, r: 24, t: narrow ? 64 : 36, b: 104 },
      xaxis: axis(theme, 'Along the path (mm)', { showgrid: false, zeroline: false }),
      yaxis: axis(theme, 'γ (°)', { showgrid: false, zeroline: false }),
      shapes,
    }),
  };
}
