import { describe, expect, it } from 'vitest';
import type { ExplainedPeak, Reading, Slot } from './documents';
import { sweepSample } from './lobes_sample';
import { coefficientRows, intervalsText, jointRows, reachOf, readingText, slotGroups, sweptOf } from './verb_views';
import { sampleReport } from './report_sample';

const chatter: Reading = {
  kind: 'chatter',
  rotations: 0,
  mirrored: false,
  of_tooth_passing: true,
  mode: 3,
  mode_of: 'tool',
  mode_frequency_hz: 433,
  expected_hz: 433,
  difference_hz: 0.4,
  tolerance_hz: 2,
  likelihood_per_hz: 0.3,
};

const report = sampleReport();

describe('readings', () => {
  it('say how a peak follows from its mode', () => {
    expect(readingText(chatter)).toBe('mode 3 at 433.00 Hz');
    expect(readingText({ ...chatter, rotations: 2 })).toBe('mode 3 at 433.00 Hz + 2 × rotation');
    expect(readingText({ ...chatter, rotations: -2 })).toBe('mode 3 at 433.00 Hz − 2 × rotation');
    expect(readingText({ ...chatter, rotations: -9, mirrored: true, mode_of: 'workpiece' })).toBe('9 × rotation − mode 3 of the workpiece at 433.00 Hz');
  });
  it('name multiples of the rotation, and what is not known', () => {
    expect(readingText({ ...chatter, kind: 'tooth passing', rotations: 6 })).toBe('6 × rotation');
    const alone = (kind: ExplainedPeak['kind']) => readingText({ kind, mode: null, mode_of: null });
    expect([alone('chatter'), alone('cut or chatter'), alone('unexplained')]).toEqual(['chatter of an ambiguous mode', 'the cut, or chatter', 'nothing known']);
  });
  it('are drawn beyond the highest peak', () => {
    const document = { ...report.explanation!, spindle_speed_rpm: 6000 };
    expect(reachOf({ ...document, peaks: [{ ...document.peaks[0]!, frequency_hz: 1000 }] })).toBeCloseTo(1060);
    expect(reachOf({ ...document, peaks: [] })).toBeCloseTo(212);
  });
});

describe('sweep', () => {
  it('knows what it varies', () => {
    const sweep = sweepSample;
    expect(sweptOf(sweep)).toMatchObject({ name: 'Lead', unit: '°', values: [-10, 0, 10] });
    expect(sweptOf(sweep).valueOf(sweep.points[0]!)).toBe(1);
    expect(sweptOf({ ...sweep, sweep: 'radial_depth', radial_depth_mm: [1] })).toMatchObject({ name: 'Radial depth', unit: 'mm', values: [1] });
  });
  it('writes intervals', () => {
    expect(intervalsText([[0.5, 1.25], [2, 3]])).toBe('0.5 to 1.25, 2 to 3');
    expect(intervalsText([])).toBe('');
  });
});

it('groups slots by depth and speed, each by feed', () => {
  const slot = (feed: number, depth: number, speed: number | null): Slot => ({ line: 2, feed_per_tooth_mm: feed, axial_depth_mm: depth, spindle_speed_rpm: speed, force_n: [1, 2, 3], residual_n: [0, 0, 0] });
  const groups = slotGroups([slot(0.2, 1, 3000), slot(0.1, 1, 3000), slot(0.1, 2, null)]);
  expect(groups.map(({ label }) => label)).toEqual(['1 mm deep, 3000 rpm', '2 mm deep']);
  expect(groups[0]!.slots.map((one) => one.feed_per_tooth_mm)).toEqual([0.1, 0.2]);
});

it('has a row of coefficients for each direction that was found', () => {
  const none = { tangential_n_per_mm2: null, radial_n_per_mm2: null, axial_n_per_mm2: null, tangential_edge_n_per_mm: null, radial_edge_n_per_mm: null, axial_edge_n_per_mm: null };
  const rows = coefficientRows({ coefficients: { ...none, tangential_n_per_mm2: 700, tangential_edge_n_per_mm: 12 }, std: { ...none, tangential_n_per_mm2: 7 } });
  expect(rows).toEqual([{ direction: 'tangential', cutting: { value: 700, std: 7 }, edge: { value: 12, std: null }, r_squared: null, noise_n: null }]);
});

it('has the four values of a joint', () => {
  const four = <T>(value: T) => ({ translational_stiffness_n_per_m: value, translational_damping_n_s_per_m: value, rotational_stiffness_n_m_per_rad: value, rotational_damping_n_m_s_per_rad: value });
  const rows = jointRows({ ...report.joint!, joint: four(2), std: four(0.1), identifiable: four(true), visible_up_to: { translational_stiffness_n_per_m: 9, rotational_stiffness_n_m_per_rad: null } });
  expect(rows.map(({ unit }) => unit)).toEqual(['N/m', 'N·s/m', 'N·m/rad', 'N·m·s/rad']);
  expect(rows.map(({ visible_up_to: visible }) => visible)).toEqual([9, null, null, null]);
});
