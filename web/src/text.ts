// Numbers and names as the page writes them.
import { thinSpace } from './figures/theme';
import type { Num, Owner } from './documents';

export const dash = '–';

export function scaled(value: Num, factor: number): Num {
  return value === null ? null : factor * value;
}

function groupThousands(digits: string): string {
  const whole = digits.replace(/^-/, '').split('.')[0] ?? '';
  return whole.length < 5 ? digits : digits.replace(whole, whole.replace(/\d(?=(\d{3})+$)/g, `$&${thinSpace}`));
}

function withoutZeros(digits: string): string {
  return digits.includes('.') ? digits.replace(/\.?0+$/, '') : digits;
}

/** That many decimals, a thin space between thousands from 10 000 on; an en dash for null. */
export function fixed(value: Num, decimals: number): string {
  return value === null ? dash : groupThousands(value.toFixed(decimals));
}

/** Three significant digits, without an exponent or zeros at its end where that reads well; an en dash for null. */
export function significant(value: Num): string {
  if (value === null) return dash;
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size < 1e-4 || size >= 1e6) return value.toExponential(2);
  return withoutZeros(fixed(value, Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(size))))));
}

/** Up to that many significant digits, as %g writes them between 1e-4 and 1e6. */
export function general(value: number, digits: number): string {
  return String(Number(value.toPrecision(digits)));
}

/** Four significant digits with the power of ten where that reads better: "9.706·10⁷"; an en dash for null. */
export function withPower(value: Num): string {
  if (value === null) return dash;
  const size = Math.abs(value);
  if (size === 0 || (size >= 1e-3 && size < 1e4)) return general(value, 4);
  const [digits = '', power = ''] = value.toExponential(3).split('e');
  const raised = [...String(Number(power))].map((c) => (c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'.charAt(Number(c)))).join('');
  return `${withoutZeros(digits)}·10${raised}`;
}

export function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** A ratio as percent: 0.0127 with 2 decimals is "1.27 %"; an en dash for null. */
export function percent(ratio: Num, decimals: number): string {
  return ratio === null ? dash : `${(100 * ratio).toFixed(decimals)}${thinSpace}%`;
}

/** "17.412 ± 0.035": decimals so that the standard deviation shows two digits; without one, or with one of mere rounding, `decimals`. */
export function withDeviation(value: Num, deviation: Num, scale: number, decimals: number): string {
  if (value === null) return dash;
  const spread = deviation === null ? 0 : scale * deviation;
  if (!(spread > 1e-9 * Math.abs(scale * value))) return fixed(scale * value, decimals);
  const shown = Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(spread))));
  return `${fixed(scale * value, shown)}${thinSpace}±${thinSpace}${spread.toFixed(shown)}`;
}

/** "mode 3", "mode 3 of the workpiece"; empty where no mode is named. */
export function modeName({ mode = null, mode_of }: { mode?: Num; mode_of?: Owner | null } = {}): string {
  return mode === null ? '' : `mode ${mode}${mode_of === 'workpiece' ? ' of the workpiece' : ''}`;
}
