import { expect, it } from 'vitest';
import type { GammaMap, Violation } from './documents';
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
import { sampleReport } from './report_sample';

const decision = sampleReport().plan!.decision!;
const outcome = decision.decided!;
const [stretch] = decision.stretches;

const map: GammaMap = {
  block: [3, 5, 9],
  path_mm: [10, 20, 40],
  gamma_deg: [-10, 0, 10],
  margin: [
    [-0.2, 0.1, null],
    [0.2, 0.3, null],
    [0.4, null, null],
  ],
  chosen_deg: [5, 0, 20],
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
  expect(columnFacts(map, 2).map(({ value }) => value)).toEqual(['9', '40.0\u202fmm', '0°, margin –', '20°, margin –', 'the robot cannot stand here']);
});

it('shows the robot’s time where there is one', () => {
  const timed = (robot_time_s: number | null) => ({ ...outcome, robot_time_s });
  expect(decidedTime(timed(47), timed(29))).toEqual({ label: 'Robot’s time', before: 47, decided: 29 });
  expect(decidedTime(timed(null), timed(null)).label).toBe('Cutting time at the feeds');
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
  const fed = (low: number, high: number) => ({ ...stretch!, lowest_feed_mm_per_min: low, highest_feed_mm_per_min: high });
  expect(feedText([fed(800, 900), fed(700, 750)])).toBe('700\u202f–\u202f900');
  expect(feedText([])).toBe('not known');
});

it('says how the tool leans where it leans', () => {
  expect(leanText({ lead_deg: 0, tilt_deg: 0 })).toBe('');
  expect(leanText({ lead_deg: -7.5, tilt_deg: 15 })).toBe('-7.5°, 15.0°');
});

it('finds the violation of each measure, and keeps limits of joints apart from those of the spindle', () => {
  const row = (limit: Violation['limit'], block: number): Violation => ({ limit, block, line: 1, value: 2, allowed: 1, unit: '' });
  const violations = [row('joint_torque', 4), row('power', 2), row('stability', 3), row('forced_vibration', 5)];
  expect(limited.map((measure) => violationOf({ ...outcome, violations }, measure)?.block ?? null)).toEqual([3, null, null, 2, null, null, 5]);
});

it('says of stability what was violated: the spectral radius or the margin', () => {
  const violation: Violation = { limit: 'stability', block: 1, line: 2, value: 1.03, allowed: 1, unit: '' };
  expect([limitName(violation), allowedText(violation), beyondText(violation)]).toEqual(['Stability, |μ|', 'at most 1', 'chatter']);
  const margin = { ...violation, value: 0.05, allowed: 0.1 };
  expect([limitName(margin), beyondText(margin)]).toEqual(['Stability margin', 'at least 0.1']);
  expect([valueText({ ...violation, limit: 'posture' }), allowedText({ ...violation, limit: 'posture' })]).toEqual(['–', '–']);
  const chip: Violation = { ...violation, limit: 'least_chip', value: 0.004, allowed: 0.01, unit: 'mm' };
  expect([limitName(chip), allowedText(chip)]).toEqual(['Least chip', 'at least 0.01\u202fmm']);
});

it('warns of collisions where there is something to run', () => {
  const unchecked: typeof decision = { ...decision, collisions_checked: false, free: ['feed'] };
  expect(collisionCaution(unchecked)).toBe('Collisions were not checked. Run the program in the air first.');
  expect(collisionCaution({ ...unchecked, free: ['gamma'] })).toContain('Other turns γ move');
  expect(collisionCaution({ ...unchecked, decided: null })).toBe('');
  expect(collisionCaution({ ...unchecked, collisions_checked: true })).toBe('');
});
