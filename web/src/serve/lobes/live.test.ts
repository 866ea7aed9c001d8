import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { lobesSample, sweepSample } from '../../lobes_sample';
import type { LobesAnswer } from '../documents';
import { recordLatency } from '../latency';
import { curvesOf } from './live';

const answer: LobesAnswer = {
  sequence: 3,
  lobes: { ...lobesSample, boundary: [] },
  modes: [],
  fields: {},
  notes: [],
  milliseconds: 12,
};
const settings = { set: {}, modes: null, point: null };

describe('an answer', () => {
  it('of the limit alone has it as the boundary', () => {
    const curves = curvesOf(answer, { settings, answer: 'limit', started: 7 });
    expect(curves).toMatchObject({ whole: false, started: 7, settings });
    expect(curves.lobes.limit_mm).toEqual([0.5, 1.5, null]);
    expect(curves.lobes.boundary).toEqual(lobesSample.limit.slice(0, 2));
    expect(curves.lobes.searched_depth_mm).toBe(3);
  });
  it('of the chart has its own', () => {
    const curves = curvesOf({ ...answer, lobes: lobesSample }, { settings, answer: 'chart', started: null });
    expect(curves.whole).toBe(true);
    expect(curves.lobes.boundary).toEqual(lobesSample.boundary);
  });
});

it('of a sweep has its map in place of curves', () => {
  const curves = curvesOf({ ...answer, lobes: sweepSample }, { settings, answer: 'limit', started: null });
  expect(curves.sweep).toBe(sweepSample);
  expect(curves.lobes.limit_mm).toEqual([]);
  expect(curvesOf(answer, { settings, answer: 'limit', started: null }).sweep).toBeNull();
});

describe('latency', () => {
  let now = 0;
  beforeEach(() => {
    vi.stubGlobal('window', {});
    vi.stubGlobal('performance', { now: () => now, measure: (_: string, { start, end }: { start: number; end: number }) => ({ duration: end - start }), clearMeasures: () => {} });
  });
  afterEach(() => void vi.unstubAllGlobals());
  it('is from the event until now, of the last 200', () => {
    for (now = 1; now <= 250; ++now) recordLatency(0);
    expect(window.robomillLatency).toEqual(Array.from({ length: 200 }, (_, i) => 51 + i));
  });
});
