import { describe, expect, it } from 'vitest';
import type { ExplanationDocument, Slot, StiffnessDocument, ToolRow, VibrationDocument } from '../documents';
import { comparisonSample, lobesSample, pointSample, posturesSample, sweepSample } from '../lobes_sample';
import { sampleReport } from '../report_sample';
import { displacementFigure, jointsFigure, slotResidualFigure, slotsFigure } from './identified';
import { pointTraces, surfaceFigure } from './lobes';
import { peaksFigure } from './peaks';
import { timeFigure, vibrationSpectrumFigure } from './simulation';
import { posturesFigure } from './postures';
import { comparisonFigure, sweepFigure } from './sweep';
import { dark, light } from './theme';
import { toolsFigure } from './tools';

const report = sampleReport();

const point = (stable: boolean, depth: number) => ({ ...pointSample, spindle_speed_rpm: 5000, axial_depth_mm: depth, stable });

describe('points that were asked for', () => {
  it('differ by symbol where they are stable', () => {
    const traces = pointTraces([point(true, 1), point(false, 2)], ({ axial_depth_mm: depth = null }) => depth, light);
    expect(traces.map((trace) => trace['name'])).toEqual(['asked for, stable', 'asked for, chatter']);
    expect(traces.map((trace) => trace['y'])).toEqual([[1], [2]]);
    expect(pointTraces([], () => null, light)).toEqual([]);
  });
});

describe('surface', () => {
  it('has zero in the middle of its scale', () => {
    const figure = surfaceFigure(lobesSample.surface!, light);
    expect(figure.data[0]).toMatchObject({ zmin: -3, zmax: 3 });
  });
});

describe('sweep', () => {
  it('is a map over its own parameter, with its points', () => {
    const { data, layout } = sweepFigure(sweepSample, dark);
    expect(data.map((trace) => trace['type'])).toEqual(['heatmap', 'contour', 'scatter']);
    expect(data[2]).toMatchObject({ x: [5900], y: [1] });
    expect(layout['yaxis']).toMatchObject({ title: { text: 'Lead (°)' } });
  });
});

describe('methods', () => {
  it('are a line each, without those that reject the cut', () => {
    const { data } = comparisonFigure(comparisonSample, light);
    expect(data.map((trace) => trace['name'])).toEqual(['collocation', 'multi-frequency']);
    expect(new Set(data.map((trace) => (trace['line'] as { dash: string }).dash)).size).toBe(2);
  });
});

describe('postures', () => {
  it('are a line each, with gaps where there is no limit', () => {
    const { data } = posturesFigure(posturesSample, light);
    expect(data.map((trace) => trace['name'])).toEqual(['posture 1', 'posture 2', 'posture 3']);
    expect(data[0]).toMatchObject({ y: [0.5, null], connectgaps: false });
  });
});

describe('peaks', () => {
  const reading = { kind: 'rotation' as const, rotations: 4, mirrored: false, of_tooth_passing: false, mode: null, mode_of: null, expected_hz: 400, difference_hz: 0, tolerance_hz: 1, likelihood_per_hz: 1 };
  const document: ExplanationDocument = {
    document: 'explain/1',
    spindle_speed_rpm: 6000,
    speed_from_peaks: true,
    peaks: [
      { frequency_hz: 300, state: 'named', chatter_frequency_hz: null, others: [], ...reading, rotations: 3 },
      { frequency_hz: 400.2, state: 'ambiguous', kind: 'cut or chatter', mode: null, mode_of: null, chatter_frequency_hz: null, others: [reading] },
    ],
    state: 'ambiguous',
    mode: null,
    mode_of: null,
    chatter_frequency_hz: null,
    chatter: null,
  };
  it('stand in the row of their kind, other readings open', () => {
    const { data, layout } = peaksFigure(document, light);
    expect(data.map((trace) => trace['name'])).toEqual(['rotation', 'rotation', 'rotation, another reading', 'cut or chatter']);
    expect(data[1]).toMatchObject({ x: [300], y: [1], marker: { symbol: 'circle' } });
    expect(data[2]).toMatchObject({ x: [400.2], y: [1], text: ['or 4 × rotation'], marker: { symbol: 'circle-open' } });
    expect(data[3]).toMatchObject({ x: [400.2], y: [0] });
    expect(layout['yaxis']).toMatchObject({ ticktext: ['rotation', 'cut or chatter'], tickvals: [1, 0] });
    expect(data[0]!['x']).toContain(400); // a multiple of the rotation
  });
});

describe('simulation', () => {
  const band = (size: number) => ({ low: [-size, -size], high: [size, size] });
  const vibration: VibrationDocument = {
    document: 'vibration/1',
    run_s: 0.5,
    displacement_um: { x: band(2) },
    force_n: { x: band(20), z: band(3) },
    spectrum: { from_s: 0.5, frequency_hz: [0, 100, 200, 300, 4000], x_um: [0, 1, 5, 0.1, 1e-9] },
  };
  const simulation = { ...report.simulation!, spindle_speed_rpm: 6000, chatter_frequency_hz: 210 };
  it('shows displacement over force, each direction named once', () => {
    const { data, layout } = timeFigure(vibration, light);
    expect(data.map((trace) => [trace['name'], trace['yaxis'], trace['showlegend']])).toEqual([['x', 'y', true], ['x', 'y2', false], ['z', 'y2', true]]);
    expect(layout['xaxis']).toMatchObject({ range: [0, 1] });
  });
  it('ends its spectrum where nothing is to be seen, and marks the chatter', () => {
    const { data, layout } = vibrationSpectrumFigure(simulation, vibration.spectrum!, false, light);
    expect(data.map((trace) => trace['name'])).toEqual(['rotation', 'x', 'chatter, 210.0 Hz']);
    const { range } = layout['xaxis'] as { range: number[] };
    expect(range[1]).toBeCloseTo(330);
    const log = vibrationSpectrumFigure({ ...simulation, chatter_frequency_hz: null }, vibration.spectrum!, true, light);
    expect(log.data).toHaveLength(2);
    expect((log.layout['yaxis'] as { range: number[] }).range.every(Number.isFinite)).toBe(true);
  });
});

describe('slots', () => {
  const slot = (feed: number, force: number, speed: number): Slot => ({ line: 2, feed_per_tooth_mm: feed, axial_depth_mm: 1, spindle_speed_rpm: speed, force_n: [force, force, force], residual_n: [1, 1, 1] });
  const slots = [slot(0.1, 10, 3000), slot(0.2, 20, 3000), slot(0.1, 12, 6000)];
  it('are measured points and a fitted line of each group', () => {
    const { data } = slotsFigure(slots, light);
    expect(data).toHaveLength(9);
    expect(data[0]).toMatchObject({ name: 'x, measured', y: [10, 20, 12] });
    expect(data[1]).toMatchObject({ name: 'x, fitted', y: [9, 19], showlegend: true });
    expect(data[2]).toMatchObject({ y: [11], showlegend: false });
  });
  it('leave residuals', () => expect(slotResidualFigure(slots, light).data.map((trace) => trace['y'])).toEqual([[1, 1, 1], [1, 1, 1], [1, 1, 1]]));
});

describe('stiffness', () => {
  const stiffness: StiffnessDocument = { ...report.stiffness!, joint_stiffness_n_m_per_rad: [1e6, null, 3e6], std: [1e5, null, 2e6], displacement_mm: [[1, 2, 3]], residual_mm: [[0.1, 0, 0]], line: [2] };
  it('has a point for each joint that is known', () => {
    const { data, layout } = jointsFigure(stiffness, light);
    expect(data[0]).toMatchObject({ x: [1, 3], y: [1e6, 3e6], error_y: { array: [2e5, 4e6] } });
    expect(layout['yaxis']).toMatchObject({ title: { text: 'Stiffness (N m/rad)' } });
    expect((layout['yaxis'] as { range: number[] }).range.every(Number.isFinite)).toBe(true);
    const none = { ...stiffness, joint_stiffness_n_m_per_rad: [null] };
    expect((jointsFigure(none, light).layout['yaxis'] as { range: number[] }).range.every(Number.isFinite)).toBe(true);
  });
  it('predicts what was measured less the residual', () => {
    const { data } = displacementFigure(stiffness, light);
    expect(data.slice(1).map((trace) => trace['x'])).toEqual([[1], [2], [3]]);
    expect(data[1]!['y']).toEqual([0.9]);
  });
});

describe('tools', () => {
  const tool = (name: string, peak: number | null): ToolRow => ({ tool: name, teeth: 2, diameter_mm: 10, overhang_mm: 40, failure: null, peak_hz: 900, peak_um_per_n: peak, modes: [], fit_relative_error: null, suspect_lines: 0, lowest_limit_mm: null, recommended: null, reason: null, notes: [] });
  it('have the rows that say something, tools of one name apart', () => {
    const { data, layout } = toolsFigure([tool('a', 1), tool('a', null)], light);
    expect(data).toHaveLength(1);
    expect(data[0]).toMatchObject({ type: 'bar', x: [1, 2], y: [1, null], customdata: ['a', 'a'] });
    expect(layout['xaxis']).toMatchObject({ anchor: 'y', ticktext: ['a', 'a'] });
    const long = toolsFigure([tool(`<b>${'x'.repeat(40)}`, 1)], light);
    expect((long.layout['xaxis'] as { ticktext: string[] }).ticktext).toEqual([`&lt;b&gt;${'x'.repeat(14)}…`]);
    const cut = { ...tool('b', 1), lowest_limit_mm: 0.5 };
    expect(toolsFigure([cut], light).layout).toHaveProperty('yaxis2');
  });
});
