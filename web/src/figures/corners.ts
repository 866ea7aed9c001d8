import type { Corner, MotionDocument, SmoothDocument } from '../documents';
import { smoothedBy } from '../smooth_views';
import { dashes } from './smooth';
import { axis, layout, lines, plain, seriesColour, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';
import { colouredPoints, frame, views, viewsLayout } from './track';

/** The programmed path and the tip's, from above and from the side, coloured by speed. */
export function pathFigure({ program, motions }: MotionDocument, theme: Theme, width: number): Figure {
  const track = motions[0]!.tip;
  const both = { x_mm: [...program.x_mm, ...track.x_mm], y_mm: [...program.y_mm, ...track.y_mm], z_mm: [...program.z_mm, ...track.z_mm] };
  const place = frame(both, width);
  const data: Trace[] = views.flatMap((view) => [
    lines('program', program.x_mm, program[`${view.up}_mm`], { color: theme.unknown, width: 1 }, null, { showlegend: false, ...view.axes }),
    colouredPoints(view, track.x_mm, track[`${view.up}_mm`], 3.5, track.speed_mm_per_s, `%{marker.color:.4g}${thinSpace}mm/s`),
  ]);
  return { data, layout: viewsLayout(place, theme, track.x_mm.length > 0 ? 'Speed of the tip (mm/s)' : null) };
}

type Point = [number, number];

/** The moves of a corner that come into its view, cut off at three times its width: what is far outside need not be exact. */
export function movesInView(corner: Corner): [Point, Point][] {
  const far = 3 * corner.radius_mm;
  const moves: [Point, Point][] = [];
  for (let i = 1; i < corner.program.x_mm.length; ++i) {
    let from: Point = [corner.program.x_mm[i - 1]!, corner.program.y_mm[i - 1]!];
    let to: Point = [corner.program.x_mm[i]!, corner.program.y_mm[i]!];
    const cut = (outer: Point, inner: Point): Point => {
      const length = Math.hypot(outer[0] - inner[0], outer[1] - inner[1]);
      const most = far + Math.hypot(inner[0], inner[1]);
      return length <= most ? outer : [inner[0] + ((outer[0] - inner[0]) * most) / length, inner[1] + ((outer[1] - inner[1]) * most) / length];
    };
    if (Math.hypot(...from) > far && Math.hypot(...to) > far) continue;
    if (Math.hypot(...from) > far) from = cut(from, to);
    if (Math.hypot(...to) > far) to = cut(to, from);
    moves.push([from, to]);
  }
  return moves;
}

/** All places within the tolerance of the moves: a strip for each and a disc at each end. */
export function tube(moves: [Point, Point][], tolerance: number, colour: string): Layout[] {
  const shape = { layer: 'below', fillcolor: colour, line: { width: 0 } };
  const disc = ([x, y]: Point): Layout => ({ type: 'circle', ...shape, x0: x - tolerance, x1: x + tolerance, y0: y - tolerance, y1: y + tolerance });
  return moves.flatMap(([from, to]) => {
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (length === 0) return [disc(from)];
    const [nx, ny] = [(-(to[1] - from[1]) * tolerance) / length, ((to[0] - from[0]) * tolerance) / length];
    const path = `M${from[0] + nx},${from[1] + ny}L${to[0] + nx},${to[1] + ny}L${to[0] - nx},${to[1] - ny}L${from[0] - nx},${from[1] - ny}Z`;
    return [{ type: 'path', ...shape, path }, disc(from), disc(to)];
  });
}

/** One corner seen close: the program, its tolerance, and the tip's way by each method. */
export function cornerFigure(smooth: SmoothDocument, { corners, motions }: MotionDocument, index: number, theme: Theme, width: number): Figure {
  const corner = corners[index]!;
  const moves = movesInView(corner);
  const names = smoothedBy(smooth).map(({ method }) => plain(method));
  const several = names.length > 1;
  const along = (k: 0 | 1) => moves.flatMap(([from, to]) => [from[k], to[k], null]);
  const data: Trace[] = [
    lines('program', along(0), along(1), { color: theme.unknown, width: 1.5 }, null, { mode: 'lines+markers', showlegend: several, marker: { size: 5, color: theme.unknown } }),
    ...motions.map(({ corner_paths }, i) => {
      const { x_mm, y_mm } = corner_paths[index]!;
      const line = { color: seriesColour(theme, i), width: 2, dash: dashes[i % dashes.length] };
      return lines(names[i]!, x_mm, y_mm, line, `%{x:.4f}, %{y:.4f}${thinSpace}mm<extra>${names[i]!}</extra>`, { showlegend: several });
    }),
  ];
  const r = corner.radius_mm;
  const square = Math.max(200, Math.min(420, width - 90));
  const more = several ? 22 * Math.ceil((names.length + 1) / Math.max(1, Math.floor(width / 150))) : 0;
  return {
    data,
    layout: layout(theme, square + 92 + more, {
      title: { text: `Line ${corner.line}: ${corner.turn_deg.toFixed(corner.turn_deg < 10 ? 1 : 0)}°`, font: { size: 14 }, x: 0.5, y: 0.98, yanchor: 'top' },
      margin: { l: 64, r: 16, t: 34, b: 52 + more },
      hovermode: 'closest',
      legend: { orientation: 'h', yanchor: 'top', y: -46 / square, xanchor: 'center', x: 0.5, font: { size: 12 } },
      xaxis: axis(theme, 'Along the way (mm)', { range: [-r, r], zeroline: false, nticks: 5, constrain: 'domain' }),
      yaxis: axis(theme, 'To the inside (mm)', { range: [-0.5 * r, 1.5 * r], zeroline: false, nticks: 6, scaleanchor: 'x', scaleratio: 1, constrain: 'domain' }),
      shapes: tube(moves, smooth.tip.limit_error_mm ?? 0, theme.grid),
    }),
  };
}
