import type { Num, Pole } from '../documents';
import { axis, layout, lines, points, thinSpace, type Figure, type Layout, type Theme } from './theme';

export function convergenceFigure(best: Num[], theme: Theme): Figure {
  const positive = best.every((value) => value === null || value > 0);
  return {
    data: [lines('best', best.map((_, i) => i + 1), best, { color: theme.accent, width: 2 }, 'iteration %{x}: %{y:.4g}')],
    layout: layout(theme, 320, {
      xaxis: axis(theme, 'Iteration'),
      yaxis: axis(theme, 'Best objective', { type: positive ? 'log' : 'linear', exponentformat: 'power' }),
    }),
  };
}

export function stabilisationFigure(poles: Pole[], theme: Theme): Figure {
  const marked = (name: string, stable: boolean, marker: Layout) => {
    const shown = poles.filter((pole) => pole.stable === stable);
    return points(name, shown.map((pole) => pole.frequency_hz), shown.map((pole) => pole.order), marker, `%{x:.2f}${thinSpace}Hz, order %{y}`);
  };
  return {
    data: [
      marked('new or moving', false, { symbol: 'x-thin', size: 6, color: theme.unknown, line: { width: 1, color: theme.unknown } }),
      marked('stable', true, { symbol: 'circle', size: 6, color: theme.stable }),
    ],
    layout: layout(theme, 420, {
      hovermode: 'closest',
      xaxis: axis(theme, 'Frequency (Hz)'),
      yaxis: axis(theme, 'Model order'),
    }),
  };
}
