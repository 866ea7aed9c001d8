import type { PosturesDocument } from '../documents';
import { dashes } from './smooth';
import { limitsLayout } from './lobes';
import { lines, seriesColour, thinSpace, type Figure, type Theme } from './theme';

/** The limit in each posture, over the spindle speed. */
export function posturesFigure({ spindle_speed_rpm: speed, postures }: PosturesDocument, theme: Theme): Figure {
  return {
    data: postures.map(({ number, limit_mm: limit }, i) => {
      const name = `posture ${number}`;
      const line = { color: seriesColour(theme, i), width: 1.8, dash: dashes[i % dashes.length] };
      return lines(name, speed, limit, line, `%{y:.4g}${thinSpace}mm at %{x:.0f}${thinSpace}rpm<extra>${name}</extra>`, { connectgaps: false });
    }),
    layout: limitsLayout(theme),
  };
}
