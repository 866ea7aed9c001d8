import type { Num } from '../documents';
import type { FeedDirections } from '../views';
import { axis, layout, lines, points, rpm, thinSpace, type Figure, type Layout, type Theme } from './theme';

/** Rings at round numbers, three to six of them, the last at or beyond `most`. */
export function rings(most: number): number[] {
  if (!(most > 0)) return [1];
  const rough = most / 4;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * decade).find((size) => size >= rough * 0.999) ?? 10 * decade;
  const count = Math.max(1, Math.ceil(most / step - 1e-9));
  return Array.from({ length: count }, (_, i) => Number(((i + 1) * step).toPrecision(6)));
}

/** Polar to plane: 0° to the right, counter-clockwise. Null radii stay gaps; a full turn is closed. */
export function toPlane(directionDeg: number[], radius: Num[]): { x: Num[]; y: Num[]; radius: Num[]; direction: number[] } {
  const direction = [...directionDeg];
  const r = [...radius];
  const first = direction[0];
  const last = direction[direction.length - 1];
  const step = (direction[1] ?? 360) - (first ?? 0);
  if (first !== undefined && last !== undefined && last - first < 360 && last - first >= 360 - 1.5 * step) {
    direction.push(first + 360);
    r.push(r[0] ?? null);
  }
  const along = (trig: (angle: number) => number) =>
    r.map((value, i) => (value === null ? null : value * trig((direction[i]! * Math.PI) / 180)));
  return { x: along(Math.cos), y: along(Math.sin), radius: r, direction };
}

function frame(most: number, theme: Theme): { shapes: Layout[]; annotations: Layout[] } {
  const shapes: Layout[] = [];
  const annotations: Layout[] = [];
  const line = { color: theme.grid, width: 1 };
  const label = (x: number, y: number, text: string, more: Layout = {}) =>
    annotations.push({ x, y, text, showarrow: false, font: { size: 11, color: theme.muted }, ...more });
  for (const ring of rings(most)) {
    if (ring > most * 1.0001) continue;
    shapes.push({ type: 'circle', x0: -ring, x1: ring, y0: -ring, y1: ring, line, layer: 'below' });
    const angle = (67.5 * Math.PI) / 180;
    label(ring * Math.cos(angle), ring * Math.sin(angle), `${ring}`, { bgcolor: theme.panel, borderpad: 0 });
  }
  for (let degrees = 0; degrees < 360; degrees += 45) {
    const [x, y] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
    shapes.push({ type: 'line', x0: 0, y0: 0, x1: most * x, y1: most * y, line, layer: 'below' });
    const name = degrees === 0 ? ' x' : degrees === 90 ? ' y' : '';
    label(1.13 * most * x, 1.1 * most * y, `${degrees}°${name}`);
  }
  return { shapes, annotations };
}

/** Depth over feed direction; where no limit was found, a hollow marker stands at the searched depth. */
export function polarFigure(feed: FeedDirections, which: 'lowest' | 'speed', theme: Theme, width = 440): Figure {
  const limit = which === 'lowest' ? feed.lowest_limit_mm : (feed.limit_at_speed_mm ?? []);
  const searched = feed.searched_depth_mm;
  const found = limit.filter((depth): depth is number => depth !== null);
  const open = found.length < limit.length;
  const highest = Math.max(0, ...found, open ? (searched ?? 0) : 0);
  const steps = rings(highest);
  const most = steps[steps.length - 1]!;
  const colour = which === 'lowest' ? theme.accent : theme.stable;
  const line = toPlane(feed.direction_deg, limit);
  const { shapes, annotations } = frame(most, theme);
  const data = [
    lines('limit', line.x, line.y, { color: colour, width: 2 }, `%{customdata[0]:.0f}°: %{customdata[1]:.3f}${thinSpace}mm`, {
      mode: 'lines+markers',
      customdata: line.direction.map((degrees, i) => [degrees % 360, line.radius[i]]),
      fill: open ? 'none' : 'toself',
      fillcolor: theme.stableFill,
      connectgaps: false,
      marker: { size: 4, color: colour },
    }),
  ];
  if (open && searched !== null) {
    const beyond = toPlane(feed.direction_deg, limit.map((depth) => (depth === null ? searched : null)));
    const marker = { symbol: 'circle-open', size: 6, color: colour };
    const directions = beyond.direction.map((degrees) => degrees % 360);
    data.push(points(`none up to ${searched} mm`, beyond.x, beyond.y, marker, `%{customdata:.0f}°: no limit up to ${searched}${thinSpace}mm`, { customdata: directions }));
  }
  if (feed.used_direction_deg !== null) {
    const angle = (feed.used_direction_deg * Math.PI) / 180;
    annotations.push({
      x: most * Math.cos(angle),
      y: most * Math.sin(angle),
      ax: 0,
      ay: 0,
      xref: 'x',
      yref: 'y',
      axref: 'x',
      ayref: 'y',
      text: '',
      showarrow: true,
      arrowhead: 3,
      arrowwidth: 1.5,
      arrowcolor: theme.chatter,
      hovertext: `feed of this job: ${feed.used_direction_deg}°`,
    });
  }
  const speed = feed.spindle_speed_rpm === null ? 'one speed' : rpm(feed.spindle_speed_rpm);
  const title = which === 'lowest' ? 'Lowest limit over all speeds (mm)' : `Limit at ${speed} (mm)`;
  const hidden = { visible: false, range: [-1.2 * most, 1.2 * most], fixedrange: true };
  return {
    data,
    layout: layout(theme, Math.min(440, Math.max(240, width)) + (open ? 24 : 0), {
      title: { text: title, font: { size: 14 }, x: 0.5, y: 0.98 },
      margin: { l: 8, r: 28, t: 36, b: 28 },
      hovermode: 'closest',
      showlegend: open,
      legend: { orientation: 'h', yanchor: 'top', y: 0, xanchor: 'center', x: 0.5, font: { size: 12 } },
      xaxis: axis(theme, '', { ...hidden, automargin: false, constrain: 'domain' }),
      yaxis: axis(theme, '', { ...hidden, automargin: false, scaleanchor: 'x', constrain: 'domain' }),
      shapes,
      annotations,
    }),
  };
}
