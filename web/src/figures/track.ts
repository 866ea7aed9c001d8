import type { Block, Num, Places } from '../documents';
import { axis, barBelow, layout, lines, points, thinSpace, type Figure, type Layout, type Theme, type Trace } from './theme';

interface Line {
  x: Num[];
  y: Num[];
  z: Num[];
}

export interface Marks {
  x: number[];
  y: number[];
  z: number[];
  force: number[];
  place: [number, number][]; // block, line
}

/** Moves in air or in the cut, each from where the one before ended; a gap between two that do not follow each other. */
export function moves(blocks: Block[], cutting: boolean): Line {
  const line: Line = { x: [], y: [], z: [] };
  for (let i = 1; i < blocks.length; ++i) {
    if (blocks[i]!.cuts !== cutting) continue;
    if (i === 1 || blocks[i - 1]!.cuts !== cutting) {
      if (line.x.length > 0) for (const values of [line.x, line.y, line.z]) values.push(null);
      push(line, blocks[i - 1]!);
    }
    push(line, blocks[i]!);
  }
  return line;
}

function push(line: Line, block: Block): void {
  line.x.push(block.x_mm);
  line.y.push(block.y_mm);
  line.z.push(block.z_mm);
}

/** Marks of the blocks that cut, the highest force last and so on top. A long block has several along its way, up to `more` in all. */
export function marks(blocks: Block[], more = 1500): Marks {
  const steps = blocks.map((end, i) => {
    const begin = blocks[i - 1] ?? end;
    return { begin, end, length: Math.hypot(end.x_mm - begin.x_mm, end.y_mm - begin.y_mm, end.z_mm - begin.z_mm) };
  });
  const cutting = steps.filter(({ end }) => end.cuts && end.peak_f_n !== null);
  const length = cutting.reduce((sum, step) => sum + step.length, 0);
  const spacing = length > 0 ? length / more : Infinity;
  const out: Marks = { x: [], y: [], z: [], force: [], place: [] };
  for (const step of cutting.sort((a, b) => a.end.peak_f_n! - b.end.peak_f_n!)) {
    const { begin, end } = step;
    const count = Math.max(1, Math.floor(step.length / spacing));
    for (let k = 1; k <= count; ++k) {
      const along = (from: number, to: number) => from + ((to - from) * k) / count;
      out.x.push(along(begin.x_mm, end.x_mm));
      out.y.push(along(begin.y_mm, end.y_mm));
      out.z.push(along(begin.z_mm, end.z_mm));
      out.force.push(end.peak_f_n!);
      out.place.push([end.block, end.line]);
    }
  }
  return out;
}

/** Where blocks end. */
export function placesOf(blocks: Block[]): Places {
  return { x_mm: blocks.map((block) => block.x_mm), y_mm: blocks.map((block) => block.y_mm), z_mm: blocks.map((block) => block.z_mm) };
}

export interface Frame {
  stacked: boolean;
  height: number;
  x: [number, number];
  y: [number, number];
  z: [number, number];
  top: [number, number][]; // domains of the view from above: x, y
  side: [number, number][]; // of the view from the side: x, z
}

function extent(values: number[]): [number, number] {
  return values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
}

/** The two views: their vertical axis, and where they are drawn. */
export const views = [
  { name: 'from above', up: 'y' as const, axes: {} },
  { name: 'from the side', up: 'z' as const, axes: { xaxis: 'x2', yaxis: 'y2' } },
];

/** Points of one view in the colours of the scale that both share; `hover`: before their place. */
export function colouredPoints({ name, up, axes }: (typeof views)[number], x: Num[], y: Num[], size: number, color: number[], hover: string, more: Trace = {}): Trace {
  return points(name, x, y, { size, color, coloraxis: 'coloraxis' }, `${hover}<br>at x %{x:.2f}, ${up} %{y:.2f}${thinSpace}mm`, { showlegend: false, ...axes, ...more });
}

const margin = { l: 64, r: 24, t: 30, b: 104 };
const between = 78;
const highestView = 460;

/** Ranges and places of the two views, so that a millimetre is as long in all four axes. Side by side, or stacked where narrow. */
export function frame(track: Places, width: number): Frame {
  const stacked = width < 640;
  const sides = { x: extent(track.x_mm), y: extent(track.y_mm), z: extent(track.z_mm) };
  const room = Math.max(120, width - margin.l - margin.r);
  const across = stacked ? room : (room - between) / 2;
  const largest = Math.max(...[sides.x, sides.y, sides.z].map(([low, high]) => high - low));
  const size = ([low, high]: [number, number]) => Math.max(1.08 * (high - low), 0.1 * largest, 1);
  const tallest = Math.max(size(sides.y), size(sides.z));
  const pixels = Math.min(across / size(sides.x), highestView / tallest); // a millimetre
  const range = ([low, high]: [number, number], length: number): [number, number] => {
    const half = length / pixels / 2;
    return [(low + high) / 2 - half, (low + high) / 2 + half];
  };
  const least = 110;
  if (stacked) {
    const [over, under] = [Math.max(least, size(sides.y) * pixels), Math.max(least, size(sides.z) * pixels)];
    const gap = 56;
    const inner = over + gap + under;
    return {
      stacked,
      height: inner + margin.t + margin.b,
      x: range(sides.x, across),
      y: range(sides.y, over),
      z: range(sides.z, under),
      top: [[0, 1], [(under + gap) / inner, 1]],
      side: [[0, 1], [0, under / inner]],
    };
  }
  const tall = Math.max(least, tallest * pixels);
  const part = across / room;
  return {
    stacked,
    height: tall + margin.t + margin.b,
    x: range(sides.x, across),
    y: range(sides.y, tall),
    z: range(sides.z, tall),
    top: [[0, part], [0, 1]],
    side: [[1 - part, 1], [0, 1]],
  };
}

/** What the two views of a path share; a colour scale below where something has a colour. */
export function viewsLayout(place: Frame, theme: Theme, scale: string | null): Layout {
  const title = (text: string, [from, to]: [number, number], y: number): Layout => ({
    text,
    showarrow: false,
    font: { size: 13, color: theme.muted },
    xref: 'paper',
    yref: 'paper',
    x: (from + to) / 2,
    xanchor: 'center',
    y,
    yanchor: 'bottom',
    yshift: 4,
  });
  const equal = { scaleanchor: 'x', scaleratio: 1, automargin: false, zeroline: false };
  return layout(theme, place.height, {
    hovermode: 'closest',
    margin,
    annotations: [title('From above', place.top[0]!, place.top[1]![1]), title('From the side', place.side[0]!, place.side[1]![1])],
    xaxis: axis(theme, place.stacked ? '' : 'x (mm)', { range: place.x, domain: place.top[0], anchor: 'y', automargin: false, zeroline: false }),
    yaxis: axis(theme, 'y (mm)', { ...equal, range: place.y, domain: place.top[1], anchor: 'x' }),
    xaxis2: axis(theme, 'x (mm)', { matches: 'x', range: place.x, domain: place.side[0], anchor: 'y2', automargin: false, zeroline: false }),
    yaxis2: axis(theme, 'z (mm)', { ...equal, range: place.z, domain: place.side[1], anchor: 'x2' }),
    coloraxis: {
      colorscale: theme.scale,
      showscale: scale !== null,
      colorbar: barBelow(scale ?? '', -52 / (place.height - margin.t - margin.b), { len: place.stacked ? 1 : 0.5 }),
    },
  });
}

/** The path from above and from the side, each block that cuts in the colour of its peak force. */
export function trackFigure(blocks: Block[], theme: Theme, width: number): Figure {
  const place = frame(placesOf(blocks), width);
  const air = moves(blocks, false);
  const cut = moves(blocks, true);
  const at = marks(blocks);
  const data: Trace[] = views.flatMap((view) => [
    lines('air', air.x, air[view.up], { color: theme.unknown, width: 0.8 }, null, { showlegend: false, ...view.axes }),
    lines('cut', cut.x, cut[view.up], { color: theme.grid, width: 1.5 }, null, { showlegend: false, ...view.axes }),
    colouredPoints(view, at.x, at[view.up], 4, at.force, `%{marker.color:.4g}${thinSpace}N in block %{customdata[0]}, line %{customdata[1]}`, { customdata: at.place }),
  ]);
  return { data, layout: viewsLayout(place, theme, at.force.length > 0 ? 'Peak force (N)' : null) };
}
