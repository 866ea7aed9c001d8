import { describe, expect, it } from 'vitest';
import { cornerFigure, movesInView, pathFigure, tube } from './corners';
import type { Corner, JointMotion, Motion, MotionDocument, SmoothDocument, SmoothedBy, SmoothedJoint } from '../documents';
import { magnitude } from './rows';
import { jointFigure, speedFigure } from './smooth';
import { dark, light } from './theme';
import { sampleReport } from '../report_sample';

const band = (...values: number[]) => ({ low: values, high: values });

const joint: JointMotion = {
  unit: 'deg',
  velocity: band(0, 5, -8),
  acceleration: band(0, 10, -20),
  jerk: band(0, 100, -90),
  tracking_error: band(0, 0.01, 0.02),
};

const corner: Corner = { block: 4, line: 14, turn_deg: 90, radius_mm: 0.5, program: { x_mm: [-100, 0, 100], y_mm: [100, 0, 100] } };

const motion = (joints: JointMotion[] = [joint]): Motion => ({
  run_s: 1,
  tip_speed_mm_per_s: band(0, 40, 0),
  axis_speed_deg_per_s: band(0, 1, 0),
  joints,
  tip: { x_mm: [0, 5, 10], y_mm: [0, 0, 4], z_mm: [0, 0, 2], speed_mm_per_s: [0, 40, 0] },
  corner_paths: [{ x_mm: [-0.4, 0, 0.4], y_mm: [0.4, 0.1, 0.4] }],
});

const moved: MotionDocument = { document: 'motion/1', program: { x_mm: [0, 10], y_mm: [0, 4], z_mm: [0, 2] }, corners: [corner], motions: [motion(), motion()] };
const alone: MotionDocument = { ...moved, motions: [motion()] };

const sample = sampleReport().smooth!;
const limited = (limit_velocity: number | null): SmoothedJoint => ({ ...sample.joints[0]!, unit: 'rad', limit_velocity, limit_acceleration: 500, limit_jerk: null });

/** Of a method, or of several: smooth.json. */
function by(...methods: [SmoothedBy['method'], number][]): SmoothDocument {
  const { document: _, ...rest } = sample;
  const each = methods.map(([method, duration_s]): SmoothedBy => ({
    ...rest,
    method,
    duration_s,
    tip: { ...sample.tip, limit_error_mm: 0.05, limit_velocity_mm_per_s: 50 },
    axis: { ...sample.axis, limit_velocity_deg_per_s: 10 },
    joints: [limited((10 * Math.PI) / 180)],
  }));
  return { ...sample, ...each[0]!, methods: each };
}

const smooth = by(['verified', 2], ['paper', 2.5]);

const rows = (figure: { layout: Record<string, unknown> }) => Object.keys(figure.layout).filter((key) => key.startsWith('yaxis'));

describe('speeds', () => {
  it('have a line a method, over the longest of them, distinguishable without their colours', () => {
    const { data, layout } = speedFigure(smooth, moved, light);
    expect(data.map((trace) => trace['name'])).toEqual(['verified', 'paper', 'verified', 'paper']);
    expect(new Set(data.slice(0, 2).map((trace) => (trace['line'] as { dash: string }).dash)).size).toBe(2);
    expect(layout['xaxis']).toMatchObject({ range: [0, 2.5], anchor: 'y2' });
    const slow = speedFigure(by(['optimal', 2], ['paper', 50]), moved, light);
    expect(slow.layout['xaxis']).toMatchObject({ range: [0, 6] });
    expect(data.map((trace) => trace['showlegend'])).toEqual([true, true, false, false]);
    expect(speedFigure(by(['verified', 2]), alone, light).data[0]).toMatchObject({ showlegend: false });
  });
  it('show a limit near them as a line, a far one in words', () => {
    const { layout } = speedFigure(smooth, moved, light);
    expect(layout['shapes']).toMatchObject([{ yref: 'y', y0: 50 }]);
    expect((layout['annotations'] as { text: string }[]).map((a) => a.text)).toEqual(['limit 50 mm/s', 'limit 10 °/s, beyond this plot']);
  });
});

describe('a joint', () => {
  it('has its limits on both sides, and no row for what is not there', () => {
    const figure = jointFigure(smooth, motion(), 0, light);
    expect(rows(figure)).toHaveLength(4);
    expect((figure.layout['shapes'] as { y0: number }[]).map(({ y0 }) => Number(y0.toFixed(9)))).toEqual([10, -10]);
    expect(figure.layout['yaxis']).toMatchObject({ title: { text: 'Velocity (°/s)' } });
    const [low, high] = (figure.layout['yaxis'] as { range: [number, number] }).range;
    expect(low).toBeCloseTo(-11);
    expect(high).toBeCloseTo(11);
    expect(rows(jointFigure(smooth, motion([{ ...joint, tracking_error: null }]), 0, dark))).toHaveLength(3);
  });
  it('that stands still has a range', () => {
    const still = motion([{ ...joint, velocity: band(0, 0, 0) }]);
    const unlimited = { ...smooth, joints: [limited(null)] };
    expect((jointFigure(unlimited, still, 0, light).layout['yaxis'] as { range: number[] }).range).toEqual([-1, 1]);
    expect(magnitude([])).toBe(0);
  });
  it('has rows that never overlap', () => {
    const figure = jointFigure(smooth, motion(), 0, light);
    const domains = rows(figure).map((key) => (figure.layout[key] as { domain: [number, number] }).domain);
    domains.forEach(([low, high], i) => {
      expect(low).toBeLessThan(high);
      if (i > 0) expect(high).toBeLessThanOrEqual(domains[i - 1]![0]);
    });
  });
});

describe('path', () => {
  it('holds program and tip in both views, on one colour scale', () => {
    for (const theme of [light, dark]) {
      const { data, layout } = pathFigure(moved, theme, 900);
      expect(data).toHaveLength(4);
      expect(data[1]).toMatchObject({ y: [0, 0, 4], marker: { coloraxis: 'coloraxis' } });
      expect(data[3]).toMatchObject({ y: [0, 0, 2], yaxis: 'y2' });
      expect(layout['coloraxis']).toMatchObject({ colorscale: theme.scale, showscale: true });
    }
  });
});

describe('corner', () => {
  it('cuts long moves off outside its view, along their own line', () => {
    const moves = movesInView(corner);
    expect(moves).toHaveLength(2);
    for (const [from, to] of moves) {
      expect(Math.max(Math.hypot(...from), Math.hypot(...to))).toBeCloseTo(1.5);
      for (const [x, y] of [from, to]) expect(Math.abs(x)).toBeCloseTo(y);
    }
    const passing: Corner = { ...corner, program: { x_mm: [50, 60], y_mm: [0, 0] } };
    expect(movesInView(passing)).toEqual([]);
  });
  it('has a tube as wide as twice the tolerance', () => {
    const shapes = tube([[[0, 0], [2, 0]]], 0.1, 'grey');
    expect(shapes.map((shape) => shape['type'])).toEqual(['path', 'circle', 'circle']);
    expect(shapes[0]!['path']).toBe('M0,0.1L2,0.1L2,-0.1L0,-0.1Z');
    expect(shapes[1]).toMatchObject({ x0: -0.1, x1: 0.1, y0: -0.1, y1: 0.1, layer: 'below' });
    expect(tube([[[1, 1], [1, 1]]], 0.1, 'grey')).toHaveLength(1);
  });
  it('shows the way of each method, escaped', () => {
    const { data, layout } = cornerFigure(smooth, moved, 0, light, 400);
    expect(data.map((trace) => trace['name'])).toEqual(['program', 'verified', 'paper']);
    expect(layout['title']).toMatchObject({ text: 'Line 14: 90°' });
    expect(layout['yaxis']).toMatchObject({ scaleanchor: 'x', range: [-0.25, 0.75] });
    expect(cornerFigure(by(['verified', 2]), alone, 0, light, 400).data[1]).toMatchObject({ showlegend: false });
  });
});
