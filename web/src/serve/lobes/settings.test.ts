import { describe, expect, it } from 'vitest';
import { lobesSample, pointSample } from '../../lobes_sample';
import { lobesOf } from '../../views';
import { changesOf, differences, firstPoint, keysOf, placed, pointFacts, pointsOf, resolved, sameCurves, stepOf, type FileValues, type Settings } from './settings';

const file: FileValues = {
  fields: { 'tool.teeth': { value: 3, min: 1, max: 20, step: 1 }, 'cut.radial_depth_mm': { value: 1.8, min: 0, max: 12, step: 0.1 } },
  modes: [1, 2],
};
const as_in_file: Settings = { set: {}, modes: null, point: [6000, 0.5] };
const moved: Settings = { set: { 'tool.teeth': 4, 'cut.radial_depth_mm': 1.8 }, modes: [2], point: [7000, 0.5] };

describe('settings', () => {
  it('send what was moved', () => {
    expect(keysOf(as_in_file)).toEqual({});
    expect(keysOf(moved)).toEqual({ 'tool.teeth': 4, 'cut.radial_depth_mm': 1.8, 'dynamics.keep_modes': [2] });
  });
  it('have the same curves wherever the point is', () => {
    expect(sameCurves(as_in_file, { ...as_in_file, point: null })).toBe(true);
    expect(sameCurves(moved, { ...moved, set: { 'cut.radial_depth_mm': 1.8, 'tool.teeth': 4 } })).toBe(true);
    expect(sameCurves(as_in_file, moved)).toBe(false);
  });
  it('would change in the file what differs from it', () => {
    expect(changesOf(as_in_file, file)).toEqual([]);
    expect(changesOf(moved, file)).toEqual([
      { key: 'tool.teeth', before: 3, after: 4 },
      { key: 'dynamics.keep_modes', before: [1, 2], after: [2] },
    ]);
  });
  it('say what tells them apart', () => {
    expect(differences(moved, as_in_file, file)).toEqual(['teeth 4, modes 2', 'teeth 3, modes 1, 2']);
    const deeper = { ...as_in_file, set: { 'cut.radial_depth_mm': 2.5 } };
    expect(differences(deeper, as_in_file, file)).toEqual(['radial depth 2.5 mm', 'radial depth 1.8 mm']);
    expect(differences(moved, moved, file)).toEqual(['same settings', 'same settings']);
  });
  it('name the scale of a material\'s coefficients', () => {
    const material: FileValues = { fields: { 'coefficients.scale': { value: 1, min: 0.1, max: 3, step: 0.01 } }, modes: [] };
    const softer = { ...as_in_file, set: { 'coefficients.scale': 0.85 } };
    expect(differences(softer, as_in_file, material)).toEqual(['scale of the coefficients 0.85', 'scale of the coefficients 1']);
    expect(changesOf(softer, material)).toEqual([{ key: 'coefficients.scale', before: 1, after: 0.85 }]);
  });
  it('stay what they are when the file changes', () => {
    const kept = resolved(as_in_file, file);
    const later = { fields: { ...file.fields, 'tool.teeth': { ...file.fields['tool.teeth']!, value: 4 } }, modes: [2] };
    expect(differences(as_in_file, kept, later)).toEqual(['teeth 4, modes 2', 'teeth 3, modes 1, 2']);
  });
});

const lobes = lobesOf(lobesSample);
const { limit } = lobesSample;
const stable = { ...pointSample, stable: true, spectral_radius: 0.9 };

describe('operating point', () => {
  it('has a margin to the limit at its speed', () => {
    const facts = pointFacts([5000, 0.25], lobes, limit, []);
    expect(facts).toMatchObject({ stable: true, evaluated: false, limit_mm: 1, margin: 0.75, frequency_hz: 540, mode: 'mode 2' });
  });
  it('believes what was evaluated there', () => {
    const here = pointSample;
    expect(pointFacts([5800, 1.2], lobes, limit, [here])).toMatchObject({ stable: false, evaluated: true, frequency_hz: 918, mode: 'mode 3' });
    expect(pointFacts([5801, 1.2], lobes, limit, [here])).toMatchObject({ stable: true, evaluated: false, frequency_hz: 922, mode: 'mode 3 of the workpiece' });
  });
  it('has nothing evaluated of other settings', () => {
    const here = { ...stable, spindle_speed_rpm: 6000, axial_depth_mm: 0.5, limit_depth_mm: 2.4, margin: 0.79 };
    const evaluated = { points: [here], settings: as_in_file };
    expect(pointsOf(null, as_in_file)).toEqual([]);
    expect(pointsOf(evaluated, as_in_file)).toEqual([here]);
    expect(pointsOf(evaluated, { ...as_in_file, point: [7000, 0.5] })).toEqual([here]); // another point is told by its place
    const slid = { ...as_in_file, set: { 'tool.teeth': 4 } };
    expect(pointsOf(evaluated, slid)).toEqual([]);
    expect(pointFacts([6000, 0.5], lobes, limit, pointsOf(evaluated, as_in_file))).toMatchObject({ evaluated: true, margin: 0.79 });
    expect(pointFacts([6000, 0.5], lobes, limit, pointsOf(evaluated, slid))).toMatchObject({ evaluated: false, limit_mm: 1.5 });
  });
  it('takes the limit that was found at that speed', () => {
    const here = { ...stable, limit_depth_mm: 2.4, margin: 0.5 };
    expect(pointFacts([5800, 1.2], lobes, limit, [here])).toMatchObject({ evaluated: true, limit_mm: 2.4, margin: 0.5 });
    const none = { ...here, limit_depth_mm: null, margin: null };
    expect(pointFacts([5800, 1.2], lobes, limit, [none])).toMatchObject({ stable: true, limit_mm: null, margin: null });
  });
  it('has no margin where there is no limit', () => {
    expect(pointFacts([8000, 2.9], lobes, limit, [])).toMatchObject({ stable: true, limit_mm: null, searched_mm: 3, margin: null });
  });
  it('begins in the middle, stable', () => {
    expect(firstPoint(lobes)).toEqual([6000, 0.75]);
  });
  it('stays inside, on steps', () => {
    const ranges = { speed: [4000, 16000] as [number, number], depth: [0, 3] as [number, number] };
    expect(placed([3999.4, 3.2], ranges)).toEqual([4000, 3]);
    expect(placed([9000.6, 1.2345], ranges)).toEqual([9001, 1.234]);
    expect(placed([20000, -1], ranges)).toEqual([16000, 0]);
    expect([stepOf([0, 3]), stepOf([0, 1]), stepOf([4000, 16000]), stepOf([0, 0.05])]).toEqual([0.002, 0.001, 10, 0.00005]);
  });
});
