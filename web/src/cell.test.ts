import { describe, expect, it } from 'vitest';
import type { CellDocument, CellFigure, CellMiss, CellPosture, Vector } from './documents';
import { cellFacts, gammaText, limitText, nearestText, placeOf, vectorText } from './cell_views';
import { sampleReport } from './report_sample';
import { axesOf, layOutCell, viewWidth } from './figures/cell_layout';

const up: CellFigure = {
  name: 'home',
  links_mm: [[[0, 0, 0], [0, 0, 700], [400, 0, 700], [400, 0, 1700], [1500, 0, 1700], [1700, 0, 1700]]],
  joints_mm: [[0, 0, 0], [400, 0, 700], [400, 0, 1700], [400, 0, 1700], [1500, 0, 1700], [1500, 0, 1700]],
  flange_mm: [1700, 0, 1700],
  tip_mm: [1900, 0, 1700],
};
const posture: CellPosture = {
  name: 'home',
  joints: [0, -90, 90, 0, 0, 0],
  tip_mm: [1900, 0, 1700],
  axis: [-1, 0, 0],
  program_tip_mm: [200, -300, 1000],
  program_axis: [-1, 0, 0],
  gamma_deg: 0,
  flange: { origin_mm: [1700, 0, 1700], abc_deg: [0, 90, 0], quaternion: [0.7, 0, 0.7, 0], rotation_vector_rad: [0, 1.57, 0] },
  to_limit: [170, 20, 65, 350, 125, null],
  nearest_joint: 2,
  condition_number: 14.2,
};

const sample = sampleReport().cell!;

function cell(change: Partial<CellDocument> = {}): CellDocument {
  return {
    document: 'check/1',
    cell: 'cell.toml',
    robot: { kind: 'serial', model: null, description: 'An arm', source: null },
    joints: [],
    postures: [posture],
    at_limits: [],
    placement: {
      origin_mm: [1700, 300, 700],
      rotation_deg: [0, 0, 90],
      works: true,
      program: null,
      whole: true,
      poses: 1,
      complete: true,
      missed: 0,
      misses: [],
      no_way: null,
      margin: 0.3,
      gamma_deg: [0, 0],
    },
    proposals: [],
    drawing: { figures: [up], reach_side_mm: [[[-2000, 0], [2000, 0], [2000, 2500]]], reach_top_mm: [[[-2000, -2000], [2000, -2000], [0, 2000]]], program_mm: [] },
    assumed: [],
    notes: [],
    ...change,
  };
}

function length([[x, y], [u, v]]: [number, number][]): number {
  return Math.hypot(u! - x!, v! - y!);
}

describe('the picture of a cell', () => {
  it('shows both views to one scale, z up in the one and y up in the other', () => {
    const { views, bar } = layOutCell(cell());
    const scale = length([bar.from, bar.to]) / parseFloat(bar.text);
    for (const { figures } of views) expect(length(figures[0]!.tool as [number, number][])).toBeCloseTo(200 * scale, 6);
    const [side, above] = views;
    const [base, workpiece] = side!.frames;
    expect(workpiece!.origin[0] - base!.origin[0]).toBeCloseTo(1700 * scale, 6);
    expect(base!.origin[1] - workpiece!.origin[1]).toBeCloseTo(700 * scale, 6);
    expect(above!.frames[0]!.origin[1] - above!.frames[1]!.origin[1]).toBeCloseTo(300 * scale, 6);
    // The workpiece is turned by a quarter: its x points along the base's y.
    const x = above!.frames[1]!.axes.find(({ name }) => name === 'x')!;
    expect(x.to[0]).toBeCloseTo(above!.frames[1]!.origin[0], 6);
    expect(x.to[1]).toBeLessThan(above!.frames[1]!.origin[1]);
  });
  it('stays within its box, whatever the proportions', () => {
    for (const [across, high] of [[1, 1], [10, 1], [0.01, 30]] as const) {
      const stretched = ([x, y, z]: Vector): Vector => [across * x, across * y, high * z];
      const figure = { ...up, links_mm: up.links_mm.map((link) => link.map(stretched)), flange_mm: stretched(up.flange_mm), tip_mm: stretched(up.tip_mm) };
      const { height, views } = layOutCell(cell({ drawing: { figures: [figure], reach_side_mm: [], reach_top_mm: [], program_mm: [] } }));
      for (const [x, y] of views.flatMap(({ figures }) => [...figures[0]!.links.flat(), ...figures[0]!.tool])) {
        expect(x).toBeGreaterThanOrEqual(0);
        expect(x).toBeLessThanOrEqual(viewWidth);
        expect(y).toBeGreaterThanOrEqual(0);
        expect(y).toBeLessThanOrEqual(height);
      }
    }
  });
  it('gives joints of one place one label, and draws home faintly beside another posture', () => {
    const alone = layOutCell(cell()).views[0]!.figures;
    expect(alone[0]!.joints.map(({ label }) => label)).toEqual(['1', '2', '3, 4', '5, 6']);
    const drawing = { ...cell().drawing, figures: [up, { ...up, name: "workpiece's origin" }] };
    expect(layOutCell(cell({ drawing })).views[0]!.figures.map(({ kind }) => kind)).toEqual(['home', 'shown']);
  });
  it('marks what cannot be reached and where the workpiece could go', () => {
    const base = cell();
    const miss: CellMiss = { ...sample.placement.misses[0]!, base_tip_mm: [5000, 0, 0] };
    const failing = cell({
      placement: { ...base.placement, works: false, program: 'part.ngc', poses: 9, missed: 1, misses: [miss] },
      proposals: [{ ...sample.proposals[0]!, origin_mm: [1400, 0, 700], rotation_deg: [0, 0, 0] }],
    });
    const { views, words } = layOutCell(failing);
    expect(views.map(({ misses }) => misses.length)).toEqual([1, 1]);
    expect(views[0]!.frames.map(({ kind, name }) => `${kind} ${name}`)).toEqual(['base base', 'workpiece workpiece', 'proposal 1']);
    expect(words).toBe('An arm does not reach the workpiece as it stands; 1 other place is marked. Seen from the side and from above.');
  });
  it('turns a frame about x, then y, then z', () => {
    const round = (axes: Vector[]) => axes.map((axis) => axis.map((value) => Math.round(1e9 * value) / 1e9 + 0));
    expect(round(axesOf([0, 0, 90]))).toEqual([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]);
    expect(round(axesOf([90, 0, 90]))).toEqual([[0, 1, 0], [0, 0, 1], [1, 0, 0]]);
    expect(round(axesOf([0, 90, 0]))).toEqual([[0, 0, -1], [0, 1, 0], [1, 0, 0]]);
  });
});

describe('the words of a cell', () => {
  it('name limits, what is assumed and what is nearest', () => {
    const joint = { joint: 1, unit: 'deg' as const, min_position: -185, max_position: null, max_velocity_per_s: 123, max_acceleration_per_s2: 246, max_jerk_per_s3: null, assumed: ['max_acceleration_per_s2'] };
    expect(limitText(joint, 'min_position')).toBe('-185');
    expect(limitText(joint, 'max_position')).toBe('–');
    expect(limitText(joint, 'max_acceleration_per_s2')).toBe('246*');
    expect(nearestText(posture, '°')).toBe('joint 2, 20°');
    expect(nearestText({ ...posture, to_limit: [1, -2.5, 3, 4, -5, null] }, '°')).toBe('beyond: joint 2 by 2.5°, joint 5 by 5°');
    expect(nearestText({ ...posture, nearest_joint: null }, '°')).toBe('no limits');
  });
  it('name places and turns', () => {
    const miss = { block: 0, line: null };
    expect(placeOf(miss, null)).toBe("workpiece's origin");
    expect(placeOf(miss, 'part.ngc')).toBe("program's start");
    expect(placeOf({ ...miss, block: 12, line: 40 }, 'part.ngc')).toBe('block 12 (line 40)');
    expect([gammaText(null), gammaText([30, 30]), gammaText([-30, 45.5])]).toEqual(['', 'γ 30°', 'γ -30° to 45.5°']);
    expect(vectorText([1, -1e-9, null], 2)).toBe('1.00, 0.00, –');
    expect(cellFacts(cell()).map(({ label }) => label)).toEqual(['Cell', 'Robot', 'Workpiece']);
  });
});
