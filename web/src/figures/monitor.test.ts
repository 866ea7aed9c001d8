import { describe, expect, it } from 'vitest';
import type { Calibration, Monitor, Num } from '../documents';
import { rocFigure, scoreFigure, span, spectrogramFigure, states, waveFigure } from './monitor';
import { dark, light } from './theme';
import { sampleReport } from '../report_sample';

const single = (values: Num[]) => ({ low: values, high: values });

const monitor: Monitor = {
  ...sampleReport().monitor!,
  unit: 'm/s²',
  teeth: 2,
  wave_run_s: 1,
  channels: [{ name: '<x>', wave: single([0, 1, -1]) }, { name: 'y', wave: { low: [0, 1, -2], high: [0, 2, -2] } }],
  spectrogram: { channel: 'x', begin_s: 0.5, step_s: 0.25, max_frequency_hz: 230, frequency_hz: [100, 200], level_db: [[-3, 0, -80], [-10, null, -30]] },
  decisions: {
    run_s: 0.5,
    score: single([null, 1, 9]),
    threshold: single([5, 5, 5]),
    energy_entropy: single([1, 2, 3]),
    chatter_frequency_hz: single([null, null, 16]),
    spindle_speed_rpm: single([null, 3000, 3060]),
    spindle_speed_std_rpm: single([null, 2, null]),
  },
  stays: [
    { state: 'blind', reason: 'speed-unknown', from_s: 0, to_s: 0.5 },
    { state: 'stable', reason: null, from_s: 0.5, to_s: 1 },
    { state: 'transition', reason: null, from_s: 1, to_s: 1.5 },
    { state: 'chatter', reason: null, from_s: 1.5, to_s: 2 },
    { state: 'blind', reason: 'gap', from_s: 2, to_s: 3 },
  ],
};

describe('what the monitor detected', () => {
  it('is shaded where it was not stable, each state once in the legend', () => {
    const shades = states(monitor, light);
    expect(shades).toMatchObject([
      { x0: 0, x1: 0.5, fillcolor: light.unknown, name: 'cannot tell', showlegend: true },
      { x0: 1, x1: 1.5, fillcolor: light.borderline },
      { x0: 1.5, x1: 2, fillcolor: light.chatter },
      { x0: 2, x1: 3, fillcolor: light.unknown, showlegend: false },
    ]);
    expect(scoreFigure(monitor, light).layout['shapes']).toEqual(shades);
    expect(span(monitor)).toEqual([0, 3]);
    const long = { ...monitor, stays: [{ ...monitor.stays[1]!, from_s: 0, to_s: 1000 }, { ...monitor.stays[3]!, from_s: 1000, to_s: 1000.1 }] };
    expect(states(long, light)).toMatchObject([{ x0: 1000, x1: 1002.0002 }]); // wide enough to be seen
    expect(span({ ...monitor, stays: [] })).toEqual([0, 1]);
  });
  it('has a line a channel, named without markup', () => {
    const { data, layout } = waveFigure(monitor, light, false);
    expect(data.map((trace) => trace['name'])).toEqual(['&lt;x&gt;', 'y']);
    expect(data[0]).toMatchObject({ x: [0.25, 0.75, 1.25, 1.75, 2.25, 2.75], y: [0, 0, 1, 1, -1, -1] });
    expect(data[1]!['y']).toEqual([0, 0, 1, 2, -2, -2]);
    expect(layout['yaxis']).toMatchObject({ title: { text: 'Signal (m/s²)' } });
  });
  it('marks the frequencies that were reported as chatter, and no others', () => {
    for (const theme of [light, dark]) {
      const { data } = spectrogramFigure(monitor, theme);
      expect(data[0]).toMatchObject({ x: [0.5, 0.75, 1], zmax: 0 });
      expect(data.find(({ name }) => name === 'chatter reported')).toMatchObject({ x: [1], y: [16] });
    }
  });
  it('ends the axis of frequencies where the document says, with the lines of the cut while the speed is known', () => {
    const { data, layout } = spectrogramFigure(monitor, light);
    expect(layout['yaxis']).toMatchObject({ range: [0, 230] });
    // 3000 rpm are 50 Hz: of two teeth rotation is drawn once, tooth passing up to its second multiple.
    expect(data.find(({ name }) => name === 'rotation')).toMatchObject({ x: [0.5, 1, 1.5, null], y: [50, 51, 51, null] });
    expect(data.find(({ name }) => name === 'tooth passing')!['y']).toEqual([100, 102, 102, null, 200, 204, 204, null]);
    const decisions = { ...monitor.decisions, chatter_frequency_hz: single([null, null, null]) };
    const unknown = spectrogramFigure({ ...monitor, teeth: null, decisions }, light);
    expect(unknown.data.map(({ name }) => name)).toEqual([undefined, 'rotation']);
    expect(unknown.data[1]!['y']).toHaveLength(12);
  });
  it('shows the rows that are there, each in a domain of its own', () => {
    const { data, layout } = scoreFigure(monitor, light);
    expect(data.map((trace) => trace['name'])).toEqual(['score', 'threshold', 'entropy', 'speed ± its standard deviation', 'speed']);
    const domains = ['yaxis', 'yaxis2', 'yaxis3'].map((key) => (layout[key] as { domain: [number, number] }).domain);
    domains.forEach(([low, high], i) => {
      expect(low).toBeLessThan(high);
      if (i > 0) expect(high).toBeLessThanOrEqual(domains[i - 1]![0]);
    });
    expect(data[0]).toMatchObject({ x: [0, 0.5, 1], y: [null, 1, 9] });
    const bare = scoreFigure({ ...monitor, decisions: { ...monitor.decisions, spindle_speed_rpm: single([null, null, null]) } }, light);
    expect(bare.data).toHaveLength(3);
    expect(bare.layout['xaxis']).toMatchObject({ anchor: 'y2' });
  });
  it('draws the speed with its deviation and a gap where it is unknown', () => {
    const { data, layout } = scoreFigure(monitor, light);
    expect(data[4]).toMatchObject({ x: [0.5, 1, 1.5, null], y: [3000, 3060, 3060, null] });
    expect(data[3]).toMatchObject({ fill: 'toself', y: [2998, 3060, 3060, 3060, 3060, 3002, null] });
    const [low, high] = (layout['yaxis3'] as { range: [number, number] }).range;
    expect(low).toBeGreaterThan(2900);
    expect(high).toBeLessThan(3160);
    const sure = scoreFigure({ ...monitor, decisions: { ...monitor.decisions, spindle_speed_std_rpm: single([null, null, null]) } }, light);
    expect(sure.data.map(({ name }) => name)).toEqual(['score', 'threshold', 'entropy', 'speed']);
  });
});

describe('calibration', () => {
  it('draws each curve in percent and the chosen threshold on top', () => {
    const chosen = { threshold: 5, false_alarm_rate: 0.01, detection_rate: 0.9, median_delay_s: null };
    const roc = [{ ...chosen, threshold: 9, false_alarm_rate: 0, detection_rate: 0.5 }, { ...chosen, threshold: 1, false_alarm_rate: 1, detection_rate: 1 }];
    const half = { stable: 10, chatter: 10, chosen, roc };
    const calibration: Calibration = { ...sampleReport().calibration!, threshold: 5, setting: half, verifying: half };
    const { data } = rocFigure(calibration, light, false);
    expect(data[0]).toMatchObject({ x: [0, 100], y: [50, 100] });
    expect(data[2]).toMatchObject({ x: [1], y: [90], name: 'chosen' });
    const none = rocFigure({ ...calibration, status: 'no-better-than-chance' }, light, false);
    expect(none.data[2]).toMatchObject({ name: 'best that was tried' });
  });
});
