import { describe, expect, it } from 'vitest';
import type { Recording } from '../documents';
import type { FeedDirections, Frf, Mode } from '../views';
import { convergenceFigure, stabilisationFigure } from './fit';
import { breakJumps, frfFigure, prefersLogFrequency } from './frf';
import { polarFigure, rings, toPlane } from './polar';
import { harmonics, spectrumFigure } from './spectrum';
import { light, logTicks, plain, rpm } from './theme';
import { sampleReport } from '../report_sample';

describe('texts', () => {
  it('group thousands', () => expect([rpm(9999.6), rpm(8000), rpm(123456)]).toEqual(['10\u202f000\u202frpm', '8000\u202frpm', '123\u202f456\u202frpm']));
  it('lose their markup', () => expect(plain('<b>&"')).toBe('&lt;b&gt;&amp;"'));
});

describe('logarithmic ticks', () => {
  it('stand at 1, 2 and 5', () => {
    expect(logTicks(5, 1000)).toEqual({
      tickvals: [5, 10, 20, 50, 100, 200, 500, 1000],
      ticktext: ['5', '10', '20', '50', '100', '200', '500', '1000'],
    });
  });
  it('thin out over many decades and survive a bad range', () => {
    expect(logTicks(0.01, 1000).tickvals).toEqual([0.01, 0.1, 1, 10, 100, 1000]);
    expect(logTicks(0, 10).tickvals).toEqual([]);
    expect(logTicks(10, 10).tickvals).toEqual([]);
  });
});

const lines = [5, 10, 20, 500];
const frf: Frf = {
  name: 'xy',
  unit: 'µm/N',
  predicted: null,
  suspect_bands_hz: [],
  unreliable_bands_hz: [],
  measured: { frequency_hz: lines, magnitude: [1, 2, null, 0.5], phase_deg: [0, -170, 170, 160] },
  fitted: { frequency_hz: lines, magnitude: [1, 2, 3, 0.5], phase_deg: [0, -170, -190, -200] },
  coherence: { frequency_hz: lines, values: [1, 0.9, 0.8, 1] },
  trusted_from_hz: 8,
  trusted_to_hz: null,
  grade: null,
  findings: [],
  remedies: [],
  relative_error: null,
  prediction_error: null,
};

describe('FRF', () => {
  it('breaks the phase where it wraps, and nowhere else', () => {
    expect(breakJumps([1, 2, 3], [-170, 170, 160])).toEqual({ x: [1, 2, 2, 3], y: [-170, null, 170, 160] });
    expect(breakJumps([1, 2, 3], [0, 90, null])).toEqual({ x: [1, 2, 3], y: [0, 90, null] });
  });
  it('prefers a logarithmic axis over a wide band', () => {
    expect(prefersLogFrequency(frf)).toBe(true);
    expect(prefersLogFrequency({ ...frf, measured: { ...frf.measured!, frequency_hz: [0, 500, 3500] } })).toBe(false);
  });
  it('shows measured, fitted and coherence, and shades what is not trusted', () => {
    const mode = { ...sampleReport().modes!.modes[0]!, limit_share: null };
    const modes: Mode[] = [{ ...mode, mode: 1, mode_of: 'tool', frequency_hz: 10 }, { ...mode, mode: 2, mode_of: 'tool', frequency_hz: 9000 }, { ...mode, mode: 1, mode_of: 'workpiece', frequency_hz: 20 }];
    const figure = frfFigure(frf, modes, true, light);
    expect(figure.data).toHaveLength(5);
    const shapes = figure.layout['shapes'] as { type: string; x0: number; x1: number }[];
    expect(shapes.filter((shape) => shape.type === 'rect')).toMatchObject([{ x0: 5, x1: 8 }]);
    expect(shapes.filter((shape) => shape.type === 'line')).toMatchObject([{ x0: 10 }]);
    expect((figure.layout['annotations'] as { x: number }[])[0]!.x).toBeCloseTo(1); // log10 of the place, as Plotly wants it
    expect(figure.layout['xaxis']).toMatchObject({ type: 'log', anchor: 'y3' });
  });
  it('never shades beyond the band, where a logarithmic axis has no place', () => {
    const figure = frfFigure({ ...frf, trusted_from_hz: 9000, trusted_to_hz: 0 }, [], true, light);
    expect(figure.layout['shapes']).toMatchObject([{ x0: 5, x1: 500 }, { x0: 5, x1: 500 }]);
  });
  it('shows a prediction over a measurement with an axis of its own, and where it is in doubt', () => {
    const figure = frfFigure(
      { ...frf, predicted: frf.fitted, coherence: null, measured: { ...frf.measured!, frequency_hz: [6, 7, 8, 9] }, suspect_bands_hz: [[0, 15], [18, 20]], unreliable_bands_hz: [[300, 500]] },
      [],
      true,
      light,
    );
    expect(figure.data.map((trace) => trace['name'])).toEqual([
      'measured', 'measured', 'predicted', 'predicted', 'fitted', 'fitted', 'suspect: the holder would create energy', 'unreliable: the measurement is amplified',
    ]);
    expect(figure.data[0]!['x']).toEqual([6, 7, 8, 9]);
    expect(figure.data[2]!['x']).toEqual([5, 10, 20, 500]);
    const shapes = (figure.layout['shapes'] as { type: string; x0: number; x1: number; line: { width: number } }[]).filter((shape) => shape.type === 'rect');
    expect(shapes.slice(1)).toMatchObject([{ x0: 5, x1: 15 }, { x0: 18, x1: 20 }, { x0: 300, x1: 500, line: { dash: 'dot' } }]);
  });
  it('does without fit and coherence', () => {
    const figure = frfFigure({ ...frf, fitted: null, coherence: null }, [], false, light);
    expect(figure.data.map((trace) => trace['name'])).toEqual(['measured', 'measured']);
    expect(figure.layout).not.toHaveProperty('yaxis3');
    expect(figure.layout['xaxis']).toMatchObject({ type: 'linear', anchor: 'y2' });
  });
});

describe('polar plot', () => {
  it('has rings at round numbers that reach the highest value', () => {
    expect(rings(0.55)).toEqual([0.2, 0.4, 0.6]);
    expect(rings(3)).toEqual([1, 2, 3]);
    expect(rings(0)).toEqual([1]);
    for (let most = 0.01; most < 200; most *= 1.17) {
      const steps = rings(most);
      expect(steps.length).toBeGreaterThanOrEqual(2);
      expect(steps.length).toBeLessThanOrEqual(6);
      expect(steps[steps.length - 1]).toBeGreaterThanOrEqual(most * 0.999);
    }
  });
  it('turns counter-clockwise from x and closes a full turn', () => {
    const line = toPlane([0, 90, 180, 270], [1, 2, null, 4]);
    expect(line.x).toHaveLength(5);
    expect(line.x[1]).toBeCloseTo(0);
    expect(line.y[1]).toBeCloseTo(2);
    expect(line.x[2]).toBeNull();
    expect(line.y[3]).toBeCloseTo(-4);
    expect(line.x[4]).toBeCloseTo(line.x[0]!);
    expect(line.y[4]).toBeCloseTo(line.y[0]!);
    expect(toPlane([0, 45, 90], [1, 1, 1]).x).toHaveLength(3);
    expect(toPlane([0, 180, 360], [1, 1, 1]).x).toHaveLength(3);
  });
  const feed: FeedDirections = {
    direction_deg: [0, 90, 180, 270],
    lowest_limit_mm: [0.3, 0.5, 0.3, 0.5],
    limit_at_speed_mm: [1, null, 1, null],
    spindle_speed_rpm: 9000,
    used_direction_deg: 90,
    searched_depth_mm: 3,
  };
  it('marks the directions without a limit at the searched depth', () => {
    expect(polarFigure(feed, 'lowest', light).data).toHaveLength(1);
    const open = polarFigure(feed, 'speed', light).data;
    expect(open).toHaveLength(2);
    expect(open[1]!['name']).toBe('none up to 3 mm');
    expect((open[1]!['y'] as number[])[1]).toBeCloseTo(3);
  });
  it('points an arrow along the feed of the job', () => {
    const arrows = (polarFigure(feed, 'lowest', light).layout['annotations'] as Record<string, number>[]).filter((a) => a['showarrow']);
    expect(arrows).toHaveLength(1);
    expect(arrows[0]!['x']).toBeCloseTo(0);
    expect(arrows[0]!['y']).toBeGreaterThan(0);
  });
});

const recording: Recording = {
  ...sampleReport().recordings!.recordings[0]!,
  file: 'cut.csv',
  rotation_hz: 100,
  tooth_passing_hz: 300,
  teeth: 3,
  amplitude_unit: 'm/s²',
  frequency_hz: [0, 500, 1000],
  amplitude: [0, 2, 1],
  peaks: [
    { frequency_hz: 325, amplitude: 1, kind: 'tooth passing', text: 'tooth' },
    { frequency_hz: 417, amplitude: 2, kind: 'chatter', text: 'mode 1' },
    { frequency_hz: 450, amplitude: 1, kind: 'unexplained', text: '?' },
  ],
};

describe('spectrum', () => {
  it('counts each harmonic as rotation or tooth passing, not both', () => {
    expect(harmonics(100, 650, 3)).toEqual([100, 200, 400, 500]);
    expect(harmonics(300, 650)).toEqual([300, 600]);
    expect(harmonics(0, 650)).toEqual([]);
    expect(harmonics(1e-3, 1e6).length).toBe(400);
  });
  it('names the peaks that are neither', () => {
    const { data, layout } = spectrumFigure(recording, false, light);
    expect(data.map((trace) => trace['name'])).toEqual(['rotation', 'tooth passing', 'spectrum', 'tooth-passing peak', 'neither', 'chatter']);
    expect(data[5]!['text']).toEqual(['417.0']);
    expect(layout['yaxis']).toMatchObject({ type: 'linear', range: [0, 2.3] });
  });
  it('has a finite logarithmic range, even for silence', () => {
    const range = (spectrumFigure({ ...recording, amplitude: [0, 0, 0] }, true, light).layout['yaxis'] as { range: number[] }).range;
    expect(range.every(Number.isFinite)).toBe(true);
  });
});

describe('fit', () => {
  it('counts iterations from one', () => {
    expect(convergenceFigure([1, 0.5, 0.1], light).data[0]!['x']).toEqual([1, 2, 3]);
    expect(convergenceFigure([1, 0.5, 0.1], light).layout['yaxis']).toMatchObject({ type: 'log' });
    expect(convergenceFigure([1, 0], light).layout['yaxis']).toMatchObject({ type: 'linear' });
  });
  it('keeps stable and moving poles apart', () => {
    const poles = [
      { order: 2, frequency_hz: 10, stable: false },
      { order: 4, frequency_hz: 10, stable: true },
      { order: 4, frequency_hz: 50, stable: false },
    ].map((pole) => ({ ...pole, damping_ratio: 0.02 }));
    const [moving, stable] = stabilisationFigure(poles, light).data;
    expect(moving!['x']).toEqual([10, 50]);
    expect(stable!['y']).toEqual([4]);
  });
});
