import { expect, it } from 'vitest';
import { bandCurve } from './bands';

it('draws runs of one sample sample by sample', () => {
  const values = [1, 3, 2];
  expect(bandCurve({ low: values, high: [...values] }, 0.5)).toEqual({ time_s: [0, 0.5, 1], values });
  expect(bandCurve({ low: [], high: [] }, 0.5)).toEqual({ time_s: [], values: [] });
});

it('draws the lowest and the highest value of longer runs within each', () => {
  expect(bandCurve({ low: [0, -1], high: [0, 4] }, 2)).toEqual({ time_s: [0.5, 1.5, 2.5, 3.5], values: [0, 0, -1, 4] });
});
