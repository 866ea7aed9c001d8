import { describe, expect, it } from 'vitest';
import type { Inspection } from '../documents';
import { asWhole, filesOf, firstAnswers, hitsToml, missingAnswers, relativeTo, sameColumns, type Recording } from './hits_text';

function recording(path: string, columns: Inspection['columns'], more: Partial<Inspection> = {}): Recording {
  return { path, inspection: { kind: 'record', columns, rows: 4096, sample_rate_hz: null, direction_guess: null, questions: [], files: [], time: null, ...more } };
}

const si = [
  { name: 'time_s', unit: 's', guess: 'time' as const },
  { name: 'force_n', unit: 'N', guess: 'force' as const },
  { name: 'ax_m_per_s2', unit: 'm/s²', guess: 'response' as const, direction: 'x' },
  { name: 'ay_m_per_s2', unit: 'm/s²', guess: 'response' as const },
];
const volts = [
  { name: 'ch1', unit: 'V', guess: 'force' as const },
  { name: 'ch "2"', unit: 'V', guess: 'response' as const },
  { name: 'ch3', unit: null, guess: null },
];

describe('a recording that says all', () => {
  const hits = [recording('hits/x_1.csv', si, { direction_guess: 'x' }), recording('hits/y_1.csv', si, { direction_guess: '-y' })];
  const answers = firstAnswers(hits);
  it('leaves nothing to ask', () => {
    expect(missingAnswers(answers)).toEqual([]);
  });
  it('becomes a hits.toml', () => {
    expect(hitsToml('hits/hits.toml', hits, answers)).toBe(`[acquisition]
response = "acceleration"

[[hits]]
file = "x_1.csv"
time = "time_s"
force = "force_n"
force_direction = "x"
responses = { x = "ax_m_per_s2", y = "ay_m_per_s2" }

[[hits]]
file = "y_1.csv"
time = "time_s"
force = "force_n"
force_direction = "-y"
responses = { x = "ax_m_per_s2", y = "ay_m_per_s2" }
`);
  });
});

describe('a recording in volts without time', () => {
  const hits = [recording('a.wav', volts)];
  const first = firstAnswers(hits);
  it('is asked for the sensors and the rate', () => {
    expect(first.roles).toEqual(['force', 'x', 'unused']);
    expect(missingAnswers(first)).toEqual(['Without a time column the sampling rate is needed.', 'The force is in volts: its sensitivity is needed.', 'The response is in volts: its sensitivity is needed.']);
  });
  it('takes mV per g', () => {
    const answers = { ...first, force_mv_per_n: '2.25', response_mv_per_unit: '100', sample_rate_hz: '51200', roles: ['force' as const, '-y' as const, 'unused' as const] };
    expect(missingAnswers(answers)).toEqual([]);
    const text = hitsToml('hits.toml', hits, answers);
    expect(text).toContain('sample_rate_hz = 51200\nforce_mv_per_n = 2.25\nresponse_mv_per_g = 100\n');
    expect(text).toContain('responses = { -y = "ch \\"2\\"" }');
    expect(text).not.toContain('time =');
  });
});

describe('force and response in files of their own', () => {
  const columns = [
    { name: 'Hammer', unit: 'N', guess: 'force' as const },
    { name: 'Tip', unit: 'g', guess: 'response' as const, direction: 'x' },
  ];
  const files = ['hit1_force.txt', 'hit1_accel.txt'];
  const alone = recording('taps/hit1_force.txt', [columns[0]!], { sample_rate_hz: 4000 });
  const both = (path: string, more: Partial<Inspection> = {}) => recording(path, columns, { sample_rate_hz: 4000, files, ...more });
  it('are one recording, whichever came first', () => {
    const other = recording('taps/b.csv', si);
    const whole = asWhole([alone, other, both('taps/hit1_accel.txt')]);
    expect(whole.map(({ path }) => path)).toEqual(['taps/hit1_force.txt', 'taps/b.csv']);
    expect(whole[0]!.inspection.columns).toHaveLength(2);
    expect(asWhole([both('taps/hit1_force.txt'), both('taps/hit1_accel.txt')])).toHaveLength(1);
    expect(filesOf(whole[0]!)).toEqual(['taps/hit1_force.txt', 'taps/hit1_accel.txt']);
    expect(filesOf(other)).toEqual(['taps/b.csv']);
  });
  it('become one hit of a hits.toml, which leaves their rate to them', () => {
    const hits = asWhole([alone, both('taps/hit1_accel.txt')]);
    const answers = firstAnswers(hits);
    expect(missingAnswers(answers)).toEqual([]);
    expect(hitsToml('taps/hits.toml', hits, answers)).toBe(`[acquisition]
response = "acceleration"
response_mv_per_g = 1000  # the response is in g

[[hits]]
file = ["hit1_force.txt", "hit1_accel.txt"]
force = "Hammer"
force_direction = "x"
responses = { x = "Tip" }
`);
    expect(hitsToml('hits.toml', [both('taps/hit1_force.txt', { time: 'Zeit' })], answers)).toContain('file = ["taps/hit1_force.txt", "taps/hit1_accel.txt"]\ntime = "Zeit"\n');
  });
  it('are asked for a rate that they do not say', () => {
    expect(missingAnswers(firstAnswers([both('hit1_force.txt', { sample_rate_hz: null })]))).toEqual(['Without a time column the sampling rate is needed.']);
  });
});

it('turns other units into sensitivities of the file', () => {
  const columns = [si[0]!, { ...si[1]!, unit: 'lbf' }, { ...si[2]!, unit: 'g' }];
  const hits = [recording('a.csv', columns)];
  const answers = firstAnswers(hits);
  expect([answers.force_unit, answers.response_unit]).toEqual(['lbf', 'g']);
  const text = hitsToml('hits.toml', hits, answers);
  // As if a sensor gave 1 V for each g and each lbf, which is 4.448 N.
  expect(text).toContain('force_mv_per_n = 224.80894  # the force is in lbf\n');
  expect(text).toContain('response_mv_per_g = 1000  # the response is in g\n');
});

it('supposes what columns say of themselves', () => {
  const columns = [
    { name: 'time_ms', unit: 'ms', guess: 'time' as const },
    { name: 'f', unit: 'n', guess: 'force' as const },
    { name: 'b', unit: 'm/s^2', guess: 'response' as const, direction: 'y' },
    { name: 'a', unit: 'm/s^2', guess: 'response' as const, direction: null },
    { name: 'a2', unit: null, guess: 'force' as const },
  ];
  const answers = firstAnswers([recording('a.csv', columns, { sample_rate_hz: 10240 })]);
  expect(answers).toMatchObject({ roles: ['unused', 'force', 'y', 'x', 'unused'], response: 'acceleration', response_unit: 'm/s²', force_unit: 'N', sample_rate_hz: '10240' });
  expect(firstAnswers([recording('a.csv', [{ name: 'd', unit: 'um', guess: 'response' }])])).toMatchObject({ response: 'displacement', response_unit: 'µm' });
});

it('reads millivolts', () => {
  const hits = [recording('a.csv', [si[0]!, { ...si[1]!, unit: 'mV' }, { ...si[2]!, unit: 'mm/s' }])];
  const answers = { ...firstAnswers(hits), force_mv_per_n: '2.25' };
  expect(answers.response).toBe('velocity');
  const text = hitsToml('hits.toml', hits, answers);
  expect(text).toContain('force_mv_per_n = 2250  # the force is in mV\n');
  expect(text).toContain('response_mv_per_m_per_s = 1000000  # the response is in mm/s\n');
});

it('names what does not fit', () => {
  const answers = firstAnswers([recording('a.csv', si)]);
  expect(missingAnswers({ ...answers, roles: ['time', 'unused', 'x', '-x'] })).toEqual(['One column must be the force.', 'Two columns are responses in the same direction.']);
  expect(missingAnswers({ ...answers, roles: ['time', 'force', 'unused', 'unused'] })).toEqual(['At least one column must be a response.']);
});

it('takes directions by the file, whatever order files come in', () => {
  const [x, y] = [recording('x.csv', si, { direction_guess: 'x' }), recording('y.csv', si)];
  const answers = { ...firstAnswers([x]), directions: { 'y.csv': '-z' } };
  const directions = (hits: Recording[]) => [...hitsToml('hits.toml', hits, answers).matchAll(/force_direction = "(.*)"/g)].map((found) => found[1]);
  expect([directions([x]), directions([x, y]), directions([y, x])]).toEqual([['x'], ['x', '-z'], ['-z', 'x']]);
});

it('asks once about recordings with the same columns', () => {
  const groups = sameColumns([recording('a.csv', si), recording('b.csv', volts), recording('c.csv', si)]);
  expect(groups.map((group) => group.map(({ path }) => path))).toEqual([['a.csv', 'c.csv'], ['b.csv']]);
});

it('writes paths relative to the file', () => {
  expect(relativeTo('hits.toml', 'a/x.csv')).toBe('a/x.csv');
  expect(relativeTo('a/hits.toml', 'a/x.csv')).toBe('x.csv');
  expect(relativeTo('a/b/hits.toml', 'a/c/x.csv')).toBe('../c/x.csv');
  expect(relativeTo('a/hits.toml', 'x.csv')).toBe('../x.csv');
});
