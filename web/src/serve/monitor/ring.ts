// Frames of a spindle in memory that does not grow, and what of them a column of pixels shows.
import type { MonitorState } from '../../documents';
import type { MonitorFrame } from './documents';

const letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_';
const levelOf = new Map([...letters].map((letter, level) => [letter, level - (letters.length - 1)]));

export const noLevel = -128;
export const states: readonly MonitorState[] = ['stable', 'transition', 'blind', 'chatter']; // gravest last

/** Whole decibels of each band into `levels`; false where the frame has no spectrum. */
export function decodeSpectrum({ peak_db, spectrum }: Pick<MonitorFrame, 'peak_db' | 'spectrum'>, levels: Int8Array): boolean {
  levels.fill(noLevel);
  if (peak_db === null || spectrum === null) return false;
  for (let band = 0; band < Math.min(levels.length, spectrum.length); ++band) {
    levels[band] = Math.max(noLevel + 1, Math.min(127, peak_db + (levelOf.get(spectrum.charAt(band)) ?? noLevel)));
  }
  return true;
}

/** What a column of pixels shows. */
export interface Column {
  known: boolean;
  levels: Int8Array;
  state: MonitorState;
  ratio: number; // score over threshold, NaN: none
  speed_rpm: number; // NaN: unknown
  chatter_hz: number; // NaN: none
}

export function emptyColumn(bands: number): Column {
  return { known: false, levels: new Int8Array(bands).fill(noLevel), state: 'stable', ratio: NaN, speed_rpm: NaN, chatter_hz: NaN };
}

const longest_s = 1.2; // a frame stands for at most so long before it

/** The newest frames of a spindle. */
export class FrameRing {
  private pushed = 0;
  private readonly clock_s: Float64Array;
  private readonly ratio: Float32Array;
  private readonly speed_rpm: Float32Array;
  private readonly chatter_hz: Float32Array;
  private readonly state: Uint8Array;
  private readonly peak: Int8Array;
  private readonly levels: Int8Array;

  /** Six thousand frames are ten minutes. */
  constructor(
    readonly bands: number,
    readonly capacity = 6000,
  ) {
    this.clock_s = new Float64Array(capacity);
    this.ratio = new Float32Array(capacity);
    this.speed_rpm = new Float32Array(capacity);
    this.chatter_hz = new Float32Array(capacity);
    this.state = new Uint8Array(capacity);
    this.peak = new Int8Array(capacity);
    this.levels = new Int8Array(capacity * bands);
  }

  get size(): number {
    return Math.min(this.pushed, this.capacity);
  }

  /** Of the newest frame; 0 before the first. */
  get latest_s(): number {
    return this.size === 0 ? 0 : this.clock_s[this.slot(this.size - 1)]!;
  }

  /** A frame that is older than the newest is left out. */
  push(frame: MonitorFrame): void {
    if (this.size > 0 && frame.clock_s <= this.latest_s) return;
    const slot = this.pushed % this.capacity;
    ++this.pushed;
    this.clock_s[slot] = frame.clock_s;
    this.ratio[slot] = frame.score === null || frame.threshold === null ? NaN : frame.score / frame.threshold;
    this.speed_rpm[slot] = frame.spindle_speed_rpm ?? NaN;
    this.chatter_hz[slot] = frame.chatter_frequency_hz ?? NaN;
    this.state[slot] = Math.max(0, states.indexOf(frame.state));
    const known = decodeSpectrum(frame, this.levels.subarray(slot * this.bands, (slot + 1) * this.bands));
    this.peak[slot] = known ? Math.max(noLevel + 1, Math.min(127, frame.peak_db!)) : noLevel;
  }

  /** The highest level since a time [dB]; noLevel: there is none. */
  peakSince(from_s: number): number {
    let peak = noLevel;
    for (let i = this.first(from_s); i < this.size; ++i) peak = Math.max(peak, this.peak[this.slot(i)]!);
    return peak;
  }

  /** What is known of (from_s, to_s]: the gravest state, the highest score, the strongest of each band. Where no frame lies in it, the one that follows soon stands for it. */
  column(from_s: number, to_s: number, out: Column): void {
    Object.assign(out, { known: false, state: 'stable', ratio: NaN, speed_rpm: NaN, chatter_hz: NaN });
    out.levels.fill(noLevel);
    let drawn = false;
    let gravest = -1;
    for (let i = this.first(from_s); i < this.size; ++i) {
      const slot = this.slot(i);
      const inside = this.clock_s[slot]! <= to_s;
      if (!inside && ((out.known && drawn) || this.clock_s[slot]! > to_s + longest_s)) break;
      if (inside || !out.known) {
        gravest = Math.max(gravest, this.state[slot]!);
        const ratio = this.ratio[slot]!;
        if (!Number.isNaN(ratio)) out.ratio = Number.isNaN(out.ratio) ? ratio : Math.max(out.ratio, ratio);
        if (!Number.isNaN(this.speed_rpm[slot]!)) out.speed_rpm = this.speed_rpm[slot]!;
        if (!Number.isNaN(this.chatter_hz[slot]!)) out.chatter_hz = this.chatter_hz[slot]!;
        out.known = true;
      }
      if (this.peak[slot] === noLevel) continue;
      if (inside || !drawn) this.strongest(slot, out.levels);
      drawn = true;
    }
    out.state = states[Math.max(0, gravest)]!;
  }

  private strongest(slot: number, levels: Int8Array): void {
    const begin = slot * this.bands;
    for (let band = 0; band < this.bands; ++band) levels[band] = Math.max(levels[band]!, this.levels[begin + band]!);
  }

  private slot(i: number): number {
    return (this.pushed - this.size + i) % this.capacity;
  }

  /** The first frame after a time. */
  private first(after_s: number): number {
    let low = 0;
    let high = this.size;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.clock_s[this.slot(middle)]! <= after_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}
