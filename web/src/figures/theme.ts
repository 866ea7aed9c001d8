/** Colours that stay apart for the colour-blind (after Okabe and Ito), each with its own marker shape as well. */
export interface Theme {
  text: string;
  muted: string;
  grid: string;
  panel: string;
  stable: string;
  stableFill: string;
  bandFill: string;
  chatter: string;
  borderline: string;
  unknown: string;
  accent: string;
  measured: string;
  overlay: string; // lines over a map in the colours of scale
  series: string[];
  scale: [number, string][]; // low to high
}

export const light: Theme = {
  text: '#1c2430',
  muted: '#5c6878',
  grid: '#e3e7ec',
  panel: '#ffffff',
  stable: '#007f5f',
  stableFill: 'rgba(0, 127, 95, 0.10)',
  bandFill: 'rgba(204, 121, 167, 0.30)',
  chatter: '#c8401c',
  borderline: '#c98a00',
  unknown: '#8a94a3',
  accent: '#0b5cad',
  measured: '#8796aa',
  overlay: '#b3006b',
  // viridis without its light end, turned round: the highest stands out on white
  scale: [[0, '#a5db36'], [0.25, '#4ac16d'], [0.5, '#1fa187'], [0.75, '#365c8d'], [1, '#440154']],
  series: ['#0b5cad', '#c8401c', '#007f5f', '#a3498e', '#c98a00', '#2f9ec4', '#3c4450', '#7ba800'],
};

export const dark: Theme = {
  text: '#e6eaf0',
  muted: '#9aa6b6',
  grid: '#2c3644',
  panel: '#171d26',
  stable: '#3ecf9f',
  stableFill: 'rgba(62, 207, 159, 0.12)',
  bandFill: 'rgba(204, 121, 167, 0.35)',
  chatter: '#ff7a55',
  borderline: '#f0b840',
  unknown: '#8a97a8',
  accent: '#63b0ff',
  measured: '#76869b',
  overlay: '#ff9ed2',
  // viridis without its dark end
  scale: [[0, '#414487'], [0.25, '#2a788e'], [0.5, '#22a884'], [0.75, '#7ad151'], [1, '#fde725']],
  series: ['#63b0ff', '#ff7a55', '#3ecf9f', '#d98cc7', '#f0b840', '#7fd3ef', '#c9ced6', '#b6e04a'],
};

export type Trace = Record<string, unknown>;
export type Layout = Record<string, unknown>;
export interface Figure {
  data: Trace[];
  layout: Layout;
}

/** What is shown under the pointer; null: nothing. */
function hovered(text: string | null): Trace {
  return text === null ? { hoverinfo: 'skip' } : { hovertemplate: text.includes('<extra>') ? text : `${text}<extra></extra>` };
}

/** A line. `hover`: a template of what is shown under the pointer. */
export function lines(name: string, x: unknown[], y: unknown[], line: Layout, hover: string | null, more: Trace = {}): Trace {
  return { type: 'scatter', mode: 'lines', name, x, y, line, ...hovered(hover), ...more };
}

/** Marks at points. */
export function points(name: string, x: unknown[], y: unknown[], marker: Layout, hover: string | null, more: Trace = {}): Trace {
  return { type: 'scatter', mode: 'markers', name, x, y, marker, ...hovered(hover), ...more };
}

/** A line over the whole height at a place of the x axis. */
export function verticalLine(at: number, line: Layout, more: Layout = {}): Layout {
  return { type: 'line', xref: 'x', yref: 'paper', x0: at, x1: at, y0: 0, y1: 1, line, ...more };
}

/** A shade over the whole height. */
export function shadedBetween(x0: number, x1: number, fillcolor: string, opacity: number): Layout {
  return { type: 'rect', xref: 'x', yref: 'paper', x0, x1, y0: 0, y1: 1, layer: 'below', fillcolor, opacity, line: { width: 0 } };
}

/** The colour of the index-th of several. */
export function seriesColour({ series }: Theme, index: number): string {
  return series[index % series.length]!;
}

/** The place of the index-th of several plots, from above. */
export function stacked(index: number, count: number, gap: number): [number, number] {
  const top = 1 - index / count;
  return [Math.max(0, top - 1 / count + gap), top];
}

/** Below zero, or a limit, one colour, above it another. */
export function diverging(low: string, theme: Theme, high: string): [number, string][] {
  return [[0, low], [0.5, theme.panel], [1, high]];
}

/** A scale of colours below a plot. */
export function barBelow(title: string, y: number, more: Layout = {}): Layout {
  return { title: { text: title, side: 'top', font: { size: 12 } }, orientation: 'h', thickness: 10, len: 1, x: 0.5, y, yanchor: 'top', outlinewidth: 0, ...more };
}

/** Names of curves in a row. */
export function legendRow(more: Layout): Layout {
  return { orientation: 'h', yanchor: 'bottom', xanchor: 'left', x: 0, font: { size: 12 }, ...more };
}

/** Of a theme's series, those of x, y and z: none of them is the colour of chatter or of stable. */
export const directionSeries = [0, 3, 4] as const;

export const thinSpace = '\u202f';

/** An axis with a title, in the theme's colours. */
export function axis(theme: Theme, title: string, more: Layout = {}): Layout {
  return {
    title: { text: title, standoff: 8 },
    gridcolor: theme.grid,
    linecolor: theme.grid,
    zerolinecolor: theme.grid,
    automargin: true,
    ...more,
  };
}

/** Ticks of a logarithmic axis at 1, 2 and 5 of each decade, as plain numbers; 1 alone where that would be too many. */
export function logTicks(from: number, to: number): { tickvals: number[]; ticktext: string[] } {
  if (!(from > 0) || !(to > from)) return { tickvals: [], ticktext: [] };
  const decades = Math.log10(to / from);
  const heads = decades > 4 ? [1] : [1, 2, 5];
  const tickvals: number[] = [];
  for (let decade = Math.floor(Math.log10(from)); decade <= Math.ceil(Math.log10(to)); ++decade) {
    for (const head of heads) {
      const value = Number((head * 10 ** decade).toPrecision(3));
      if (value >= from * 0.999 && value <= to * 1.001) tickvals.push(value);
    }
  }
  return { tickvals, ticktext: tickvals.map((value) => (value < 1e-4 || value >= 1e5 ? value.toExponential(0) : `${value}`)) };
}

/** What every figure shares. */
export function layout(theme: Theme, height: number, more: Layout = {}): Layout {
  return {
    height,
    autosize: true,
    paper_bgcolor: 'rgba(0,0,0,0)',
    plot_bgcolor: 'rgba(0,0,0,0)',
    font: { family: 'system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif', size: 13, color: theme.text },
    margin: { l: 56, r: 36, t: 16, b: 48 },
    modebar: { orientation: 'v', bgcolor: 'rgba(0,0,0,0)', color: theme.unknown, activecolor: theme.accent },
    separators: `.${thinSpace}`,
    hoverlabel: { bgcolor: theme.panel, bordercolor: theme.muted, font: { color: theme.text }, align: 'left' },
    legend: legendRow({ y: 1.01 }),
    ...more,
  };
}

/** A spindle speed in whole rpm, thousands apart from 10 000 on. */
export function rpm(speed: number): string {
  const digits = speed.toFixed(0);
  return `${digits.length > 4 ? digits.replace(/(?<=\d)(?=(\d{3})+$)/g, thinSpace) : digits}${thinSpace}rpm`;
}

/** Plotly reads some tags in texts; texts from outside must stay texts. */
export function plain(text: string): string {
  return text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');
}
