// Curves over equal runs of time, of which the lowest and the highest value are known; null where there was none.
import type { VibrationDocument } from '#schema/vibration';
import type { Num } from './parts_of_documents';

export type Band = VibrationDocument['force_n'][string];

export interface TimeCurve {
  time_s: number[];
  values: Num[];
}

/** Curves over the same runs: where every run is one sample its values at their begins, else of each run the lowest and the highest value a quarter before and after its middle. */
export function bandCurves(bands: Band[], run_s: number): { time_s: number[]; values: Num[][] } {
  const single = bands.every(({ low, high }) => low.every((value, run) => value === high[run]));
  const begins = (bands[0]?.low ?? []).map((_, run) => run * run_s);
  return {
    time_s: single ? begins : begins.flatMap((begin) => [begin + 0.25 * run_s, begin + 0.75 * run_s]),
    values: bands.map(({ low, high }) => (single ? low : low.flatMap((value, run) => [value, high[run] ?? null]))),
  };
}

export function bandCurve(band: Band, run_s: number): TimeCurve {
  const { time_s, values } = bandCurves([band], run_s);
  return { time_s, values: values[0]! };
}
