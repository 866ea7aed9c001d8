import { describe, expect, it } from 'vitest';
import type { MeasuredForces, Revolution } from '../documents';
import { sampleReport } from '../report_sample';
import { isRevolution } from '../views';
import { measuredFigure } from './measured';
import { light } from './theme';

const forces = sampleReport().forces!;
if (!isRevolution(forces)) throw new Error('The sample has no revolution.');
const { vibrating_fx_n: _x, vibrating_fy_n: _y, vibrating_fz_n: _z, ...steady } = forces;
const turn: Revolution = { ...steady, rotation_deg: [0, 180, 360], fx_n: [1, 2, 1], fy_n: [3, 4, 3], fz_n: [5, 6, 5] };

const measured = {
  fx_n: [1.5, 2.5, 1.5], fy_n: [2, 4, 2], fz_n: [null, null, null],
  fx_std_n: [0.5, 0.25, 0.5], fy_std_n: [1, 1, 1], fz_std_n: [null, null, null],
} as unknown as MeasuredForces;

describe('measured beside predicted', () => {
  it('has a row a component that was measured, with its band', () => {
    const { data, layout } = measuredFigure(turn, measured, light);
    expect(data).toHaveLength(8);
    expect(data.slice(0, 4).map((trace) => trace['y'])).toEqual([[1, 2.25, 1], [2, 2.75, 2], [1.5, 2.5, 1.5], [1, 2, 1]]);
    expect(data[1]).toMatchObject({ fill: 'tonexty', showlegend: true });
    expect(data[5]).toMatchObject({ yaxis: 'y2', showlegend: false });
    expect(layout['yaxis2']).toMatchObject({ title: { text: 'Fy (N)' } });
    expect(layout).not.toHaveProperty('yaxis3');
    expect(layout['xaxis']).toMatchObject({ anchor: 'y2', range: [0, 360] });
  });
});
