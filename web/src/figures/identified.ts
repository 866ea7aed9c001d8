import type { Slot, StiffnessDocument } from '../documents';
import { slotGroups } from '../verb_views';
import { magnitude } from './rows';
import { dashes } from './smooth';
import { axis, directionSeries, layout, lines, logTicks, plain, points, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

const directions = ['x', 'y', 'z'] as const;
const symbols = ['circle', 'square', 'diamond'] as const;

function feeds(slots: Slot[]): number[] {
  return slots.map((slot) => slot.feed_per_tooth_mm);
}

function named({ line }: { line: number }): string {
  return `line ${line}`;
}

/** A direction's own mark. */
function markOf(i: number, theme: Theme): Layout {
  return { symbol: symbols[i], size: 8, color: theme.series[directionSeries[i]!] };
}

/** Mean force over feed: measured as points, fitted as lines, one a depth and speed. */
export function slotsFigure(slots: Slot[], theme: Theme): Figure {
  const groups = slotGroups(slots);
  const data: Trace[] = directions.flatMap((name, i) => {
    const color = theme.series[directionSeries[i]!]!;
    const marker = { symbol: symbols[i], size: 9, color, line: { width: 1, color: theme.panel } };
    const hover = `%{y:.4g}${thinSpace}N at %{x:.4g}${thinSpace}mm, %{text}<extra>${name}</extra>`;
    const measured = points(`${name}, measured`, feeds(slots), slots.map((slot) => slot.force_n[i]!), marker, hover, { legendgroup: name, text: slots.map(named) });
    const fitted = groups.map(({ label, slots: own }, group) => {
      const line = { color, width: 1.6, dash: dashes[group % dashes.length] };
      const force = own.map((slot) => slot.force_n[i]! - slot.residual_n[i]!);
      return lines(`${name}, fitted`, feeds(own), force, line, `fitted %{y:.4g}${thinSpace}N<extra>${plain(label)}</extra>`, { legendgroup: name, showlegend: group === 0 });
    });
    return [measured, ...fitted];
  });
  return {
    data,
    layout: layout(theme, 460, {
      hovermode: 'closest',
      margin: { l: 56, r: 36, t: 48, b: 48 },
      xaxis: axis(theme, 'Feed per tooth (mm)', { rangemode: 'tozero', exponentformat: 'none' }),
      yaxis: axis(theme, 'Mean force (N)', { exponentformat: 'none' }),
    }),
  };
}

/** What the fit leaves of every slot, over the feed. */
export function slotResidualFigure(slots: Slot[], theme: Theme): Figure {
  return {
    data: directions.map((name, i) =>
      points(name, feeds(slots), slots.map((slot) => slot.residual_n[i]!), markOf(i, theme), `%{y:.4g}${thinSpace}N, %{text}<extra>${name}</extra>`, { text: slots.map(named) }),
    ),
    layout: layout(theme, 300, {
      hovermode: 'closest',
      xaxis: axis(theme, 'Feed per tooth (mm)', { rangemode: 'tozero', exponentformat: 'none' }),
      yaxis: axis(theme, 'Measured less fitted (N)', { zerolinecolor: theme.muted, exponentformat: 'none' }),
    }),
  };
}

/** Stiffness of the joints that are known, with twice the deviation on both sides. */
export function jointsFigure({ joint_stiffness_n_m_per_rad: stiffness, std, unit }: StiffnessDocument, theme: Theme): Figure {
  const known = stiffness.flatMap((value, i) => (value === null ? [] : { joint: i + 1, value, spread: 2 * (std[i] ?? 0), unit: unit[i] ?? '' }));
  const units = [...new Set(known.map((joint) => joint.unit))];
  const low = Math.min(...known.map(({ value, spread }) => Math.max(value - spread, 0.1 * value)), Infinity);
  const high = Math.max(...known.map(({ value, spread }) => value + spread), 0);
  const ends: [number, number] = known.length > 0 ? [0.7 * low, 1.4 * high] : [1, 10];
  return {
    data: [
      points('stiffness', known.map(({ joint }) => joint), known.map(({ value }) => value), { symbol: 'circle', size: 10, color: theme.accent }, `joint %{x}: %{y:.4g}${thinSpace}%{text}`, {
        showlegend: false,
        error_y: { type: 'data', array: known.map(({ spread }) => spread), color: theme.muted, thickness: 1.6, width: 7 },
        text: known.map((joint) => plain(joint.unit)),
      }),
    ],
    layout: layout(theme, 340, {
      xaxis: axis(theme, 'Joint', { range: [0.5, stiffness.length + 0.5], tickvals: stiffness.map((_, i) => i + 1) }),
      yaxis: axis(theme, units.length === 1 ? `Stiffness (${plain(units[0]!)})` : 'Stiffness', { type: 'log', range: ends.map(Math.log10), ...logTicks(...ends) }),
    }),
  };
}

/** Displacement of the tool as the joints predict it, over what was measured; on the line they are equal. */
export function displacementFigure({ displacement_mm: measured, residual_mm: residual, line }: StiffnessDocument, theme: Theme): Figure {
  const predicted = measured.map((load, k) => load.map((value, i) => value - (residual[k]?.[i] ?? 0)));
  const most = 1.08 * magnitude([...measured.flat(), ...predicted.flat()]) || 1;
  return {
    data: [
      lines('equal', [-most, most], [-most, most], { color: theme.muted, width: 1.2, dash: '6px,4px' }, null),
      ...directions.map((name, i) => {
        const hover = `measured %{x:.4g}${thinSpace}mm, predicted %{y:.4g}${thinSpace}mm, %{text}<extra>${name}</extra>`;
        return points(name, measured.map((load) => load[i]!), predicted.map((load) => load[i]!), markOf(i, theme), hover, { text: line.map((at) => `line ${at}`) });
      }),
    ],
    layout: layout(theme, 460, {
      hovermode: 'closest',
      xaxis: axis(theme, 'Measured displacement (mm)', { range: [-most, most], exponentformat: 'none' }),
      yaxis: axis(theme, 'Predicted displacement (mm)', { range: [-most, most], exponentformat: 'none' }),
    }),
  };
}
