import { describe, expect, it } from 'vitest';
import type { FrfDocument, ModesDocument } from './documents';
import { lobesSample } from './lobes_sample';
import { sampleReport } from './report_sample';
import { assemblyOf, bandsOf, feedOf, frfsOf, lobesOf, modesOf, valueAt } from './views';

const { plan, modes: fitted, frf: measuredSample, assembly } = sampleReport();
const modes: ModesDocument = { ...fitted!, modes: fitted!.modes.slice(0, 2), fit: { ...fitted!.fit!, relative_error_by_frf: { xx: 0.03 } } };

it('joins neighbouring lines to bands', () => {
  const axis = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100];
  expect(bandsOf(axis, [])).toEqual([]);
  expect(bandsOf(axis, [10, 40, 50, 100])).toEqual([[10, 15], [35, 55], [95, 100]]);
  expect(bandsOf(axis, [42, 43])).toEqual([[45, 55]]);
});

it('numbers the modes of each structure from one, with their share in the limit', () => {
  const shared = { ...plan!, limit_share: { tool: [0.25, 0.75], workpiece: [] } };
  const all = modesOf({ modes, workpiece_modes: { ...modes, modes: modes.modes.slice(0, 1) }, plan: shared });
  expect(all.map(({ mode, mode_of, limit_share }) => [mode, mode_of, limit_share])).toEqual([[1, 'tool', 0.25], [2, 'tool', 0.75], [1, 'workpiece', null]]);
  expect(modesOf({ modes: null, workpiece_modes: null, plan: null })).toEqual([]);
});

it('makes curves, band and map of lobes.json', () => {
  const { spectral_radius, uncertainty, ...curves } = lobesSample;
  expect(lobesOf(curves)).toMatchObject({ limit_mm: [0.5, 1.5, null], searched_depth_mm: 3, band: null, map: null });
  const more = lobesOf(lobesSample);
  expect(more.band).toEqual({ label: '5 to 95 % of 50 samples', spindle_speed_rpm: [4000, 8000], low_mm: [0.45, null], high_mm: [0.55, null] });
  expect(more.map).toMatchObject({ axial_depth_mm: [0, 3], spectral_radius });
});

it('has limits at a speed only where one is recommended', () => {
  const none = { ...plan!, recommended: null, feed_direction_deg: 30, feed_directions: [{ feed_direction_deg: 0, lowest_limit_mm: 1 }] };
  expect(feedOf(none, 3)).toMatchObject({ lowest_limit_mm: [1], limit_at_speed_mm: null, used_direction_deg: 30, searched_depth_mm: 3 });
  const recommended = { ...none, recommended: { ...plan!.recommended!, spindle_speed_rpm: 8000 } };
  expect(feedOf(recommended, 3)).toMatchObject({ limit_at_speed_mm: [null], spindle_speed_rpm: 8000 });
});

describe('FRFs', () => {
  const frf: FrfDocument = {
    document: 'frf/1',
    frequency_hz: [1, 2],
    receptance_m_per_n: { xx: { re: [3e-6, 0], im: [-4e-6, 1e-6] }, 'ry:my': { re: [0, 0], im: [2, 2] }, 'x:my': { re: [1e-6, 1e-6], im: [0, 0] } },
    coherence: { xx: [1, 0.9] },
    grades: { xx: { ...measuredSample!.grades!['xx']!, grade: 'usable', excited_band_hz: [0, 900], lowest_trustworthy_frequency_hz: 8, faults: ['noise'], remedies: ['hit again'] } },
  };
  it('have magnitude and phase in the unit of their name, what is missing left out', () => {
    const [xx, rotation, mixed] = frfsOf({ frf, fitted: null, measured: null, modes, assembly: null });
    expect(xx).toMatchObject({ unit: 'µm/N', predicted: null, fitted: null, grade: 'usable', findings: ['noise'], trusted_from_hz: 8, trusted_to_hz: 900, relative_error: 0.03 });
    expect(xx!.measured!.magnitude[0]).toBeCloseTo(5, 12);
    expect(xx!.measured!.phase_deg[0]).toBeCloseTo(-53.13, 2);
    expect([rotation!.unit, rotation!.measured!.magnitude[0], rotation!.coherence]).toEqual(['rad/(N m)', 2, null]);
    expect([mixed!.unit, mixed!.measured!.magnitude[0]]).toEqual(['µm/(N m)', 1]);
  });
  it('are predictions where there is an assembly, a measurement beside them with its own axis', () => {
    const predicted = { ...assembly!, suspect_hz: [2], unreliable_hz: [], relative_error: { xx: 0.1 } };
    const measured: FrfDocument = { document: 'frf/1', frequency_hz: [5], receptance_m_per_n: { xx: { re: [1e-6], im: [0] } }, coherence: {} };
    const [xx] = frfsOf({ frf, fitted: frf, measured, modes: null, assembly: predicted });
    expect(xx).toMatchObject({ prediction_error: 0.1, relative_error: null, suspect_bands_hz: [[1.5, 2]] });
    expect([xx!.predicted!.frequency_hz, xx!.fitted!.frequency_hz, xx!.measured!.frequency_hz]).toEqual([[1, 2], [1, 2], [5]]);
  });
});

it('says what holds the tool', () => {
  const [segment] = assembly!.tool;
  const base = { ...assembly!, joint: null, suspect_hz: [1] };
  expect(assemblyOf({ ...base, holder: { segments: [] } }).holder.kind).toBe('wall');
  expect(assemblyOf({ ...base, holder: { free: true, segments: [] } }).holder.kind).toBe('free');
  expect(assemblyOf({ ...base, holder: { segments: [segment!, segment!] } }).holder).toMatchObject({ kind: 'segments', segments: [{ part: 'holder', count: 1 }, { count: 2 }] });
  expect(assemblyOf({ ...base, holder: { receptances: 'holder.uff' } })).toMatchObject({ holder: { kind: 'measured', file: 'holder.uff' }, suspect_lines: 1, joint: null });
});

it('reads a curve between its points', () => {
  const at = (x: number) => valueAt([-1, 0, 1], [4, 2, null], x);
  expect([-1, -0.5, 0].map(at)).toEqual([4, 3, 2]);
  expect([-1.5, 0.5, 1, 1.5, NaN].map(at)).toEqual([null, null, null, null, null]);
});
