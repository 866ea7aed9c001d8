import { expect, it } from 'vitest';
import type { Decision, GammaMap, Outcome, Stretch } from './decision';
import {
  allowedText,
  beyondText,
  collisionCaution,
  columnFacts,
  decidedTime,
  feedText,
  leanText,
  leastAlong,
  limited,
  limitName,
  marginAt,
  nearest,
  rangeText,
  savedText,
  valueText,
  violationOf,
} from './decision_views';

const map: GammaMap = {
  block: [3, 5, 9],
  path_mm: [10, 20, 40],
  gamma_deg: [-10, 0, 10],
  margin: [
    [-0.2, 0.1, null],
    [0.2, 0.3, null],
    [0.4, null, null],
  ],
  chosen_deg: [5, 0, null],
  programmed_deg: [-10, -5, 0],
  least_margin: 0.1,
};

it('reads the map between its rows, not where the robot cannot stand', () => {
  expect(marginAt(map, 0, 5)).toBeCloseTo(0.3);
  expect(marginAt(map, 1, 0)).toBe(0.3);
  expect(marginAt(map, 1, 5)).toBeNull();
  expect(marginAt(map, 0, 11)).toBeNull();
  expect(marginAt(map, 0, null)).toBeNull();
  expect(leastAlong(map, map.chosen_deg)).toBeCloseTo(0.3);
  expect(leastAlong(map, map.programmed_deg)).toBeCloseTo(-0.2);
  expect(leastAlong(map, [null, null, 0])).toBeNull();
});

it('finds a place along the path, and a block that is not in the map', () => {
  expect([0, 14, 16, 31, 99].map((at) => nearest(map.path_mm, at))).toEqual([0, 0, 1, 2, 2]);
  expect(nearest(map.block, 6)).toBe(1);
});

it('says what is known of one place', () => {
  expect(columnFacts(map, 0).map(({ value }) => value)).toEqual(['3', '10.0\u202fmm', '-10°, margin -0.2', '5°, margin 0.3', '0.4 at 10°']);
  expect(columnFacts(map, 2).map(({ value }) => value)).toEqual(['9', '40.0\u202fmm', '0°, margin –', 'the robot cannot stand here']);
});

it('shows the robot’s time where there is one', () => {
  const outcome = (robot_time_s: number | null) => ({ robot_time_s, cutting_time_s: 22 }) as Outcome;
  expect(decidedTime(outcome(47), outcome(29))).toEqual({ label: 'Robot’s time', before: 47, decided: 29 });
  expect(decidedTime(outcome(null), outcome(null)).label).toBe('Cutting time at the feeds');
});

it('says what is saved', () => {
  expect(savedText(50, 41)).toBe('18\u202f% less than the 50.0\u202fs programmed');
  expect(savedText(50, 60)).toBe('20\u202f% more than the 50.0\u202fs programmed');
  expect(savedText(50, 50.1)).toBe('as the 50.0\u202fs programmed');
  for (const [before, after] of [[null, 1], [1, null], [0, 1]] as const) expect(savedText(before, after)).toBe('');
});

it('joins what is lowest and highest', () => {
  const text = (value: number) => value.toFixed(0);
  expect(rangeText(1, 2, text)).toBe('1\u202f–\u202f2');
  expect(rangeText(1, 1.2, text)).toBe('1');
  expect(rangeText(null, 2, text)).toBe('2');
  expect(rangeText(null, null, text)).toBe('not known');
  const stretch = (low: number | null, high: number | null) => ({ lowest_feed_mm_per_min: low, highest_feed_mm_per_min: high });
  expect(feedText({ stretches: [stretch(800, 900), stretch(null, 700)] } as unknown as Decision)).toBe('700\u202f–\u202f900');
  expect(feedText({ stretches: [] } as unknown as Decision)).toBe('not known');
});

it('says how the tool leans where it leans', () => {
  const stretch = (lead_deg: number, tilt_deg: number) => ({ lead_deg, tilt_deg }) as Stretch;
  expect(leanText(stretch(0, 0))).toBe('');
  expect(leanText({} as Stretch)).toBe('');
  expect(leanText(stretch(-7.5, 15))).toBe('-7.5°, 15.0°');
});

it('finds the violation of each measure, and keeps limits of joints apart from those of the spindle', () => {
  const row = (limit: string, block: number) => ({ limit, block, line: null, value: 2, allowed: 1, unit: '' });
  const outcome = { violations: [row('joint_torque', 4), row('spindle_power', 2), row('stability', 3), row('forced_vibration', 5)] } as unknown as Outcome;
  expect(limited.map((measure) => violationOf(outcome, measure)?.block ?? null)).toEqual([3, null, null, 2, null, null, 5]);
});

it('says of stability what was violated: the spectral radius or the margin', () => {
  const violation = { limit: 'stability', block: 1, line: 2, value: 1.03, allowed: 1, unit: '' };
  expect([limitName(violation), allowedText(violation), beyondText(violation)]).toEqual(['Stability, |μ|', 'at most 1', 'chatter']);
  const margin = { ...violation, value: 0.05, allowed: 0.1 };
  expect([limitName(margin), beyondText(margin)]).toEqual(['Stability margin', 'at least 0.1']);
  expect([valueText({ ...violation, limit: 'posture' }), allowedText({ ...violation, limit: 'posture' })]).toEqual(['–', '–']);
  const chip = { ...violation, limit: 'least_chip', value: 0.004, allowed: 0.01, unit: 'mm' };
  expect([limitName(chip), allowedText(chip)]).toEqual(['Least chip', 'at least 0.01\u202fmm']);
});

it('warns of collisions where there is something to run', () => {
  const decision = { collisions_checked: false, decided: {}, free: ['feed'] } as unknown as Decision;
  expect(collisionCaution(decision)).toBe('Collisions were not checked. Run the program in the air first.');
  expect(collisionCaution({ ...decision, free: ['gamma'] })).toContain('Other turns γ move');
  expect(collisionCaution({ ...decision, decided: null })).toBe('');
  expect(collisionCaution({ ...decision, collisions_checked: true })).toBe('');
});
