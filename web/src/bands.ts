// Curves over equal runs of time, of which the lowest and the highest value are known.

export interface Band {
  low: number[];
  high: number[];
}

export interface TimeCurve {
  time_s: number[];
  values: number[];
}

/** A band as one curve: of runs of one sample its values at their begins, else of each run the lowest and the highest value a quarter before and after its middle. */
export function bandCurve({ low, high }: Band, run_s: number): TimeCurve {
  if (low.every((value, run) => value === high[run])) return { time_s: low.map((_, run) => run * run_s), values: low };
  return {
    time_s: low.flatMap((_, run) => [(run + 0.25) * run_s, (run + 0.75) * run_s]),
    values: low.flatMap((value, run) => [value, high[run]!]),
  };
}
