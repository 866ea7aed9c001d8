import { describe, expect, it } from 'vitest';
import { light } from '../../figures/theme';
import type { Lobes } from '../../views';
import { tapFigure } from '../tap/figure';
import { fromPixels, toPixels, type Frame } from '../frame';
import { chartHeight, liveFigure } from './figure';

const lobes: Lobes = {
  label: '',
  spindle_speed_rpm: [4000, 6000],
  limit_mm: [0.5, 1.5],
  searched_depth_mm: 3,
  band: null,
  boundary: [{ spindle_speed_rpm: 4000, axial_depth_mm: 0.5, chatter_frequency_hz: 540, kind: 'hopf', mode: 1 }],
  map: null,
};
const names = (figure: { data: Record<string, unknown>[] }) => figure.data.map((trace) => trace['name']).filter(Boolean);

describe('live figure', () => {
  it('overlays the kept curve, each named after what differs', () => {
    const figure = liveFigure({ lobes, name: 'teeth 4', kept: { lobes: { ...lobes, limit_mm: [0.6, 1.8] }, name: 'teeth 3' }, moving: false }, light, 600);
    expect(names(figure)).toEqual(['teeth 4', 'mode 1', 'kept: teeth 3']);
    expect(figure.data[figure.data.length - 1]!['y']).toEqual([0.6, 1.8]);
  });
  it('leaves the frequencies out where there is no room', () => {
    expect(names(liveFigure({ lobes, name: 'limit', kept: null, moving: false }, light, 300))).toEqual(['limit']);
    expect(liveFigure({ lobes, name: 'limit', kept: null, moving: false }, light, 300).layout['height']).toBe(300);
    expect(lobes.boundary).toHaveLength(1);
  });
  it('keeps a zoom while it moves', () => {
    expect(liveFigure({ lobes, name: 'limit', kept: null, moving: false }, light, 300).layout['uirevision']).toBe('lobes');
  });
  it('is as high as the window permits', () => {
    expect([360, 800, 2000].map(chartHeight)).toEqual([200, 555, 640]);
  });
});

describe('pixels', () => {
  const frame: Frame = { left: 50, top: 10, width: 400, height: 200, x: [4000, 8000], y: [0, 2] };
  it('are where the axes say', () => {
    expect(toPixels(frame, [5000, 0.5])).toEqual([150, 160]);
    expect(fromPixels(frame, [150, 160])).toEqual([5000, 0.5]);
  });
  it('stay inside when a zoom leaves the point outside', () => {
    expect(toPixels(frame, [9000, 3])).toEqual([450, 10]);
  });
});

it('draws the FRF over those of fewer hits', () => {
  const curve = { frequency_hz: [1, 2], magnitude: [1, 2], phase_deg: [0, 0] };
  const frf = {
    name: 'xx', unit: 'µm/N', measured: curve, predicted: null, fitted: null, coherence: null, trusted_from_hz: null, trusted_to_hz: null,
    suspect_bands_hz: [], unreliable_bands_hz: [], grade: null, findings: [], remedies: [], relative_error: null, prediction_error: null,
  };
  const figure = tapFigure(frf, [{ hits: 1, frfs: [frf] }, { hits: 2, frfs: [{ ...frf, name: 'yy' }] }], false, light);
  expect(names(figure)).toEqual(['1 hit', 'measured', 'measured']);
});
