import { expect, it } from 'vitest';
import { bandCurve, bandCurves } from './bands';

it('draws runs of one sample sample by sample', () => {
  const values = [1, 3, 2];
  expect(bandCurve({ low: values, high: [...values] }, 0.5)).toEqual({ time_s: [0, 0.5, 1], values });
  expect(bandCurve({ low: [], high: [] }, 0.5)).toEqual({ time_s: [], values: [] });
});

it('draws the lowest and the highest value of longer runs within each', () => {
  expect(bandCurve({ low: [0, -1], high: [0, 4] }, 2)).toEqual({ time_s: [0.5, 1.5, 2.5, 3.5], values: [0, 0, -1, 4] });
});

it('draws runs of one value as points, else between the lowest and the highest', () => {
  const points = { low: [1, 2], high: [1, 2] };
  expect(bandCurves([points], 2)).toEqual({ time_s: [0, 2], values: [[1, 2]] });
  expect(bandCurves([points, { low: [3, 4], high: [3, 5] }], 2)).toEqual({ time_s: [0.5, 1.5, 2.5, 3.5], values: [[1, 1, 2, 2], [3, 3, 4, 5]] });
  expect(bandCurves([{ low: [], high: [] }], 2)).toEqual({ time_s: [], values: [[]] });
});
