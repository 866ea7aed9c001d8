import { expect, it } from 'vitest';
import type { GammaMap } from '../documents';
import { gammaFigure, scaleEnd } from './gamma_map';
import { dark, light } from './theme';

const map: GammaMap = {
  block: [3, 5, 9],
  path_mm: [10, 20, 40],
  gamma_deg: [-10, 0],
  margin: [
    [-0.9, 0.1, null],
    [0.2, 0.3, 0.1],
  ],
  chosen_deg: [0, 0, 0],
  programmed_deg: [-10, -10, -10],
  least_margin: 0.2,
};

function names(of: GammaMap, narrow = false): unknown[] {
  return gammaFigure(of, null, light, narrow).data.filter((trace) => trace['name'] && trace['showlegend'] !== false).map((trace) => trace['name']);
}

it('has zero in the middle of its colours, whatever the margins are', () => {
  for (const theme of [light, dark]) {
    const [heat] = gammaFigure(map, null, theme, false).data;
    expect(heat).toMatchObject({ type: 'heatmap', z: map.margin, zmin: -0.5, zmax: 0.5 });
    expect((heat!['colorscale'] as [number, string][])[1]).toEqual([0.5, theme.panel]);
    expect((heat!['colorbar'] as { ticktext: string[] }).ticktext).toEqual(['≤\u202f−0.5', '−0.25', '0', '0.25', '0.5']);
  }
  expect(scaleEnd([[0.2, null, 0.7]])).toBe(0.7);
  expect(scaleEnd([[-0.2, -0.1]])).toBe(0.2);
  expect(scaleEnd([[-7, 3]])).toBe(1);
  expect(scaleEnd([[null], [0]])).toBe(1);
});

it('names lines and the places where the robot cannot stand', () => {
  expect(names(map)).toEqual(['margin 0', 'margin 0.2', 'as programmed', 'chosen', 'no posture']);
  expect(names(map, true)).toEqual(['as programmed', 'chosen', 'no posture']);
  expect(names({ ...map, least_margin: null, margin: [[0, 0, 0], [0, 0, 0]] })).toEqual(['margin 0', 'as programmed', 'chosen']);
  expect(gammaFigure(map, null, light, false).layout['plot_bgcolor']).toBe(light.unknown);
});

it('names the block under the pointer and marks the one that is selected', () => {
  const { data, layout } = gammaFigure(map, 2, light, false);
  expect(data[0]!['customdata']).toEqual([map.block, map.block]);
  expect(layout['shapes']).toMatchObject([{ x0: 40, x1: 40 }]);
  expect(gammaFigure(map, null, light, false).layout['shapes']).toEqual([]);
});
