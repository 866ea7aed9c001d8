import { expect, it } from 'vitest';
import type { BlockColumns, LimitOver } from '../documents';
import { deepest, limitFigure, overFigure, stretches } from './program_limit';
import { light } from './theme';

const columns: BlockColumns = {
  block: [1, 2, 3, 4, 5],
  line: [1, 2, 3, 4, 5],
  x_mm: [0, 1, 2, 3, 4],
  y_mm: [0, 0, 0, 0, 0],
  z_mm: [0, 0, 0, 0, 0],
  axial_depth_mm: [1, 1, null, 1, 1],
  spectral_radius: [0.9, 1.2, null, 0.5, 0.4],
  limit_depth_mm: [1.2, 0.8, null, 1.9, null],
  limit_5_percent_mm: [1, 0.7, null, 1.7, 1.9],
  limit_95_percent_mm: [1.4, 0.9, null, 2, null],
};

it('limits have a band a stretch, marks where the cut is unstable, and a line where it is selected', () => {
  const { data, layout } = limitFigure(columns, 3, light);
  expect(data.map((trace) => trace['name'])).toEqual(['5 – 95 %', '5 – 95 %', 'limit depth', 'programmed depth', 'unstable']);
  expect(data[0]).toMatchObject({ x: [1, 2, 2, 1], y: [1, 0.7, 0.9, 1.4] });
  expect(data[2]).toMatchObject({ y: [1.2, 0.8, null, 1.9, null] });
  expect(data[4]).toMatchObject({ x: [2], y: [1] });
  expect(layout['shapes']).toMatchObject([{ x0: 4, x1: 4 }]);
  expect(limitFigure(columns, null, light).layout['shapes']).toEqual([]);
  const uncertain = { ...columns, limit_95_percent_mm: [1.4, 900, null, 2, null] };
  expect((limitFigure(uncertain, null, light).layout['yaxis'] as { range: number[] }).range[1]).toBeCloseTo(1.15 * 1.9);
});

it('where there is nothing but depths, they are drawn', () => {
  const { block, line, x_mm, y_mm, z_mm, axial_depth_mm } = columns;
  const { data } = limitFigure({ block, line, x_mm, y_mm, z_mm, axial_depth_mm: axial_depth_mm! }, null, light);
  expect(data.map((trace) => trace['name'])).toEqual(['limit depth', 'programmed depth']);
});

it('a band ends where one of its edges does', () => {
  expect(stretches([0, 1, 2, 3], [1, null, 1, 1], [2, 2, 2, null])).toEqual([[0], [2]]);
});

it('limits over a pose share one scale that reaches above all of them', () => {
  const scan = (values: (number | null)[]): LimitOver => ({ parameter: 'gamma_deg', value: [0, 1], limit_depth_mm: values, at_block: 2, at_line: 12 });
  const scans = [scan([1, null]), scan([0.5, 2])];
  expect(deepest(scans, 0.4)).toBe(2);
  expect(deepest([scan([null, null])], null)).toBe(0);
  const { layout } = overFigure(scans[0]!, 2, 0.4, light);
  expect((layout['yaxis'] as { range: [number, number] }).range[1]).toBeGreaterThan(2);
  expect(layout['shapes']).toMatchObject([{ y0: 0.4 }]);
  expect(overFigure(scans[0]!, 0, null, light).layout).toMatchObject({ yaxis: { range: [0, 1] }, shapes: [], xaxis: { title: { text: 'γ (°)' } } });
});
