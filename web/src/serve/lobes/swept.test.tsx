import { renderToString } from 'preact-render-to-string';
import { describe, expect, it, vi } from 'vitest';
import { light } from '../../figures/theme';
import { sweepSample } from '../../lobes_sample';
import { resetAll, SweptPanel } from './lobes';
import { liveSweepFigure } from './figure';
import { firstSweptPoint, sweptFacts, sweptKey, sweptRanges } from './swept';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

const sweep = sweepSample;

describe('a sweep', () => {
  it('has a slider of its own, over the values of the map', () => {
    expect(sweptKey(sweep)).toBe('operating_point.lead_deg');
    expect(sweptKey({ ...sweep, sweep: 'radial_depth' })).toBe('operating_point.radial_depth_mm');
    expect(sweptRanges(sweep)).toEqual({ speed: [4000, 8000], depth: [-10, 10] });
    expect(firstSweptPoint(sweep)).toEqual([6000, 0]);
    expect(resetAll({ set: {}, modes: null, point: [7000, 5] }, new Set([sweptKey(sweep)]), [6000, 0], sweptKey(sweep)).point).toEqual([6000, 5]);
  });
  it('knows the operating point by the nearest of its map, or as it was evaluated', () => {
    expect(sweptFacts([5900, 1], sweep, [])).toEqual({ stable: false, evaluated: false, spectral_radius: 1.05, intervals: '2 to 10', frequency_hz: null, mode: '' });
    const here = sweep.points[0]!;
    expect(sweptFacts([5900, 1], sweep, [here])).toMatchObject({ stable: false, evaluated: true, spectral_radius: 1.02, frequency_hz: 918, mode: 'mode 3' });
    expect(sweptFacts([5900, 2], sweep, [here])).toMatchObject({ evaluated: false });
  });
  it('says the operating point in words', () => {
    const html = renderToString(<SweptPanel point={[8000, -5]} facts={sweptFacts([8000, -5], sweep, [])} sweep={sweep} />);
    for (const part of ['8000 rpm', 'Lead', '-5 °', 'Spectral radius', '1.300', 'nowhere', 'verdict chatter']) expect(html.replace('−', '-')).toContain(part);
  });
  it('is drawn with axes that stay, and the line of a kept one over it', () => {
    const figure = liveSweepFigure({ sweep, kept: null }, light, 400);
    expect(figure.data.map((trace) => trace['type'])).toEqual(['heatmap', 'contour']);
    expect(figure.layout).toMatchObject({ height: 400, uirevision: 'sweep', showlegend: false, xaxis: { range: [4000, 8000] }, yaxis: { range: [-10, 10] } });
    const both = liveSweepFigure({ sweep, kept: { sweep, name: 'teeth 3' } }, light, 400);
    expect(both.data[2]).toMatchObject({ type: 'contour', name: 'kept: teeth 3', y: [-10, 0, 10], showlegend: true });
    expect(liveSweepFigure({ sweep, kept: { sweep: { ...sweep, sweep: 'tilt' }, name: '' } }, light, 400).data).toHaveLength(2);
  });
});
