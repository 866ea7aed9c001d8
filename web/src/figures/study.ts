import type { SensitivityRow, StudyColumn } from '../documents';
import { columnTitle, estimateText, rowName, shortNames, type ProbabilityMap } from '../study_views';
import { axis, barBelow, diverging, layout, plain, points, type Figure, type Layout, type Theme } from './theme';

const most_texts = 24; // rows of a map whose cells have texts
const longest = 40; // of an axis title
const longest_text = 220; // of a value under the pointer: a document has at most 200 letters of it, and eight digits that tell it from others
const room_below = 130; // for a scale of colours

/** A scale of colours below the axis of a plot that is so high. */
function scaleBelow(title: string, height: number, more: Layout = {}): Layout {
  return barBelow(title, -62 / (height - 16 - room_below), more);
}

function shortened(text: string, longest: number): string {
  return plain(text.length > longest ? `${text.slice(0, longest - 1)}…` : text);
}

/** Of many names some, evenly chosen. */
function some(names: string[]): number[] {
  const step = Math.max(1, Math.ceil(names.length / 40));
  return names.map((_, i) => i).filter((i) => i % step === 0);
}

/** Categories at 0, 1, … of an axis; where there are many, some of them. */
function categories(names: string[], longest: number): Layout {
  const places = some(names);
  return { tickvals: places, ticktext: places.map((i) => shortened(names[i]!, longest)), showgrid: false, zeroline: false };
}

/** How probable it is that values keep the condition, the robust optimum outlined. */
export function probabilityFigure(map: ProbabilityMap, theme: Theme, narrow: boolean): Figure {
  const { values, keys, combinations, rows, optimum } = map;
  const down = combinations.length;
  const text = (row: ProbabilityMap['rows'][number][number]) => {
    if (row === null) return '';
    const left = row.left_out > 0 ? `<br>${row.left_out} left out` : '';
    return `${plain(rowName(row))}<br>${estimateText(row.probability)}<br>${row.holding} of ${row.points} samples${left}`;
  };
  const cells = down <= most_texts && values.length <= (narrow ? 5 : 12);
  const height = Math.min(1200, Math.max(down * (cells ? 40 : 14), 80)) + 100;
  const z = rows.map((row) => row.map((cell) => cell?.probability.value ?? null));
  const outline = optimum && { type: 'rect', x0: optimum[0] - 0.5, x1: optimum[0] + 0.5, y0: optimum[1] - 0.5, y1: optimum[1] + 0.5, line: { color: theme.overlay, width: 4 } };
  return {
    data: [
      {
        type: 'heatmap',
        z,
        text: z.map((row) => row.map((value) => (value === null ? '' : `${(100 * value).toFixed(0)} %`))),
        ...(cells ? { texttemplate: '%{text}' } : {}),
        customdata: rows.map((row) => row.map(text)),
        hovertemplate: '%{customdata}<extra></extra>',
        hoverongaps: false,
        zmin: 0,
        zmax: 1,
        xgap: 2,
        ygap: 2,
        colorscale: diverging(theme.chatter, theme, theme.stable),
        showscale: !cells, // the texts say it
        colorbar: { title: { text: 'Probability', side: 'right' }, thickness: 12, outlinewidth: 0, tickformat: '.0%' },
      },
    ],
    layout: layout(theme, height, {
      margin: { l: 56, r: 36, t: 16, b: 48 },
      xaxis: axis(theme, 'Collected value', { ...categories(values, 24), range: [-0.5, values.length - 0.5] }),
      yaxis: axis(theme, shortened(shortNames(keys).join(', '), 40), { ...categories(combinations, 24), range: [down - 0.5, -0.5] }),
      shapes: outline ? [outline] : [],
    }),
  };
}

/** First and total index of each key, with their intervals. */
export function sensitivityFigure({ keys, indices }: SensitivityRow, theme: Theme): Figure {
  const names = shortNames(keys);
  const bars = (name: 'first' | 'total', color: string) => {
    const all = indices.map((index) => index[name]);
    const beyond = (end: 'low' | 'high') => all.map((one) => Math.abs((one[end] ?? one.value ?? 0) - (one.value ?? 0)));
    return {
      type: 'bar',
      orientation: 'h',
      name,
      y: names.map((_, i) => i),
      x: all.map(({ value }) => value),
      marker: { color },
      error_x: { type: 'data', symmetric: false, array: beyond('high'), arrayminus: beyond('low'), color: theme.text, thickness: 1.4, width: 5 },
      customdata: all.map((one, i) => `${plain(keys[i]!)}<br>${name} ${estimateText(one)}`),
      hovertemplate: '%{customdata}<extra></extra>',
    };
  };
  return {
    data: [bars('first', theme.series[5]!), bars('total', theme.accent)],
    layout: layout(theme, 46 * keys.length + 110, {
      margin: { l: 56, r: 36, t: 30, b: 48 },
      hovermode: 'closest',
      barmode: 'group',
      bargap: 0.3,
      xaxis: axis(theme, 'Share of the variance', { zerolinecolor: theme.muted }),
      yaxis: axis(theme, '', { ...categories(names, 26), range: [keys.length - 0.5, -0.5] }),
    }),
  };
}

function valuesOf({ numbers, texts }: StudyColumn): unknown[] {
  return texts.length > 0 ? texts.map(plain) : numbers;
}

/** Of texts each is a category, in their order; lists may be long. */
function columnAxis(column: StudyColumn, theme: Theme): Layout {
  const names = [...new Set(column.texts)];
  const shown = some(names).map((i) => names[i]!);
  const ticks = { type: 'category', tickvals: shown.map(plain), ticktext: shown.map((name) => shortened(name, 24)) };
  return axis(theme, shortened(columnTitle(column), longest), names.length > 0 ? ticks : { exponentformat: 'none' });
}

/** A column over another one, a third one as colour. */
export function columnsFigure(across: StudyColumn, up: StudyColumn, colour: StudyColumn | null, theme: Theme): Figure {
  const height = colour ? 540 : 420;
  const bar = colour && scaleBelow(shortened(columnTitle(colour), longest), height, { exponentformat: 'none' });
  const coloured = colour && { color: colour.numbers, colorscale: theme.scale, colorbar: bar, showscale: true };
  const texts = across.texts.length > 0; // under the pointer longer than at the axis
  const hover = `${shortened(across.name, 60)}: %{${texts ? 'customdata' : 'x'}}<br>${shortened(up.name, 60)}: %{y}${colour ? `<br>${shortened(colour.name, 60)}: %{marker.color}` : ''}`;
  const more = { showlegend: false, ...(texts ? { customdata: across.texts.map((text) => shortened(text, longest_text)) } : {}) };
  return {
    data: [points(plain(up.name), valuesOf(across), valuesOf(up), { size: 6, color: theme.accent, opacity: colour ? 1 : 0.55, ...coloured }, hover, more)],
    layout: layout(theme, height, {
      margin: { l: 56, r: 36, t: 16, b: colour ? room_below : 48 },
      hovermode: 'closest',
      xaxis: columnAxis(across, theme),
      yaxis: columnAxis(up, theme),
    }),
  };
}
