// The FRF of the hits so far, over those of fewer hits.
import { frfFigure } from '../../figures/frf';
import { lines, type Figure, type Theme } from '../../figures/theme';
import type { Frf } from '../../views';

/** An average of fewer hits. */
export interface Earlier {
  hits: number;
  frfs: Frf[];
}

export function tapFigure(frf: Frf, earlier: Earlier[], logarithmic: boolean, theme: Theme): Figure {
  const { data, layout } = frfFigure(frf, [], logarithmic, theme);
  const before = earlier.flatMap(({ hits, frfs }) => {
    const curve = frfs.find(({ name }) => name === frf.name)?.measured;
    if (!curve) return [];
    const name = `${hits} ${hits === 1 ? 'hit' : 'hits'}`;
    return [lines(name, curve.frequency_hz, curve.magnitude, { color: theme.unknown, width: 0.8 }, null, { yaxis: 'y' })];
  });
  const now = data.map((trace) => (trace['name'] === 'measured' ? { ...trace, line: { color: theme.accent, width: 2 } } : trace));
  return { data: [...before, ...now], layout: { ...layout, uirevision: frf.name } };
}
