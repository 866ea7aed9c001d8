import type { ComparisonDocument, SweepDocument } from '../documents';
import { sweptOf } from '../verb_views';
import { dashes } from './smooth';
import { limitsLayout, pointTraces, radiusMap } from './lobes';
import { lines, plain, seriesColour, thinSpace, type Figure, type Theme } from './theme';

/** The spectral radius over speed and what is swept, with the points that were asked for. */
export function sweepFigure(sweep: SweepDocument, theme: Theme): Figure {
  const { name, unit, values, valueOf } = sweptOf(sweep);
  const height = { title: `${name} (${unit})`, unit: unit === '°' ? unit : `${thinSpace}${unit}` };
  const { data, layout: whole } = radiusMap({ x: sweep.spindle_speed_rpm, y: values, z: sweep.spectral_radius }, height, theme);
  return { data: [...data, ...pointTraces(sweep.points, valueOf, theme)], layout: { ...whole, hovermode: 'closest' } };
}

/** The limit by each method that takes the cut. */
export function comparisonFigure({ spindle_speed_rpm: speed, methods }: ComparisonDocument, theme: Theme): Figure {
  const taken = methods.filter(({ limit_mm: limit }) => limit.length > 0);
  return {
    data: taken.map(({ method, limit_mm: limit }, i) => {
      const color = seriesColour(theme, i);
      const line = { color, width: i === 0 ? 3 : 1.6, dash: dashes[i % dashes.length] };
      const more = { mode: 'lines+markers', connectgaps: false, marker: { size: i === 0 ? 5 : 4, color } };
      return lines(plain(method), speed, limit, line, `%{y:.4g}${thinSpace}mm at %{x:.0f}${thinSpace}rpm<extra>${plain(method)}</extra>`, more);
    }),
    layout: limitsLayout(theme),
  };
}
