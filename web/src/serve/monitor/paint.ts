// The live spectrogram and the strip of scores below it: pixels that move to the left.
import type { Theme } from '../../figures/theme';
import type { MonitorState } from '../../documents';
import { emptyColumn, noLevel, type Column, type FrameRing } from './ring';

export const deepest_db = 50; // below the highest; noise hides what lies lower
const step_db = 5; // by which the scale moves

type Rgb = [number, number, number];

export function rgb(colour: string): Rgb {
  const digits = Number.parseInt(colour.slice(1), 16);
  return [(digits >> 16) & 255, (digits >> 8) & 255, digits & 255];
}

function mixed([r, g, b]: Rgb, to: Rgb, share: number): Rgb {
  return [r + share * (to[0] - r), g + share * (to[1] - g), b + share * (to[2] - b)];
}

/** The stops of the scale from deepest_db below the highest up to it. */
export function scaleStops(theme: Theme): [number, string][] {
  return [[0, theme.panel], ...theme.scale.map(([at, colour]): [number, string] => [0.25 + 0.75 * at, colour])];
}

/** A colour a decibel. */
export function palette(theme: Theme): Rgb[] {
  const stops = scaleStops(theme);
  return Array.from({ length: deepest_db + 1 }, (_, level) => {
    const at = level / deepest_db;
    const upper = Math.max(1, stops.findIndex(([stop]) => stop >= at));
    const [from, below] = stops[upper - 1]!;
    const [to, above] = stops[upper]!;
    return mixed(rgb(below), rgb(above), (at - from) / (to - from));
  });
}

/** Where the scale ends, at a multiple of 5 dB; it stays while the highest level lies less than two steps below it. */
export function referenceFor(peak_db: number, before_db: number | null): number {
  if (peak_db === noLevel) return before_db ?? 0;
  if (before_db !== null && peak_db <= before_db && peak_db > before_db - 2 * step_db) return before_db;
  return step_db * Math.ceil(peak_db / step_db);
}

/** Of each row of pixels, the highest frequency on top, its first band and the one behind its last. */
export function rowBands(edges_hz: number[], highest_hz: number, height: number): [number, number][] {
  const bandAt = (frequency: number) => Math.max(0, Math.min(edges_hz.length - 2, edges_hz.findIndex((edge) => edge > frequency) - 1));
  return Array.from({ length: height }, (_, row) => {
    const low = bandAt((highest_hz * (height - row - 1)) / height);
    const high = bandAt((highest_hz * (height - row - 0.01)) / height);
    return [low, Math.max(low, high) + 1];
  });
}

/** Multiples of tooth passing; of the rotation where the teeth are unknown. */
export function cutLines(speed_rpm: number, teeth: number | null, highest_hz: number): number[] {
  if (!(speed_rpm > 0)) return [];
  const base_hz = ((teeth ?? 1) * speed_rpm) / 60;
  const count = Math.min(teeth === null ? 3 : 12, Math.floor(highest_hz / base_hz));
  return Array.from({ length: count }, (_, i) => (i + 1) * base_hz);
}

/** What is drawn; another one draws everything anew. */
export interface Picture {
  edges_hz: number[];
  teeth: number | null;
  highest_hz: number;
  span_s: number;
  theme: Theme;
}

const dash_px = 8;
const gap_px = 4;

/** Draws columns of pixels by the clock. */
export class Painter {
  private readonly column: Column;
  private readonly colours: Rgb[];
  private readonly rows: [number, number][];
  private readonly marks: { cut: Rgb; chatter: Rgb; panel: Rgb; grid: Rgb; text: Rgb; states: Record<MonitorState, Rgb> };
  reference_db = 0;

  constructor(
    private readonly ring: FrameRing,
    private readonly picture: Picture,
    private readonly height: number,
    private readonly stripHeight: number,
    readonly s_per_px: number,
  ) {
    const { theme, edges_hz, highest_hz } = picture;
    this.column = emptyColumn(ring.bands);
    this.colours = palette(theme);
    this.rows = rowBands(edges_hz, highest_hz, height);
    const [panel, text] = [rgb(theme.panel), rgb(theme.text)];
    const faint = (colour: string) => mixed(panel, rgb(colour), 0.3);
    const states = { stable: faint(theme.stable), transition: faint(theme.borderline), blind: faint(theme.unknown), chatter: faint(theme.chatter) };
    this.marks = { cut: rgb(theme.overlay), chatter: rgb(theme.chatter), panel, grid: rgb(theme.grid), text, states };
  }

  /** The pixel that stands at a time, counted from the session's beginning. */
  pixelAt(clock_s: number): number {
    return Math.floor(clock_s / this.s_per_px);
  }

  /** Column `pixel` into RGBA values of both pictures, a pixel wide each. */
  paint(pixel: number, spectrogram: Uint8ClampedArray, strip: Uint8ClampedArray): void {
    this.ring.column(pixel * this.s_per_px, (pixel + 1) * this.s_per_px, this.column);
    this.paintLevels(spectrogram);
    if (pixel % dash_px >= gap_px) {
      for (const line of cutLines(this.column.speed_rpm, this.picture.teeth, this.picture.highest_hz)) this.mark(spectrogram, line, 1, this.marks.cut);
    }
    if (pixel % dash_px < 3) this.mark(spectrogram, this.column.chatter_hz, 3, this.marks.chatter);
    this.paintScore(strip);
  }

  private paintLevels(out: Uint8ClampedArray): void {
    const { levels } = this.column;
    for (let row = 0; row < this.height; ++row) {
      const [first, end] = this.rows[row]!;
      let level = noLevel;
      for (let band = first; band < end; ++band) level = Math.max(level, levels[band]!);
      const shade = level === noLevel ? 0 : Math.max(0, Math.min(deepest_db, level - this.reference_db + deepest_db));
      put(out, row, this.colours[shade]!);
    }
  }

  private mark(out: Uint8ClampedArray, frequency_hz: number, rows: number, colour: Rgb): void {
    if (!(frequency_hz > 0) || frequency_hz > this.picture.highest_hz) return;
    const middle = Math.floor(this.height * (1 - frequency_hz / this.picture.highest_hz));
    for (let row = middle - (rows >> 1); row <= middle + (rows >> 1); ++row) if (row >= 0 && row < this.height) put(out, row, colour);
  }

  /** The state as background, the score as a bar: half as high as the strip where it is at its threshold. */
  private paintScore(out: Uint8ClampedArray): void {
    const { known, state, ratio } = this.column;
    const bar = this.stripHeight * (1 - scoreHeight(ratio));
    const threshold = Math.floor(this.stripHeight / 2);
    for (let row = 0; row < this.stripHeight; ++row) {
      const ground = known ? this.marks.states[state] : this.marks.panel;
      put(out, row, row === threshold ? this.marks.chatter : known && row >= bar ? this.marks.text : ground);
    }
  }
}

/** Share of the strip's height, half of it at the threshold. */
export function scoreHeight(ratio: number): number {
  return ratio > 0 ? 1 - 1 / (1 + ratio) : 0;
}

function put(out: Uint8ClampedArray, row: number, [r, g, b]: Rgb): void {
  const at = 4 * row;
  out[at] = r;
  out[at + 1] = g;
  out[at + 2] = b;
  out[at + 3] = 255;
}

/** At most about `most` round values from 0 to a highest one. */
export function ticks(highest: number, most: number): number[] {
  const decade = 10 ** Math.floor(Math.log10(highest / most));
  const step = [1, 2, 5, 10].map((factor) => factor * decade).find((one) => highest / one <= most) ?? highest;
  return Array.from({ length: Math.floor(highest / step + 1e-9) + 1 }, (_, i) => Number((i * step).toPrecision(6)));
}
