import { describe, expect, it } from 'vitest';
import type { Block, Program, Revolution, SpindleRotation } from '../documents';
import { engagementFigure, gammaFigure, programFigure, revolutionFigure, ringEdges, withinTurn } from './forces';
import { sampleReport } from '../report_sample';
import { isProgram, isRevolution } from '../views';
import { highest } from './rows';
import { dark, light } from './theme';
import { frame, marks, moves, placesOf, trackFigure } from './track';

const { vibrating_fx_n: _x, vibrating_fy_n: _y, vibrating_fz_n: _z, ...forces } = sampleReport().forces!;
if (!isRevolution(forces) || !isProgram(forces)) throw new Error('The sample has no forces.');

const revolution: Revolution = {
  ...forces,
  force_on: 'workpiece',
  rotation_deg: [0, 180, 360],
  fx_n: [1, 2, 1],
  fy_n: [3, 4, 3],
  fz_n: [5, 6, 5],
  torque_by_rotation_n_m: [0.1, 0.2, 0.1],
  engagement: [
    { height_mm: 0.1, radius_mm: 1, position_deg: 20, arcs_deg: [[0, 120]] },
    { height_mm: 0.3, radius_mm: 2, position_deg: 30, arcs_deg: [[300, 400]] },
    { height_mm: 0.7, radius_mm: 3, position_deg: 40, arcs_deg: [] },
  ],
};

describe('forces over a revolution', () => {
  it('have the three components above, each with a dash of its own, and the torque below', () => {
    const { data, layout } = revolutionFigure(revolution, light);
    expect(data.map((trace) => [trace['name'], trace['y']])).toEqual([['Fx', [1, 2, 1]], ['Fy', [3, 4, 3]], ['Fz', [5, 6, 5]], ['torque', [0.1, 0.2, 0.1]]]);
    expect(new Set(data.slice(0, 3).map((trace) => (trace['line'] as { dash: string }).dash)).size).toBe(3);
    expect(layout['yaxis']).toMatchObject({ title: { text: 'Force on the workpiece (N)' } });
    expect(layout['xaxis']).toMatchObject({ range: [0, 360], dtick: 45, anchor: 'y2' });
    expect(revolutionFigure({ ...revolution, rotation_deg: [0, 180, 1080] }, light).layout['xaxis']).toMatchObject({ dtick: 135 });
    const vibrating = { ...revolution, vibrating_fx_n: [7, 8, 7], vibrating_fy_n: [0, 1, 0], vibrating_fz_n: [0, 0, 0] };
    expect(revolutionFigure(vibrating, light).data[0]!['y']).toEqual([7, 8, 7]);
    expect(revolutionFigure(revolution, light, true).layout['xaxis']).toMatchObject({ dtick: 90 });
  });
});

describe('engagement map', () => {
  it('splits an arc that runs over +y', () => {
    expect(withinTurn(300, 400)).toEqual([[300, 360], [0, 40]]);
    expect(withinTurn(-30, 60)).toEqual([[330, 360], [0, 60]]);
    expect(withinTurn(10, 370)).toEqual([[0, 360]]);
    expect(withinTurn(0, 180)).toEqual([[0, 180]]);
    expect(withinTurn(270, 360)).toEqual([[270, 360]]);
  });
  it('stands each ring half-way to its neighbours, the lowest not below the tip', () => {
    const edges = ringEdges([0.1, 0.3, 0.7]);
    [0, 0.2, 0.2, 0.5, 0.5, 0.9].forEach((edge, i) => expect(edges.flat()[i]).toBeCloseTo(edge));
    const even = ringEdges([0.5, 1.5, 2.5]);
    expect(even).toEqual([[0, 1], [1, 2], [2, 3]]);
    expect(ringEdges([0.02, 0.3])[0]![0]).toBe(0);
    expect(ringEdges([2])).toEqual([[1, 3]]);
    expect(ringEdges([])).toEqual([]);
  });
  it('draws one bar an arc, and says what it is', () => {
    const [bars, middles] = engagementFigure(revolution.engagement, light).data;
    expect((bars!['x'] as unknown[]).filter((value) => value === null)).toHaveLength(3);
    expect((bars!['x'] as unknown[]).slice(0, 6)).toEqual([0, 120, 120, 0, 0, null]);
    expect(middles!['x']).toEqual([60, 330, 20]);
    expect((middles!['text'] as string[])[0]).toContain('κ 20.0°<br>from 0.0° to 120.0°');
    const axis = engagementFigure(revolution.engagement, light, true).layout['xaxis'] as { tickvals: number[]; ticktext: string[] };
    expect(axis.tickvals).toEqual([0, 90, 180, 270, 360]);
    expect(axis.ticktext[1]).toBe('90<br>feed');
  });
});

const block: Block = { ...forces.blocks[0]!, y_mm: 0 };

/** Blocks from (0, 0, 20), the first and the last in air. */
const track: Block[] = [
  { x_mm: 0, z_mm: 20, peak_f_n: 0, cuts: false },
  { x_mm: 0, z_mm: 0, peak_f_n: 0, cuts: false },
  { x_mm: 10, z_mm: 0, peak_f_n: 100, cuts: true },
  { x_mm: 10.001, z_mm: 0, peak_f_n: 300, cuts: true },
  { x_mm: 50, z_mm: 5, peak_f_n: 0, cuts: false },
].map((one, i) => ({ ...block, ...one, block: i + 1, line: i + 11 }));

const program: Program = {
  ...forces,
  torque_limit_n_m: 0.25,
  power_time_s: 0.1,
  power_limit_w: 4000,
  blocks: [
    { path_mm: 5, peak_f_n: 10, revolution_torque_n_m: 0.1, peak_torque_n_m: 0.2, sustained_power_w: 100, peak_deflection_um: 1 },
    { path_mm: 10, peak_f_n: 0, revolution_torque_n_m: 0.2, peak_torque_n_m: 0.3, sustained_power_w: 200, peak_deflection_um: 2 },
    { path_mm: 30, peak_f_n: 30, revolution_torque_n_m: 0.3, peak_torque_n_m: 0.6, sustained_power_w: 300, peak_deflection_um: 3 },
  ].map((one, i) => ({ ...block, ...one, block: i + 1, line: i + 11 })),
};

/** The program with something else in each of its blocks. */
const withBlocks = (change: Partial<Block>): Program => ({ ...program, blocks: program.blocks.map((block) => ({ ...block, ...change })) });

describe('forces along a program', () => {
  const rows = (figure: { layout: Record<string, unknown> }) => Object.keys(figure.layout).filter((key) => key.startsWith('yaxis'));
  it('stack over one axis, without the deflection where nothing bends', () => {
    const figure = programFigure(program, light);
    expect(rows(figure)).toHaveLength(4);
    expect(figure.layout['xaxis']).toMatchObject({ anchor: 'y4', range: [0, 30] });
    const rigid = programFigure(withBlocks({ peak_deflection_um: null }), light);
    expect(rows(rigid)).toHaveLength(3);
    expect(rigid.layout['xaxis']).toMatchObject({ anchor: 'y3' });
  });
  it('never overlap', () => {
    const figure = programFigure(program, light);
    const domains = rows(figure).map((key) => (figure.layout[key] as { domain: [number, number] }).domain);
    domains.forEach(([low, high], i) => {
      expect(low).toBeLessThan(high);
      if (i > 0) expect(high).toBeLessThanOrEqual(domains[i - 1]![0]);
    });
  });
  it('hold a block’s value over its length, from the start of the path', () => {
    const [force] = programFigure(program, light).data;
    expect(force).toMatchObject({ x: [0, 5, 10, 30], y: [10, 10, 0, 30], line: { shape: 'vh' } });
    expect(force!['customdata']).toEqual([[1, 11], [1, 11], [2, 12], [3, 13]]);
  });
  it('show a limit as a line, or in words where the line would flatten the curve', () => {
    const { layout } = programFigure(program, light);
    expect(layout['shapes']).toMatchObject([{ yref: 'y2', y0: 0.25, line: { dash: '6px,4px' } }]);
    expect((layout['annotations'] as { text: string }[]).map((a) => a.text)).toEqual(['spindle\'s limit 0.25 N·m', 'spindle\'s limit 4000 W, above this plot']);
    expect((layout['yaxis3'] as { range: number[] }).range[1]).toBeCloseTo(336);
    expect(programFigure({ ...program, torque_limit_n_m: null, power_limit_w: null }, light).layout['shapes']).toEqual([]);
  });
  it('have a finite range where nothing is known', () => {
    expect(highest([null, null])).toBe(0);
    const none = programFigure(withBlocks({ peak_f_n: 0 }), light);
    expect((none.layout['yaxis'] as { range: number[] }).range).toEqual([0, 1.12]);
  });
});

describe('track', () => {
  it('keeps moves in air apart from those in the cut', () => {
    expect(moves(track, false)).toEqual({ x: [0, 0, null, 10.001, 50], y: [0, 0, null, 0, 0], z: [20, 0, null, 0, 5] });
    expect(moves(track, true).x).toEqual([0, 10, 10.001]);
  });
  it('marks a long block along its way, a short one once, the highest force last', () => {
    const points = marks(track, 10);
    expect(points.force[points.force.length - 1]).toBe(300);
    expect(points.force.filter((force) => force === 100).length).toBe(9);
    expect(points.x[8]).toBe(10);
    expect(points.place[9]).toEqual([4, 14]);
    expect(points.force.length).toBeLessThanOrEqual(10 + 2);
  });
  it('gives a millimetre the same length in all views', () => {
    for (const width of [300, 680, 1100]) {
      const place = frame(placesOf(track), width);
      const across = width - 64 - 24;
      const down = place.height - 30 - 104;
      const scale = (range: [number, number], domain: [number, number], room: number) => ((domain[1] - domain[0]) * room) / (range[1] - range[0]);
      const scales = [
        scale(place.x, place.top[0]!, across),
        scale(place.y, place.top[1]!, down),
        scale(place.x, place.side[0]!, across),
        scale(place.z, place.side[1]!, down),
      ];
      for (const each of scales) expect(each).toBeCloseTo(scales[0]!, 6);
      expect(place.stacked).toBe(width < 640);
    }
  });
  it('holds all of the path within its ranges', () => {
    const place = frame({ ...placesOf(track), y_mm: [0, 200, 0, -300, 0] }, 900);
    expect(place.y[0]).toBeLessThan(-300);
    expect(place.y[1]).toBeGreaterThan(200);
    expect(place.x[0]).toBeLessThan(0);
    expect(place.x[1]).toBeGreaterThan(50);
  });
  it('survives a program that stays where it is', () => {
    const still = track.map((block) => ({ ...block, x_mm: 1, y_mm: 2, z_mm: 3 }));
    const place = frame(placesOf(still), 900);
    for (const [low, high] of [place.x, place.y, place.z]) expect(high - low).toBeGreaterThanOrEqual(1 - 1e-9);
    expect(marks(still).force).toEqual([100, 300]);
  });
  it('colours by force on one scale', () => {
    for (const theme of [light, dark]) {
      const { data, layout } = trackFigure(track, theme, 900);
      expect(data).toHaveLength(6);
      expect(data[2]).toMatchObject({ marker: { coloraxis: 'coloraxis' } });
      expect(data[5]).toMatchObject({ marker: { coloraxis: 'coloraxis' }, yaxis: 'y2' });
      expect(layout['coloraxis']).toMatchObject({ colorscale: theme.scale });
    }
  });
});

describe('deflection over γ', () => {
  const sweep: SpindleRotation = {
    rotation_deg: [-180, 0, 180],
    deflection_um: [null, 20, 40],
    along_normal_um: [null, 14, 28],
    limit_distance_deg: [null, 60, 60],
    condition_number: [null, 5, 9],
    best_deg: 0,
    best_deflection_um: 20,
    used_deg: 90,
  };
  it('marks the best and the used', () => {
    const { data, layout } = gammaFigure(sweep, light);
    expect(data.map((trace) => trace['name'])).toEqual(['deflection', 'used', 'best', 'condition number']);
    expect(data[1]).toMatchObject({ x: [90], y: [30] });
    expect(data[2]).toMatchObject({ x: [0], y: [20], marker: { symbol: 'diamond' } });
    expect(layout['xaxis']).toMatchObject({ anchor: 'y2', dtick: 45 });
  });
  it('does without marks and condition number', () => {
    const { data, layout } = gammaFigure({ ...sweep, best_deflection_um: null, used_deg: -90, condition_number: [null, null, null] }, light);
    expect(data.map((trace) => trace['name'])).toEqual(['deflection']);
    expect(layout).not.toHaveProperty('yaxis2');
  });
});
