import { describe, expect, it } from 'vitest';
import { columnsFigure, probabilityFigure, sensitivityFigure } from './figures/study';
import { light } from './figures/theme';
import { sampleReport } from './report_sample';
import { chosenAxes, columnTitle, conditionText, estimateText, leftOutTexts, notShownTexts, optimumText, probabilityMap, rowName, shortNames, shownText, statusText, valueText } from './study_views';

const report = sampleReport();
const { probability, sensitivity = [] } = report.statistics!;
const points = report.study_points!;
const result = probability!;

describe('names', () => {
  it('have their unit once', () => {
    expect(columnTitle({ name: 'cut.radial_depth_mm', unit: 'mm' })).toBe('cut.radial_depth_mm');
    expect(columnTitle({ name: 'coefficients.tangential_n_per_mm2', unit: 'N/mm^2' })).toBe('coefficients.tangential_n_per_mm2');
    expect(columnTitle({ name: 'limit@8000', unit: 'mm' })).toBe('limit@8000 (mm)');
    expect(columnTitle({ name: 'abs_mu@8000,1', unit: '1' })).toBe('abs_mu@8000,1');
    expect(columnTitle({ name: 'tool.teeth', unit: '' })).toBe('tool.teeth');
  });
  it('are as short as they can be told apart', () => {
    expect(shortNames(['cut.radial_depth_mm', 'dynamics.x[0].damping_ratio'])).toEqual(['radial_depth_mm', 'damping_ratio']);
    expect(shortNames(['x[0].damping_ratio', 'x[1].damping_ratio', 'ratio'])).toEqual(['x[0].damping_ratio', 'x[1].damping_ratio', 'ratio']);
  });
  it('of rows say where they are', () => {
    expect(rowName({ value: 'limit@8000', at: { 'cut.direction': '"up"', 'tool.teeth': '2' } })).toBe('limit@8000 at cut.direction = up, tool.teeth = 2');
    expect(rowName({ value: 'limit@8000', at: {} })).toBe('limit@8000');
    expect(rowName({ value: 'a', at: { 'tool.pitch_deg': '[100, 120, 140]', b: '["x", "y"]', c: '"[1]"' } })).toBe('a at tool.pitch_deg = [100, 120, 140], b = ["x", "y"], c = "[1]"');
  });
});

describe('probabilities', () => {
  const map = probabilityMap(result);
  it('have values across and what differs between combinations down', () => {
    expect(map).toMatchObject({ values: ['limit@8000', 'limit@10000', 'limit@12000'], keys: ['tool.teeth'], fixed: 'cut.radial_depth_mm = 6', combinations: ['2', '3', '4'], optimum: [1, 0] });
    expect(map.rows.map((row) => row.map((cell) => cell!.holding))).toEqual([[64, 64, 64], [48, 48, 48], [64, 64, 24]]);
  });
  it('name the robust optimum', () => {
    expect(optimumText(result, points)).toMatch(/^Robust optimum: limit@10000 at tool.teeth = 2, .* 5.% of its samples are below 4\. 4 others are equal in that\.$/);
    expect(optimumText({ ...result, optimum: { ...result.optimum!, worst: null }, equal: 1 }, points)).toMatch(/below infinity: no limit in the range searched\. 1 other is equal/);
    expect(optimumText({ ...result, optimum: null }, null)).toBe('');
    expect(optimumText({ ...result, rows: result.rows.slice(0, 1) }, null)).toBe('');
  });
  it('say their unit where it is known', () => {
    expect(conditionText({ ...result, rows: [{ ...result.rows[0]!, value: 'limit@8000' }] }, points)).toBe('at least 3 mm');
    expect(conditionText({ ...result, at_least: null, at_most: 2 }, null)).toBe('at most 2');
    expect(valueText(1, 'abs_mu@8000,1', { ...points, values: [{ ...points.values[0]!, name: 'abs_mu@8000,1', unit: '1' }] })).toBe('1');
  });
  it('tell values apart that are shown alike', () => {
    const [row] = result.rows;
    const settings = ['[1, 2]', '"[1, 2]"', '2', '"2"', '[2, 1]'];
    const rows = settings.map((value) => ({ ...row!, at: { key: value } }));
    const lists = probabilityMap({ ...result, rows, optimum: rows[3]! });
    expect(lists.combinations).toEqual(['[1, 2]', '"[1, 2]"', '2', '2', '[2, 1]']);
    expect(lists.rows).toEqual(rows.map((one) => [one]));
    expect(lists.optimum).toEqual([0, 3]);
  });
  it('are a map with the optimum outlined', () => {
    const { data, layout } = probabilityFigure(map, light, false);
    expect(data[0]).toMatchObject({ type: 'heatmap', z: [[1, 1, 1], [0.75, 0.75, 0.75], [1, 1, 0.375]], zmin: 0, zmax: 1, texttemplate: '%{text}' });
    expect((data[0]!['customdata'] as string[][])[2]![2]).toContain('24 of 64 samples<br>2 left out');
    expect(layout['shapes']).toMatchObject([{ x0: 0.5, x1: 1.5, y0: -0.5, y1: 0.5 }]);
    expect(layout['yaxis']).toMatchObject({ ticktext: ['2', '3', '4'], title: { text: 'teeth' } });
  });
  it('of one combination and with cells that are missing', () => {
    const one = probabilityMap({ ...result, rows: result.rows.slice(0, 2) });
    expect(one).toMatchObject({ keys: [], combinations: [''] });
    const gap = probabilityMap({ ...result, rows: result.rows.slice(0, 4) });
    expect(gap.rows[1]).toEqual([result.rows[3], null, null]);
    expect(probabilityFigure(gap, light, true).data[0]).toMatchObject({ z: [[1, 1, 1], [0.75, null, null]] });
  });
});

describe('sensitivity', () => {
  it('has bars of first and total with their intervals', () => {
    const { data, layout } = sensitivityFigure(sensitivity[0]!, light);
    expect(data.map((trace) => trace['name'])).toEqual(['first', 'total']);
    expect(data[0]).toMatchObject({ orientation: 'h', x: [0.25, 0.2, 0.6] });
    const { array, arrayminus } = data[0]!['error_x'] as { array: number[]; arrayminus: number[] };
    for (const reach of [...array, ...arrayminus]) expect(reach).toBeCloseTo(0.1);
    expect(layout['yaxis']).toMatchObject({ ticktext: ['radial_depth_mm', 'tangential_n_per_mm2', 'damping_ratio'] });
  });
  it('says why there are no indices, and what was left out', () => {
    expect(sensitivity.map(statusText)).toEqual(['', '', 'does not vary: no key matters']);
    expect(statusText({ ...sensitivity[0]!, status: 'too_few' })).toContain('too few');
    expect(leftOutTexts(sensitivity.map((row) => ({ ...row, of: row.samples + row.left_out })))).toEqual(['limit@8000: 2 of 128 samples', 'limit@10000: 2 of 128 samples']);
    expect(estimateText({ value: 0.5, low: 0.4, high: 0.6 })).toBe('0.500 (0.400 to 0.600)');
    expect(estimateText({ value: null, low: null, high: null })).toBe('–');
  });
});

describe('points', () => {
  it('say what is not shown', () => {
    expect(shownText(60, 20000, 'points')).toBe('60 of 20000 points, evenly chosen.');
    expect(shownText(60, 60, 'points')).toBe('60 points.');
    expect(notShownTexts(points, points.values[0]!)).toEqual(['3 of all 20000 points were rejected: their document is not valid.', '5 are infinite and not drawn, as a limit beyond the depths searched.']);
    expect(notShownTexts({ ...points, rejected: 0 }, points.values[1]!)).toEqual(['5 without a value are not drawn.']);
  });
  it('stand over a key, which may be text', () => {
    const over = columnsFigure(points.keys[1]!, points.values[0]!, null, light);
    expect((over.data[0]!['x'] as string[]).slice(0, 2)).toEqual(['down', 'up']);
    expect(over.layout['xaxis']).toMatchObject({ type: 'category' });
    expect(over.layout['yaxis']).toMatchObject({ title: { text: 'limit@8000 (mm)' } });
  });
  it('stand over lists in full, which the axis shortens', () => {
    const long = `[${Array.from({ length: 40 }, (_, i) => i).join(', ')}]`;
    const key = { ...points.keys[1]!, texts: [long, '[6000, 12000]', '["<b>"]', long] };
    const { data, layout } = columnsFigure(key, points.values[0]!, null, light);
    expect(data[0]!['x']).toEqual([long, '[6000, 12000]', '["&lt;b&gt;"]', long]);
    expect(data[0]!['customdata']).toEqual([long, '[6000, 12000]', '["&lt;b&gt;"]', long]);
    expect(data[0]!['hovertemplate']).toContain('cut.direction: %{customdata}<br>');
    expect(columnsFigure(points.keys[0]!, points.values[0]!, null, light).data[0]!['hovertemplate']).toContain(': %{x}<br>');
    expect(layout['xaxis']).toMatchObject({ type: 'category', tickvals: [long, '[6000, 12000]', '["&lt;b&gt;"]'], ticktext: [`${long.slice(0, 23)}…`, '[6000, 12000]', '["&lt;b&gt;"]'] });
  });
  it('of a boundary have the third key as colour', () => {
    const [a, b, c] = points.boundary_keys;
    const { data } = columnsFigure(a!, b!, c!, light);
    expect(data[0]).toMatchObject({ x: a!.numbers, y: b!.numbers, marker: { color: c!.numbers } });
  });
  it('take two different keys', () => {
    expect(chosenAxes([0, 1], 0, 2)).toEqual([2, 1]);
    expect(chosenAxes([0, 1], 0, 1)).toEqual([1, 0]);
    expect(chosenAxes([0, 1], 1, 0)).toEqual([1, 0]);
  });
});
