// The map of γ below a line that is dragged, and the curve of the margin under it.
import type { GammaMap, Num } from '../../documents';
import { gammaFigure } from '../../figures/gamma_map';
import type { Figure, Theme, Trace } from '../../figures/theme';
import type { Frame } from '../frame';
import type { GammaLine } from './gamma_line';

/** As high as the window permits. */
export function mapHeight(window_px: number): number {
  return Math.min(470, Math.max(300, window_px - 330));
}

/** With room for the grip at its right, and the colours' scale below the axis however low the window is. */
export function liveGammaFigure(map: GammaMap, selected: number | null, theme: Theme, narrow: boolean, height: number): Figure {
  const { data, layout } = gammaFigure(map, selected, theme, narrow);
  const margin = { l: 60, r: 66, t: narrow ? 52 : 30, b: 100 };
  const scale = { y: -46 / (height - margin.t - margin.b) };
  const placed = data.map((trace): Trace => (trace['colorbar'] ? { ...trace, colorbar: { ...(trace['colorbar'] as object), ...scale } } : trace));
  return { data: placed, layout: { ...layout, height, dragmode: false, margin } };
}

/** Where something lies in the frame, in pixels; beyond it, where it is zoomed, it lies outside. */
export function pixelsAt({ left, top, width, height, x, y }: Frame, [path_mm, gamma_deg]: readonly [number, number]): [number, number] {
  return [left + (width * (path_mm - x[0])) / (x[1] - x[0]), top + height * (1 - (gamma_deg - y[0]) / (y[1] - y[0]))];
}

/** The line over the frame from edge to edge, in pixels from the frame's corner: "x,y x,y …". */
export function linePoints(frame: Frame, line: GammaLine): string {
  const [first, last] = [line[0]!, line[line.length - 1]!];
  const whole: GammaLine = [[Math.min(frame.x[0], first[0]), first[1]], ...line, [Math.max(frame.x[1], last[0]), last[1]]];
  const inner = { ...frame, left: 0, top: 0 };
  return whole.map((knot) => pixelsAt(inner, knot).map((value) => value.toFixed(1)).join(',')).join(' ');
}

/** Of marks, sorted along the line, those that stand apart: many blocks in a row are few marks. */
export function apart(marks: [number, number][], least_px: number): [number, number][] {
  const kept: [number, number][] = [];
  for (const mark of marks) {
    const last = kept[kept.length - 1];
    if (!last || mark[0] - last[0] >= least_px) kept.push(mark);
  }
  return kept;
}

/** A curve as the data of an SVG path, with gaps where a value is missing. `place` gives pixels. */
export function curvePath(x: number[], y: Num[], place: (x: number, y: number) => [number, number]): string {
  let text = '';
  let drawn = false;
  y.forEach((value, i) => {
    if (value !== null) text += `${drawn ? 'L' : 'M'}${place(x[i]!, value).map((one) => one.toFixed(1)).join(',')}`;
    drawn = value !== null;
  });
  return text;
}
