// The keys of a file as a form: names and units in words, groups by table.
import { capital } from '../../text';
import type { Fault, Field, Value } from '../documents';

export interface Unit {
  symbol: string; // "N/mm²"
  words: string; // "newtons per square millimetre"
}

const atoms: Record<string, [symbol: string, one: string, many: string]> = {
  n: ['N', 'newton', 'newtons'],
  m: ['m', 'metre', 'metres'],
  m2: ['m²', 'square metre', 'square metres'],
  m3: ['m³', 'cubic metre', 'cubic metres'],
  mm: ['mm', 'millimetre', 'millimetres'],
  mm2: ['mm²', 'square millimetre', 'square millimetres'],
  mm3: ['mm³', 'cubic millimetre', 'cubic millimetres'],
  um: ['µm', 'micrometre', 'micrometres'],
  in: ['in', 'inch', 'inches'],
  s: ['s', 'second', 'seconds'],
  s2: ['s²', 'second squared', 'seconds squared'],
  s3: ['s³', 'second cubed', 'seconds cubed'],
  ms: ['ms', 'millisecond', 'milliseconds'],
  us: ['µs', 'microsecond', 'microseconds'],
  min: ['min', 'minute', 'minutes'],
  hour: ['h', 'hour', 'hours'],
  hz: ['Hz', 'hertz', 'hertz'],
  khz: ['kHz', 'kilohertz', 'kilohertz'],
  rpm: ['rpm', 'revolution per minute', 'revolutions per minute'],
  deg: ['°', 'degree', 'degrees'],
  rad: ['rad', 'radian', 'radians'],
  kg: ['kg', 'kilogram', 'kilograms'],
  g: ['g', 'g', 'g'],
  gpa: ['GPa', 'gigapascal', 'gigapascals'],
  mpa: ['MPa', 'megapascal', 'megapascals'],
  mv: ['mV', 'millivolt', 'millivolts'],
  v: ['V', 'volt', 'volts'],
  w: ['W', 'watt', 'watts'],
  kw: ['kW', 'kilowatt', 'kilowatts'],
  percent: ['%', 'percent', 'percent'],
};
const afterPerAlone = new Set(['min', 'hour', 'in', 'g', 'v']); // words of their own elsewhere

/** The unit that the words name, "n_m_per_rad": newton metres per radian; null where they name none. */
function unitFrom(words: string[]): Unit | null {
  const [over = [], ...under] = words.join(' ').split(' per ').map((part) => part.split(' '));
  const product = (part: string[], plural: boolean): Unit | null => {
    const found = part.map((word) => atoms[word]);
    if (found.some((atom) => !atom)) return null;
    const last = found.length - 1;
    return { symbol: found.map((atom) => atom![0]).join(' '), words: found.map((atom, i) => (plural && i === last ? atom![2] : atom![1])).join(' ') };
  };
  if (over.some((word) => afterPerAlone.has(word))) return null;
  const top = product(over, true);
  const below = under.map((part) => product(part, false));
  if (!top || below.some((part) => !part)) return null;
  const bracket = (symbol: string) => (symbol.includes(' ') ? `(${symbol})` : symbol);
  return {
    symbol: [top.symbol, ...below.map((part) => bracket(part!.symbol))].join('/'),
    words: [top.words, ...below.map((part) => part!.words)].join(' per '),
  };
}

export interface KeyName {
  name: string; // "Radial depth"
  unit: Unit | null;
}

/** Of keys whose last part says too little without its table. */
const ownNames: Record<string, string> = { 'coefficients.scale': 'Scale of the coefficients' };

/** What the last part of a key says. */
export function nameOf(key: string): KeyName {
  const own = ownNames[key];
  if (own !== undefined) return { name: own, unit: null };
  const last = key.slice(key.lastIndexOf('.') + 1);
  const words = last.split('_');
  for (let i = 1; i < words.length; ++i) {
    const unit = unitFrom(words.slice(i));
    if (unit) return { name: capital(words.slice(0, i).join(' ')), unit };
  }
  return { name: capital(words.join(' ')), unit: null };
}

/** "Radial depth (mm)". */
export function labelOf(key: string): string {
  const { name, unit } = nameOf(key);
  return unit ? `${name} (${unit.symbol})` : name;
}

export interface FieldGroup {
  table: string; // "hits[0]"; empty: above all tables
  heading: string; // "Hits 1"
  fields: Field[];
}

/** The fields by the table they stand in, in the file's order. */
export function groupFields(fields: Field[]): FieldGroup[] {
  const groups = new Map<string, FieldGroup>();
  for (const field of fields) {
    const table = field.key.slice(0, Math.max(0, field.key.lastIndexOf('.')));
    const group = groups.get(table) ?? { table, heading: headingOf(table), fields: [] };
    group.fields.push(field);
    groups.set(table, group);
  }
  return [...groups.values()];
}

function headingOf(table: string): string {
  if (table === '') return 'General';
  const parts = table.split('.').map((part) => part.replace(/_/g, ' ').replace(/\[(\d+)\]/g, (_, index: string) => ` ${Number(index) + 1}`));
  return capital(parts.join(', '));
}

/** A value as it is typed: lists with commas. */
export function valueText(value: Value): string {
  return Array.isArray(value) ? value.map(String).join(', ') : String(value);
}

/** What was typed, as a value of the same kind as the one before; a text says what is wrong with it. */
export function parseValue(typed: string, before: Value): { value: Value } | { wrong: string } {
  if (typeof before === 'number') {
    const value = numberIn(typed);
    return value === null ? { wrong: 'A number is needed.' } : { value };
  }
  if (typeof before === 'boolean') return { value: typed === 'true' };
  if (!Array.isArray(before)) return { value: typed };
  const parts = typed.split(',').map((part) => part.trim());
  if (before.every((part) => typeof part === 'string')) return { value: parts };
  const numbers = parts.map(numberIn);
  return numbers.some((part) => part === null) ? { wrong: 'Numbers are needed, with commas between them.' } : { value: numbers as number[] };
}

function numberIn(typed: string): number | null {
  const value = Number(typed);
  return typed.trim() === '' || !Number.isFinite(value) ? null : value;
}

/** Whether the error is about this key of this file, or about one inside it. */
export function isAt(error: Fault | null, key: string, file: string): boolean {
  return error !== null && error.field === key && inFile(error, file);
}

/** Whether the error is about this file, and not about one that it names. */
export function inFile(error: Fault, file: string): boolean {
  return error.file === null || error.file === file;
}
