import { describe, expect, it } from 'vitest';
import type { Fault, Field } from '../documents';
import { groupFields, inFile, isAt, labelOf, nameOf, parseValue, valueText } from './fields';

describe('a key in words', () => {
  it.each([
    ['cut.radial_depth_mm', 'Radial depth', 'millimetres', 'mm'],
    ['coefficients.tangential_n_per_mm2', 'Tangential', 'newtons per square millimetre', 'N/mm²'],
    ['coefficients.tangential_edge_n_per_mm', 'Tangential edge', 'newtons per millimetre', 'N/mm'],
    ['joint.rotational_stiffness_n_m_per_rad', 'Rotational stiffness', 'newton metres per radian', 'N m/rad'],
    ['joint.translational_damping_n_s_per_m', 'Translational damping', 'newton seconds per metre', 'N s/m'],
    ['smoothing.max_jerk_mm_per_s3', 'Max jerk', 'millimetres per second cubed', 'mm/s³'],
    ['acquisition.response_mv_per_m_per_s2', 'Response', 'millivolts per metre per second squared', 'mV/m/s²'],
    ['acquisition.response_mv_per_g', 'Response', 'millivolts per g', 'mV/g'],
    ['feed_mm_per_min', 'Feed', 'millimetres per minute', 'mm/min'],
    ['spindle.max_speed_rpm', 'Max speed', 'revolutions per minute', 'rpm'],
    ['tool.helix_deg', 'Helix', 'degrees', '°'],
  ])('%s', (key, name, words, symbol) => {
    expect(nameOf(key)).toEqual({ name, unit: { words, symbol } });
    expect(labelOf(key)).toBe(`${name} (${symbol})`);
  });
  it.each([
    ['tool.teeth', 'Teeth'],
    ['dynamics.keep_modes', 'Keep modes'],
    ['hits[0].file', 'File'],
    ['dynamics.x[0].damping_ratio', 'Damping ratio'],
    ['detector.false_alarms_per_hour', 'False alarms per hour'],
    ['robot.joint_min_position', 'Joint min position'],
    ['m', 'M'],
    ['coefficients.scale', 'Scale of the coefficients'],
    ['signal.scale', 'Scale'],
  ])('%s has no unit', (key, name) => {
    expect(nameOf(key)).toEqual({ name, unit: null });
    expect(labelOf(key)).toBe(name);
  });
});

const field = (key: string): Field => ({ key, value: 1, line: 1, comment: null });

it('groups fields by table in the order of the file', () => {
  const groups = groupFields(['title', 'tool.teeth', 'hits[0].file', 'hits[0].responses.x', 'hits[1].file', 'tool.diameter_mm'].map(field));
  expect(groups.map(({ heading, fields }) => [heading, fields.map(({ key }) => key)])).toEqual([
    ['General', ['title']],
    ['Tool', ['tool.teeth', 'tool.diameter_mm']],
    ['Hits 1', ['hits[0].file']],
    ['Hits 1, responses', ['hits[0].responses.x']],
    ['Hits 2', ['hits[1].file']],
  ]);
});

describe('a value', () => {
  it('is typed as it is read', () => {
    for (const value of [3, -1e-7, 'up', true, false, [4000, 16000], ['a', 'b']]) expect(parseValue(valueText(value), value)).toEqual({ value });
    expect(parseValue(' 4 , 5.5', [1])).toEqual({ value: [4, 5.5] });
  });
  it('keeps its kind', () => {
    expect(parseValue('', 3)).toEqual({ wrong: 'A number is needed.' });
    expect(parseValue('1,5', 3)).toEqual({ wrong: 'A number is needed.' });
    expect(parseValue('1, two', [1, 2])).toHaveProperty('wrong');
    expect(parseValue('7', 'up')).toEqual({ value: '7' });
  });
});

it('finds an error at its field, in its own file', () => {
  const fault: Fault = { text: '', file: 'a/lobes.toml', line: 3, field: 'tool.teeth', value: null, unit: null, rule: null, hint: null };
  expect(isAt(fault, 'tool.teeth', 'a/lobes.toml')).toBe(true);
  expect(isAt(fault, 'tool.diameter_mm', 'a/lobes.toml')).toBe(false);
  expect(isAt(fault, 'tool.teeth', 'b/lobes.toml')).toBe(false);
  expect(isAt(fault, 'tool.teeth', 'job.toml')).toBe(false);
  expect(isAt(null, 'tool.teeth', 'job.toml')).toBe(false);
  expect(inFile({ ...fault, file: null }, 'job.toml')).toBe(true);
});
