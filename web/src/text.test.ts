import { expect, it } from 'vitest';
import { fixed, modeName, percent, significant, withDeviation, withPower } from './text';

it('writes numbers that read well', () => {
  expect(fixed(14850.2, 0)).toBe('14\u202f850');
  expect(fixed(1234567.5, 1)).toBe('1\u202f234\u202f567.5');
  expect(fixed(-12345, 0)).toBe('-12\u202f345');
  expect(fixed(8000, 0)).toBe('8000');
  expect(fixed(null, 2)).toBe('–');
  expect(significant(0.01)).toBe('0.01');
  expect(significant(0)).toBe('0');
  expect(significant(120)).toBe('120');
  expect(significant(1.5e-7)).toBe('1.50e-7');
  expect(withPower(97062227)).toBe('9.706·10⁷');
  expect(withPower(2e-5)).toBe('2·10⁻⁵');
  expect(withPower(18.633)).toBe('18.63');
  expect(withPower(null)).toBe('–');
  expect(percent(0.0127, 2)).toBe('1.27\u202f%');
  expect(withDeviation(17.4123, 0.0352, 1, 2)).toBe('17.412\u202f±\u202f0.035');
  expect(withDeviation(17.4123, null, 1, 2)).toBe('17.41');
  expect(withDeviation(12345.6789, 0.0012, 1, 1)).toBe('12\u202f345.6789\u202f±\u202f0.0012');
  expect(withDeviation(0.021, 0.0012, 100, 2)).toBe('2.10\u202f±\u202f0.12');
  expect(withDeviation(1771.65, 9e-13, 1, 1)).toBe('1771.7');
});

it('says whose mode it is', () => {
  expect(modeName({ mode: 8, mode_of: 'tool' })).toBe('mode 8');
  expect(modeName({ mode: 8, mode_of: 'workpiece' })).toBe('mode 8 of the workpiece');
  expect(modeName({ mode: null, mode_of: null })).toBe('');
});
