// A sweep that follows the sliders: its ranges, and what is known of the operating point in it.
import type { ChartPoint, Num, SweepDocument } from '../../documents';
import { nearest } from '../../decision_views';
import { modeName } from '../../text';
import { intervalsText, sweptOf } from '../../verb_views';
import { isHere, placed, type Point, type Ranges } from './settings';

/** The key of its slider, as others are named. */
export function sweptKey(sweep: SweepDocument): string {
  return `operating_point.${sweptOf(sweep).key}`;
}

export function sweptRanges(sweep: SweepDocument): Ranges {
  const ends = (list: number[]): [number, number] => [list[0] ?? 0, list[list.length - 1] ?? 1];
  return { speed: ends(sweep.spindle_speed_rpm), depth: ends(sweptOf(sweep).values) };
}

/** In the middle of both. */
export function firstSweptPoint(sweep: SweepDocument): Point {
  const ranges = sweptRanges(sweep);
  const middle = ([low, high]: [number, number]) => (low + high) / 2;
  return placed([middle(ranges.speed), middle(ranges.depth)], ranges);
}

export interface SweptFacts {
  stable: boolean;
  evaluated: boolean; // this very point; else the nearest of the map
  spectral_radius: Num;
  intervals: string; // where the nearest speed is stable; empty: nowhere
  frequency_hz: Num; // at which it chatters
  mode: string;
}

export function sweptFacts([speed, value]: Point, sweep: SweepDocument, points: ChartPoint[]): SweptFacts {
  const { values, valueOf } = sweptOf(sweep);
  const here = points.find((point) => isHere(point.spindle_speed_rpm, speed) && isHere(valueOf(point), value));
  const column = nearest(sweep.spindle_speed_rpm, speed);
  const row = nearest(values, value);
  const radius = here ? here.spectral_radius : (sweep.spectral_radius[row]?.[column] ?? null);
  const stable = here?.stable ?? (radius !== null && radius < 1);
  return {
    stable,
    evaluated: here !== undefined,
    spectral_radius: radius,
    intervals: intervalsText(sweep.stable[column]?.intervals ?? []),
    frequency_hz: stable ? null : (here?.dominant_frequency_hz ?? null),
    mode: stable ? '' : modeName(here),
  };
}
