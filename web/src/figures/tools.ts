import type { Num, ToolRow } from '../documents';
import { stack, suffix } from './rows';
import { axis, layout, plain, thinSpace, type Figure, type Theme } from './theme';

interface Bars {
  title: string;
  unit: string;
  values: Num[];
}

const longest = 18; // of a name below its bars

function shortened(name: string): string {
  const letters = [...name];
  return plain(letters.length > longest ? `${letters.slice(0, longest - 1).join('')}…` : name);
}

/** What the tools come to, one above the other: compliance, and where a cut is given limit and removal rate. */
export function toolsFigure(tools: ToolRow[], theme: Theme): Figure {
  const all: Bars[] = [
    { title: 'Peak (µm/N)', unit: 'µm/N', values: tools.map((tool) => tool.peak_um_per_n) },
    { title: 'Lowest limit (mm)', unit: 'mm', values: tools.map((tool) => tool.lowest_limit_mm) },
    { title: 'Removal (mm³/s)', unit: 'mm³/s', values: tools.map((tool) => tool.recommended?.removal_rate_mm3_per_s ?? null) },
  ];
  const rows = all.filter(({ values }) => values.some((value) => value !== null));
  const places = tools.map((_, i) => i + 1);
  const { data, axes } = stack(
    rows.map(({ title, unit, values }, index) => {
      const bars = { type: 'bar', name: title, x: places, y: values, yaxis: `y${suffix(index)}`, marker: { color: theme.accent } };
      const named = { customdata: tools.map(({ tool }) => plain(tool)), hovertemplate: `%{customdata}: %{y:.4g}${thinSpace}${unit}<extra></extra>` };
      return { title, traces: [{ ...bars, ...named }], axis: { rangemode: 'tozero', nticks: 5, exponentformat: 'none' } };
    }),
    0.05,
    theme,
  );
  return {
    data,
    layout: layout(theme, 170 * rows.length + 90, {
      showlegend: false,
      bargap: 0.5,
      margin: { l: 72, r: 36, t: 16, b: 48 },
      xaxis: axis(theme, 'Tool', {
        anchor: `y${suffix(Math.max(rows.length - 1, 0))}`,
        range: [0.4, tools.length + 0.6],
        tickvals: places,
        ticktext: tools.map(({ tool }) => shortened(tool)),
      }),
      ...axes,
    }),
  };
}
