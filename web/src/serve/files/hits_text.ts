// hits.toml made of what recordings look like and of what was answered.
import type { ColumnGuess, Inspection } from '../documents';

export type Role = 'unused' | 'time' | 'force' | 'x' | 'y' | 'z' | '-x' | '-y' | '-z'; // a direction: a response in it

export interface Recording {
  path: string; // of several files the first
  inspection: Inspection;
}

export type ResponseKind = 'acceleration' | 'velocity' | 'displacement';

export interface Answers {
  roles: Role[]; // of each column
  directions: Record<string, string>; // of the force, by the path of the file; without: as the file lets one suppose
  response: ResponseKind;
  force_unit: string;
  force_mv_per_n: string; // as typed; where the force is in volts
  response_unit: string;
  response_mv_per_unit: string; // as typed, per sensorUnit; where the response is in volts
  sample_rate_hz: string; // as typed; where there is no time
  has_rate: boolean; // several files: they say it
}

/** A unit of a column, and the key of its sensitivity. Those of hits.toml are for records in volts; of another unit they say how many thousandths of it the key's unit is. */
interface UnitChoice {
  unit: string;
  per: string; // at the end of the key
  mv_per_unit: number | null; // null: the sensor says
  times: number; // what the sensor says is multiplied by
}

function known(unit: string, per: string, mv_per_unit: number): UnitChoice {
  return { unit, per, mv_per_unit, times: 1 };
}

/** What a sensor gives. */
function voltages(per: string): UnitChoice[] {
  return [
    { unit: 'V', per, mv_per_unit: null, times: 1 },
    { unit: 'mV', per, mv_per_unit: null, times: 1000 },
  ];
}

export const force_units: UnitChoice[] = [known('N', 'n', 1000), known('kN', 'n', 1), known('lbf', 'n', 1000 / 4.4482216152605), ...voltages('n')];

/** The first of each: the unit of records without a sensitivity. */
export const response_units: Record<ResponseKind, UnitChoice[]> = {
  acceleration: [known('m/s²', 'm_per_s2', 1000), known('g', 'g', 1000), ...voltages('g')],
  velocity: [known('m/s', 'm_per_s', 1000), known('mm/s', 'm_per_s', 1e6), ...voltages('m_per_s')],
  displacement: [known('m', 'm', 1000), known('mm', 'm', 1e6), known('µm', 'm', 1e9), ...voltages('m')],
};

export function isVoltage(unit: string): boolean {
  return unit === 'V' || unit === 'mV';
}

/** Names the columns of a recording. */
export function columnsOf({ inspection }: Recording): string {
  return inspection.columns.map(({ name }) => name).join('\n');
}

/** The paths of a recording's files: its own, or those of force and responses apart. */
export function filesOf({ path, inspection }: Recording): string[] {
  const folder = path.slice(0, path.lastIndexOf('/') + 1);
  return inspection.files.length === 0 ? [path] : inspection.files.map((name) => `${folder}${name}`);
}

/** Each once: files that are one hit together, in the place of each by itself. */
export function asWhole(recordings: Recording[]): Recording[] {
  const sets = new Map<string, Recording>(); // by each of their files
  for (const recording of recordings) {
    if (recording.inspection.files.length === 0) continue;
    const files = filesOf(recording);
    const whole = { ...recording, path: files[0]! };
    for (const path of files) sets.set(path, whole);
  }
  return [...new Set(recordings.map((recording) => sets.get(recording.path) ?? recording))];
}

/** Recordings with the same columns are asked about once. */
export function sameColumns(recordings: Recording[]): Recording[][] {
  const groups = new Map<string, Recording[]>();
  for (const recording of recordings) {
    const columns = columnsOf(recording);
    groups.set(columns, [...(groups.get(columns) ?? []), recording]);
  }
  return [...groups.values()];
}

function guessRoles(columns: Inspection['columns']): Role[] {
  const free: Role[] = ['x', 'y', 'z'];
  const take = (role: Role): Role => {
    const at = free.indexOf(role);
    return at < 0 ? 'unused' : free.splice(at, 1)[0]!;
  };
  const once = new Set<ColumnGuess>();
  return columns.map(({ unit, guess, direction }) => {
    if (guess === 'response') return take((direction ?? free[0] ?? 'unused') as Role);
    if (guess === null || once.has(guess) || (guess === 'time' && (unit ?? 's') !== 's')) return 'unused';
    once.add(guess);
    return guess;
  });
}

/** "m/s^2" is "m/s²". */
function sameUnit(a: string, b: string | null): boolean {
  const plain = (unit: string) => unit.toLowerCase().replace('^2', '²').replace(/^u(?=m)/, 'µ').replace('\u03bc', 'µ');
  return b !== null && plain(a) === plain(b);
}

function knownUnit(units: UnitChoice[], unit: string | null): string {
  return units.find((choice) => sameUnit(choice.unit, unit))?.unit ?? units[0]!.unit;
}

/** What the files let one suppose. */
export function firstAnswers(recordings: Recording[]): Answers {
  const { columns, sample_rate_hz: rate } = recordings[0]!.inspection;
  const unitOf = (wanted: ColumnGuess) => columns.find(({ guess }) => guess === wanted)?.unit ?? null;
  const unit = unitOf('response');
  const kinds = Object.keys(response_units) as ResponseKind[];
  const response = kinds.find((kind) => response_units[kind].some((choice) => sameUnit(choice.unit, unit))) ?? 'acceleration';
  return {
    roles: guessRoles(columns),
    directions: {},
    response,
    force_unit: knownUnit(force_units, unitOf('force')),
    force_mv_per_n: '',
    response_unit: knownUnit(response_units[response], unit),
    response_mv_per_unit: '',
    sample_rate_hz: rate === null ? '' : String(rate),
    has_rate: recordings[0]!.inspection.files.length > 0 && rate !== null,
  };
}

/** Of the hammer's force. */
export function directionOf({ directions }: Pick<Answers, 'directions'>, { path, inspection }: Recording): string {
  return directions[path] ?? inspection.direction_guess ?? 'x';
}

/** Whether hits.toml has to give the rate. */
export function needsRate({ roles, has_rate }: Pick<Answers, 'roles' | 'has_rate'>): boolean {
  return !has_rate && !roles.includes('time');
}

/** The unit that a sensor's sensitivity is asked for in: per g of an accelerometer. */
export function sensorUnit(response: ResponseKind): string {
  return response === 'acceleration' ? 'g' : response_units[response][0]!.unit;
}

interface Sensitivity {
  per: string;
  mv: number | null; // null: it is asked for, and no number was given
  remark: string; // of a unit that is no voltage
}

/** Null where none is needed: the numbers are in the first unit. */
function sensitivity(units: UnitChoice[], unit: string, typed: string): Sensitivity | null {
  const choice = units.find((one) => one.unit === unit)!;
  if (choice === units[0]) return null;
  const { per, mv_per_unit, times } = choice;
  if (mv_per_unit !== null) return { per, mv: mv_per_unit, remark: unit };
  const value = Number(typed);
  const given = typed.trim() !== '' && Number.isFinite(value) && value !== 0;
  return { per, mv: given ? value * times : null, remark: times === 1 ? '' : unit };
}

function sensitivities({ response, force_unit, force_mv_per_n, response_unit, response_mv_per_unit }: Answers) {
  return {
    force: sensitivity(force_units, force_unit, force_mv_per_n),
    response: sensitivity(response_units[response], response_unit, response_mv_per_unit),
  };
}

/** What is not answered yet, as sentences. */
export function missingAnswers(answers: Answers): string[] {
  const { roles, sample_rate_hz: rate } = answers;
  const { force, response } = sensitivities(answers);
  const count = (role: Role) => roles.filter((one) => one === role).length;
  const missing: string[] = [];
  if (count('force') !== 1) missing.push('One column must be the force.');
  const axes = roles.map((role) => role.replace('-', '')).filter((role) => ['x', 'y', 'z'].includes(role));
  if (axes.length === 0) missing.push('At least one column must be a response.');
  if (new Set(axes).size < axes.length) missing.push('Two columns are responses in the same direction.');
  if (count('time') > 1) missing.push('Only one column can be the time.');
  if (needsRate(answers) && !(Number(rate) > 0)) missing.push('Without a time column the sampling rate is needed.');
  if (force?.mv === null) missing.push('The force is in volts: its sensitivity is needed.');
  if (response?.mv === null) missing.push('The response is in volts: its sensitivity is needed.');
  return missing;
}

/** A path as seen from the folder of another file. */
export function relativeTo(file: string, path: string): string {
  const from = file.split('/').slice(0, -1);
  const to = path.split('/');
  while (from.length > 0 && to.length > 1 && from[0] === to[0]) {
    from.shift();
    to.shift();
  }
  return [...from.map(() => '..'), ...to].join('/');
}

const quoted = (text: string) => JSON.stringify(text);
const number = (value: number) => String(Number(value.toPrecision(8)));

/** The text of a hits.toml that stands at `path`; answers without what is missing. */
export function hitsToml(path: string, recordings: Recording[], answers: Answers): string {
  const { roles, response, sample_rate_hz: rate } = answers;
  const names = recordings[0]!.inspection.columns.map(({ name }) => name);
  const named = (role: Role) => quoted(names[roles.indexOf(role)] ?? '');
  const lines = ['[acquisition]', `response = ${quoted(response)}`];
  if (needsRate(answers)) lines.push(`sample_rate_hz = ${number(Number(rate))}`);
  for (const [name, sensor] of Object.entries(sensitivities(answers))) {
    if (sensor?.mv != null) lines.push(`${name}_mv_per_${sensor.per} = ${number(sensor.mv)}${sensor.remark === '' ? '' : `  # the ${name} is in ${sensor.remark}`}`);
  }
  const responses = roles.flatMap((role, i) => (/[xyz]$/.test(role) ? [`${role} = ${quoted(names[i]!)}`] : []));
  for (const recording of recordings) {
    const files = filesOf(recording).map((file) => quoted(relativeTo(path, file)));
    lines.push('', '[[hits]]', `file = ${files.length === 1 ? files[0] : `[${files.join(', ')}]`}`);
    if (roles.includes('time')) lines.push(`time = ${named('time')}`);
    else if (recording.inspection.time !== null) lines.push(`time = ${quoted(recording.inspection.time)}`);
    lines.push(`force = ${named('force')}`, `force_direction = ${quoted(directionOf(answers, recording))}`, `responses = { ${responses.join(', ')} }`);
  }
  return lines.join('\n') + '\n';
}
