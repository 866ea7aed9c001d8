import type { BlockColumns, LimitOver, Num } from '../documents';
import { isUnstable, numberAt, thinned } from '../path_views';
import { highest } from './rows';
import { axis, layout, lines, points, thinSpace, verticalLine, type Figure, type Layout, type Theme, type Trace } from './theme';

/** Limit with its band and programmed depth over the number of the block; unstable blocks are marked, the selected one has a line. */
export function limitFigure(columns: BlockColumns, selected: number | null, theme: Theme): Figure {
  const count = columns.block.length;
  const none: Num[] = [];
  const { limit_depth_mm: limit = none, limit_5_percent_mm: low = none, limit_95_percent_mm: high = none, axial_depth_mm: depth = none } = columns;
  const keep = thinned([limit, low, high, depth], count);
  const x = keep.map((i) => columns.block[i]!);
  const of = (column: Num[]) => keep.map((i) => numberAt(column, i));
  const data: Trace[] = [];
  if (low.length > 0) {
    // A polygon a stretch: where one end is not known there is no band.
    const band = stretches(keep, low, high);
    for (const [i, part] of band.entries()) {
      const at = part.map((index) => columns.block[index]!);
      const edge = [...part.map((index) => low[index]!), ...part.map((index) => high[index]!).reverse()];
      data.push(lines('5 – 95 %', [...at, ...at.slice().reverse()], edge, { width: 0 }, null, { fill: 'toself', fillcolor: theme.bandFill, legendgroup: 'band', showlegend: i === 0 }));
    }
  }
  data.push(
    lines('limit depth', x, of(limit), { color: theme.accent, width: 1.6 }, `limit %{y:.4g}${thinSpace}mm`),
    lines('programmed depth', x, of(depth), { color: theme.text, width: 1.2, dash: '5px,3px' }, `block %{x}: depth %{y:.4g}${thinSpace}mm`),
  );
  const bad = keep.filter((i) => isUnstable(columns, i));
  if (bad.length > 0) {
    const cross = { symbol: 'x', size: 6, color: theme.chatter };
    data.push(points('unstable', bad.map((i) => columns.block[i]!), bad.map((i) => numberAt(depth, i)), cross, 'unstable'));
  }
  const most = highest([limit, low, depth].flat()); // the upper edge of the band may be far above everything
  const shapes = selected === null ? [] : [verticalLine(columns.block[selected]!, { color: theme.muted, width: 2 })];
  return {
    data,
    layout: layout(theme, 340, {
      hovermode: 'x',
      uirevision: 'blocks',
      margin: { l: 64, r: 36, t: 36, b: 48 },
      xaxis: axis(theme, 'Block', { tickformat: 'd' }),
      yaxis: axis(theme, 'Axial depth (mm)', { range: [0, 1.15 * most || 1] }),
      shapes,
    }),
  };
}

/** Runs of neighbours in which both columns have a value. */
export function stretches(keep: number[], low: Num[], high: Num[]): number[][] {
  const out: number[][] = [];
  let open = false;
  for (const i of keep) {
    const known = numberAt(low, i) !== null && numberAt(high, i) !== null;
    if (known && open) out[out.length - 1]!.push(i);
    else if (known) out.push([i]);
    open = known;
  }
  return out;
}

const names: Record<LimitOver['parameter'], string> = { x_mm: 'x (mm)', y_mm: 'y (mm)', z_mm: 'z (mm)', gamma_deg: 'γ (°)' };

/** The limit over one coordinate, all of them with the same vertical axis. */
export function overFigure(scan: LimitOver, most: number, depth: Num, theme: Theme): Figure {
  const shapes: Layout[] = depth === null ? [] : [{ type: 'line', xref: 'paper', yref: 'y', x0: 0, x1: 1, y0: depth, y1: depth, line: { color: theme.text, width: 1.2, dash: '5px,3px' } }];
  return {
    data: [
      lines('limit depth', scan.value, scan.limit_depth_mm, { color: theme.accent, width: 1.6 }, `%{y:.4g}${thinSpace}mm at %{x:.5g}`, { mode: 'lines+markers', showlegend: false, marker: { size: 5 } }),
    ],
    layout: layout(theme, 240, {
      margin: { l: 60, r: 20, t: 12, b: 46 },
      xaxis: axis(theme, names[scan.parameter], { zeroline: false }),
      yaxis: axis(theme, 'Limit depth (mm)', { range: [0, 1.08 * most || 1] }),
      shapes,
    }),
  };
}

/** The deepest of all limits and of this depth. */
export function deepest(scans: LimitOver[], depth: Num): number {
  return highest([depth, ...scans.flatMap((scan) => scan.limit_depth_mm)]);
}
