import { describe, expect, it } from 'vitest';
import type { Cut } from '../documents';
import type { Lobes } from '../views';
import { bandTraces, cutTraces, depthTop, frequencyTraces, limitTraces, lobesFigure, mapFigure, pairFigure, searchedDepth, stableDepth, visibleLimits } from './lobes';
import { dark, light } from './theme';
import { sampleReport } from '../report_sample';

const lobes: Lobes = {
  label: 'all modes',
  spindle_speed_rpm: [4000, 5000, 6000, 7000],
  limit_mm: [0.5, null, 1.25, 0.75],
  searched_depth_mm: 3,
  band: null,
  boundary: [
    { spindle_speed_rpm: 4000, axial_depth_mm: 0.5, chatter_frequency_hz: 545, kind: 'hopf', mode: 8, mode_of: 'tool' },
    { spindle_speed_rpm: 4100, axial_depth_mm: 0.6, chatter_frequency_hz: 546, kind: 'flip', mode: 8, mode_of: 'tool' },
    { spindle_speed_rpm: 6000, axial_depth_mm: 1.25, chatter_frequency_hz: null, kind: 'hopf', mode: 7, mode_of: 'tool' },
    { spindle_speed_rpm: 7000, axial_depth_mm: 0.75, chatter_frequency_hz: 18.5, kind: 'fold', mode: null, mode_of: null },
  ],
  map: null,
};

function cut(result: Cut['result'], agrees: boolean | null, note = ''): Cut {
  return { spindle_speed_rpm: 6500, axial_depth_mm: 0.8, result, predicted: 'stable', limit_depth_mm: 1, agrees, note };
}

const input = { lobes, otherLimits: [], cuts: [], recommendation: null, alternatives: [] };

describe('limit', () => {
  it('is stable up to the searched depth where there is no limit', () => {
    expect(stableDepth(lobes)).toEqual([0.5, 3, 1.25, 0.75]);
    expect(searchedDepth({ ...lobes, searched_depth_mm: null })).toBe(1.25);
  });
  it('has a gap where there is none', () => {
    const line = limitTraces(lobes, light)[1]!;
    expect(line['y']).toEqual([0.5, null, 1.25, 0.75]);
    expect(line['connectgaps']).toBe(false);
  });
});

describe('test cuts', () => {
  const cuts = [cut('stable', true), cut('stable', false), cut('chatter', false), cut('borderline', null), cut(null, null, '<b>x</b>')];
  const traces = cutTraces(cuts, light);
  it('show each cut once, by result, each with its own symbol', () => {
    const named = traces.filter((trace) => String(trace['name']).startsWith('cut'));
    expect(named.map((trace) => trace['name'])).toEqual(['cut, stable (2)', 'cut, borderline (1)', 'cut, chatter (1)', 'cut, no result (1)']);
    expect(named.map((trace) => (trace['x'] as number[]).length).reduce((a, b) => a + b)).toBe(cuts.length);
    const symbols = named.map((trace) => (trace['marker'] as { symbol: string }).symbol);
    expect(new Set(symbols).size).toBe(symbols.length);
  });
  it('ring those that came out otherwise', () => {
    expect(traces[traces.length - 1]!['name']).toBe('not as predicted (2)');
    expect(cutTraces([cut('stable', true)], light)).toHaveLength(1);
    expect(cutTraces([], light)).toEqual([]);
  });
  it('keep notes as text', () => {
    expect(JSON.stringify(traces)).toContain('&lt;b&gt;x&lt;/b&gt;');
  });
});

describe('chatter frequency', () => {
  it('groups points by mode and leaves out those without a frequency', () => {
    const traces = frequencyTraces(lobes, light);
    expect(traces.map((trace) => trace['name'])).toEqual(['mode unknown', 'mode 8']);
    expect(traces[1]!['x']).toEqual([4000, 4100]);
    expect((traces[1]!['marker'] as { symbol: string[] }).symbol).toEqual(['circle', 'diamond']);
    expect(traces.every((trace) => trace['xaxis'] === 'x2' && trace['yaxis'] === 'y2')).toBe(true);
  });
  it('keeps a mode of the workpiece apart from the mode of the tool with its number', () => {
    const [first, ...others] = lobes.boundary;
    const both: Lobes = { ...lobes, boundary: [{ ...first!, mode_of: 'workpiece' }, ...others] };
    expect(frequencyTraces(both, light).map((trace) => trace['name'])).toEqual(['mode unknown', 'mode 8', 'mode 8 of the workpiece']);
  });
  it('has a second plot only where there is something to show', () => {
    expect(lobesFigure(input, light, false).layout).toHaveProperty('yaxis2');
    const none = { ...lobes, boundary: [] };
    expect(lobesFigure({ ...input, lobes: none }, light, false).layout).not.toHaveProperty('yaxis2');
  });
});

describe('lobes', () => {
  it('mark the recommended point and lead it to both axes', () => {
    const recommendation = { ...sampleReport().plan!.recommended!, spindle_speed_rpm: 6000, axial_depth_mm: 1, limited_by: 'a < b' };
    const figure = lobesFigure({ ...input, recommendation, alternatives: [recommendation] }, dark, true);
    const star = figure.data.find((trace) => trace['name'] === 'recommended')!;
    expect(star['x']).toEqual([6000]);
    expect(star['hovertext']).toEqual([expect.stringMatching(/^<b>6000\u202frpm, 1.00 mm<\/b><br>.* mm³\/s<br>limited by a &lt; b$/)]);
    expect(figure.data.find((trace) => trace['name'] === 'alternatives')!['text']).toEqual(['1']);
    expect(figure.layout['shapes']).toHaveLength(2);
  });
  it('leave out other limits that never come into view', () => {
    const curve = (label: string, axial_depth_mm: number[]) => ({ label, spindle_speed_rpm: [4000, 7000], axial_depth_mm });
    const otherLimits = [curve('torque', [2, 9]), curve('power', [9, 12])];
    expect(visibleLimits({ ...input, otherLimits }).map((limit) => limit.label)).toEqual(['torque']);
  });
  it('reach to the deepest cut', () => {
    expect(depthTop({ ...input, cuts: [{ ...cut('chatter', true), axial_depth_mm: 5 }] })).toBeCloseTo(5.2);
    expect(depthTop(input)).toBeCloseTo(3.12);
  });
  it('stand beside those of all modes', () => {
    const figure = pairFigure({ ...lobes, label: 'modes 1–2' }, lobes, [], light);
    expect(figure.data[0]!['name']).toBe('all modes');
    expect((figure.layout['title'] as { text: string }).text).toBe('modes 1–2');
  });
  it('show what is uncertain behind the limit, up to the top where there is none', () => {
    const band = { label: '5 to 95 %', spindle_speed_rpm: [4000, 7000], low_mm: [1, 2], high_mm: [2, null] };
    const [low, high] = bandTraces({ ...lobes, band }, light);
    expect(low!['y']).toEqual([1, 2]);
    expect(high!['y']).toEqual([2, 3]);
    expect(high!['fill']).toBe('tonexty');
    expect(bandTraces(lobes, light)).toEqual([]);
  });
  it('draw the line of spectral radius one over the map', () => {
    const map = { spindle_speed_rpm: [1, 2], axial_depth_mm: [0, 1], spectral_radius: [[0.5, 0.6], [1.5, null]] };
    const figure = mapFigure({ ...lobes, map }, light);
    expect(figure.data.map((trace) => trace['type'])).toEqual(['heatmap', 'contour']);
    expect(figure.data[1]!['contours']).toMatchObject({ start: 1, end: 1 });
    expect(mapFigure(lobes, light).data).toEqual([]);
  });
});
