import type { Fit } from '../documents';
import { axis, layout, thinSpace, type Figure, type Theme } from './theme';

export function convergenceFigure(fit: Fit, theme: Theme): Figure {
  const positive = fit.convergence.every((value) => value === null || value > 0);
  return {
    data: [
      {
        type: 'scatter',
        mode: 'lines',
        name: 'best',
        x: fit.convergence.map((_, i) => i + 1),
        y: fit.convergence,
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

export function stabilisationFigure(fit: Fit, theme: Theme): Figure {
  const poles = fit.stabilisation;
  const chosen = (stable: boolean) => (poles === null ? [] : poles.order.map((_, i) => i).filter((i) => poles.stable[i] === stable));
  const points = (indices: number[]) => ({
    type: 'scatter',
    mode: 'markers',
    x: indices.map((i) => poles!.frequency_hz[i]),
    y: indices.map((i) => poles!.order[i]),
    hovertemplate: `%{x:.2f}${thinSpace}Hz, order %{y}<extra></extra>`,
  });
  return {
    data: [
      { ...points(chosen(false)), name: 'new or moving', marker: { symbol: 'x-thin', size: 6, color: theme.unknown, line: { width: 1, color: theme.unknown } } },
      { ...points(chosen(true)), name: 'stable', marker: { symbol: 'circle', size: 6, color: theme.stable } },
    ],
    layout: layout(theme, 420, {
      hovermode: 'closest',
      xaxis: axis(theme, 'Frequency (Hz)'),
      yaxis: axis(theme, 'Model order'),
    }),
  };
}
