import type { Num, Pole } from '../documents';
import { axis, layout, thinSpace, type Figure, type Theme } from './theme';

export function convergenceFigure(best: Num[], theme: Theme): Figure {
  const positive = best.every((value) => value === null || value > 0);
  return {
    data: [
      {
        type: 'scatter',
        mode: 'lines',
        name: 'best',
        x: best.map((_, i) => i + 1),
        y: best,
        line: { color: theme.accent, width: 2 },
        hovertemplate: 'iteration %{x}: %{y:.4g}<extra></extra>',
      },
    ],
    layout: layout(theme, 320, {
      xaxis: axis(theme, 'Iteration'),
      yaxis: axis(theme, 'Best objective', { type: positive ? 'log' : 'linear', exponentformat: 'power' }),
    }),
  };
}

export function stabilisationFigure(poles: Pole[], theme: Theme): Figure {
  const points = (stable: boolean) => {
    const shown = poles.filter((pole) => pole.stable === stable);
    return {
      type: 'scatter',
      mode: 'markers',
      x: shown.map((pole) => pole.frequency_hz),
      y: shown.map((pole) => pole.order),
      hovertemplate: `%{x:.2f}${thinSpace}Hz, order %{y}<extra></extra>`,
    };
  };
  return {
    data: [
      { ...points(false), name: 'new or moving', marker: { symbol: 'x-thin', size: 6, color: theme.unknown, line: { width: 1, color: theme.unknown } } },
      { ...points(true), name: 'stable', marker: { symbol: 'circle', size: 6, color: theme.stable } },
    ],
    layout: layout(theme, 420, {
      hovermode: 'closest',
      xaxis: axis(theme, 'Frequency (Hz)'),
      yaxis: axis(theme, 'Model order'),
    }),
  };
}
