import { expect, it } from 'vitest';
import { typedNumber } from './number_box';

it('takes a number inside its range', () => {
  const range: [number, number] = [-5, 20];
  expect(['7', ' 1e1 ', '-3.5', '25', '-1e9'].map((typed) => typedNumber(typed, range))).toEqual([7, 10, -3.5, 20, -5]);
  expect(['', '  ', '-', 'x', 'Infinity', '1e999'].map((typed) => typedNumber(typed, range))).toEqual([null, null, null, null, null, null]);
});
