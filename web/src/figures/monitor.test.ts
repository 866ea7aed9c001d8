import { describe, expect, it } from 'vitest';
import type { Calibration, Monitor } from '../documents';
import { alarms, rocFigure, scoreFigure, span, spectrogramFigure, waveFigure } from './monitor';
import { dark, light } from './theme';

const single = (values: number[]) => ({ low: values, high: values });

const monitor = {
  unit: 'm/s²',
  wave_run_s: 1,
  channels: [{ name: '<x>', wave: single([0, 1, -1]) }, { name: 'y', wave: { low: [0, 1, -2], high: [0, 2, -2] } }],
  spectrogram: { channel: 'x', begin_s: 0.5, step_s: 0.25, frequency_hz: [10, 20], level_db: [[-3, 0, -80], [-10, -20, -30]] },
  decisions: { run_s: 0.5, score: single([0, 1, 9]), threshold: single([5, 5, 5]), energy_entropy: single([1, 2, 3]), spindle_speed_rpm: single([0, 3000, 3000]) },
  stays: [
    { state: 'stable', from_s: 0, to_s: 1 },
    { state: 'transition', from_s: 1, to_s: 1.5 },
    { state: 'chatter', from_s: 1.5, to_s: 2 },
  ],
  events: [
    { time_s: 1, event: 'state', state: 'transition', chatter_frequency_hz: 15 },
    { time_s: 1.5, event: 'state', state: 'chatter', chatter_frequency_hz: 16 },
  ],
} as Monitor;

describe('what the monitor detected', () => {
  it('is shaded where it was not stable', () => {
    expect(alarms(monitor, light)).toMatchObject([
      { x0: 1, x1: 1.5, fillcolor: light.borderline },
      { x0: 1.5, x1: 2, fillcolor: light.chatter },
    ]);
    expect(span(monitor)).toEqual([0, 2]);
    expect(span({ ...monitor, stays: [] })).toEqual([0, 1]);
  });
  it('has a line a channel, named without markup', () => {
    const { data, layout } = waveFigure(monitor, light);
    expect(data.map((trace) => trace['name'])).toEqual(['&lt;x&gt;', 'y']);
    expect(data[0]).toMatchObject({ x: [0.25, 0.75, 1.25, 1.75, 2.25, 2.75], y: [0, 0, 1, 1, -1, -1] });
    expect(data[1]!['y']).toEqual([0, 0, 1, 2, -2, -2]);
    expect(layout['yaxis']).toMatchObject({ title: { text: 'Signal (m/s²)' } });
  });
  it('marks the frequencies that were reported as chatter, and no others', () => {
    for (const theme of [light, dark]) {
      const { data } = spectrogramFigure(monitor, theme);
      expect(data[0]).toMatchObject({ x: [0.5, 0.75, 1], zmax: 0 });
      expect(data[1]).toMatchObject({ x: [1.5], y: [16] });
    }
  });
  it('shows the rows that are there, each in a domain of its own', () => {
    const { data, layout } = scoreFigure(monitor, light);
    expect(data.map((trace) => trace['name'])).toEqual(['score', 'threshold', 'entropy', 'speed']);
    const domains = ['yaxis', 'yaxis2', 'yaxis3'].map((key) => (layout[key] as { domain: [number, number] }).domain);
    domains.forEach(([low, high], i) => {
      expect(low).toBeLessThan(high);
      if (i > 0) expect(high).toBeLessThanOrEqual(domains[i - 1]![0]);
    });
    expect(data[0]).toMatchObject({ x: [0, 0.5, 1], y: [0, 1, 9] });
    const bare = scoreFigure({ ...monitor, decisions: { ...monitor.decisions, spindle_speed_rpm: single([0, 0, 0]) } }, light);
    expect(bare.data).toHaveLength(3);
    expect(bare.layout['xaxis']).toMatchObject({ anchor: 'y2' });
  });
});

describe('calibration', () => {
  it('draws each curve in percent and the chosen threshold on top', () => {
    const chosen = { threshold: 5, false_alarm_rate: 0.01, detection_rate: 0.9, median_delay_s: null };
    const roc = [{ ...chosen, threshold: 9, false_alarm_rate: 0, detection_rate: 0.5 }, { ...chosen, threshold: 1, false_alarm_rate: 1, detection_rate: 1 }];
    const half = { stable: 10, chatter: 10, chosen, roc };
    const calibration: Calibration = { entropy: 'energy', threshold: 5, alarm: 'above', setting: half, verifying: half, median_lead_s: null, recordings: [] };
    const { data } = rocFigure(calibration, light, false);
    expect(data[0]).toMatchObject({ x: [0, 100], y: [50, 100] });
    expect(data[2]).toMatchObject({ x: [1], y: [90], name: 'chosen' });
  });
});
