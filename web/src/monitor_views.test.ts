import { describe, expect, it } from 'vitest';
import type { Monitor, MonitorAlarm, MonitorStay, Num } from './documents';
import { aliasText, chatterMarks, duration, inputFaultText, findings, frequencyText, multiplesOver, reasonText, shadedStays, speedStretches } from './monitor_views';
import { sampleReport } from './report_sample';

const alarm: MonitorAlarm = {
  count: 3,
  from_s: 1.5,
  to_s: 4,
  chatter_s: 2,
  low_frequency_hz: 683,
  high_frequency_hz: 683.5,
  chatter_frequency_hz: 683.2,
  chatter_frequency_std_hz: 0.6,
  channel: 'x',
  hidden: null,
  mode: 8,
  mode_of: 'tool',
  suggested_spindle_speed_rpm: 3416,
  line_frequencies_hz: [],
  no_speed: null,
  why: null,
};

const sample = sampleReport().monitor!;

function said(part: Partial<Monitor>): string[] {
  return findings({ ...sample, state_times: [], alarm_count: 0, alarms: [], ...part }).map(({ head, text }) => head + text);
}

const stable = (duration_s: number) => ({ state: 'stable' as const, reason: null, duration_s });
const blind = (reason: NonNullable<MonitorStay['reason']>, duration_s: number) => ({ state: 'blind' as const, reason, duration_s });

describe('what was found, in words', () => {
  it('names alarms first, with where and what is quiet', () => {
    const chatter = { state: 'chatter' as const, reason: null, duration_s: 2 };
    expect(said({ state_times: [stable(5), chatter], alarm_count: 3, alarms: [alarm] })).toEqual([
      'Chatter for 2.00 s in 3 alarms, between 1.50 s and 4.00 s, at 683.20\u202f±\u202f0.60 Hz (mode 8; quiet near 3416 rpm).',
      'Stable for 5.00 s.',
    ]);
    const others = [1, 2, 3, 4].map((i) => ({ ...alarm, mode: null, suggested_spindle_speed_rpm: null, chatter_s: 2 / i, chatter_frequency_hz: 100 * i, low_frequency_hz: 100 * i, high_frequency_hz: 100 * i, chatter_frequency_std_hz: null }));
    expect(said({ state_times: [chatter], alarm_count: 4, alarms: others })[0]).toContain('at 100.0 Hz, 200.0 Hz and 300.0 Hz and others.');
    const arm = { ...alarm, suggested_spindle_speed_rpm: null, no_speed: 'arm' as const };
    expect(said({ state_times: [chatter], alarm_count: 3, alarms: [arm] })[0]).toContain('(mode 8; no spindle speed avoids it: a mode of the arm).');
    const without = { ...alarm, low_frequency_hz: null, high_frequency_hz: null, chatter_frequency_hz: null };
    expect(said({ state_times: [chatter], alarm_count: 1, alarms: [without] })).toEqual(['Chatter for 2.00 s in 1 alarm, between 1.50 s and 4.00 s.']);
  });
  it('says for how long it could not tell, and why', () => {
    expect(said({ state_times: [stable(4), blind('gap', 0.5), blind('speed-unknown', 3.2)] })).toEqual([
      'No alarm in the 4.00 s that could be judged.',
      'Cannot tell: spindle speed unknown, for 3.20 s; samples lost, for 0.50 s. Whether it chattered then is not known.',
      'Stable for 4.00 s.',
    ]);
  });
  it('never calls quiet what was not judged', () => {
    for (const part of [{}, { state_times: [blind('no-signal', 8)] }]) {
      const texts = said(part);
      expect(texts).toHaveLength(1);
      expect(texts[0]).toMatch(/^Cannot tell: /);
    }
    for (const state_times of [[], [stable(3)], [blind('clipped', 3)], [stable(1), blind('gap', 3)]]) {
      expect(said({ state_times }).join(' ')).not.toMatch(/no chatter/i);
    }
  });
  it('has words for every reason', () => {
    expect(['no-signal', 'clipped', 'speed-unknown', 'gap', 'standstill', 'overloaded', 'learning', 'none', 'moon'].map(reasonText)).toEqual([
      'no usable signal',
      'signal at the limit of its converter',
      'spindle speed unknown',
      'samples lost',
      'the spindle stands still',
      'the monitor was too slow for the samples',
      'the monitor has not seen a calm yet',
      'reason unknown',
      'moon',
    ]);
    expect(reasonText(null)).toBe('reason unknown');
  });
  it('has words for every fault', () => {
    expect(['not-finite', 'wrong-sample-rate', 'moon'].map(inputFaultText)).toEqual(['samples that are no number', 'the sample rate is another one', 'moon']);
  });
  it('writes durations as people say them', () => {
    expect([0, 0.625, 12.44, 99.96, 320, 7500].map(duration)).toEqual(['0.00 s', '0.63 s', '12.4 s', '1 min 40 s', '5 min 20 s', '2 h 5 min']);
  });
});

it('says what a line is that was measured folded, or may be', () => {
  expect(aliasText(alarm)).toBe('');
  expect(aliasText({ line_frequencies_hz: [989], no_speed: null })).toBe('989.0 Hz folded');
  const open = { line_frequencies_hz: [661, 989, 2311], no_speed: 'ambiguous-alias' as const };
  expect(aliasText(open)).toBe('no mode, no speed: no anti-alias filter is stated, it may be 661.0, 989.0 or 2311.0 Hz');
  const chatter = { state: 'chatter' as const, reason: null, duration_s: 2 };
  const found = said({ state_times: [chatter], alarm_count: 1, alarms: [{ ...alarm, ...open, mode: null, mode_of: null, suggested_spindle_speed_rpm: null }] });
  expect(found[0]).toContain('Hz (no mode, no speed: no anti-alias filter is stated, it may be 661.0, 989.0 or 2311.0 Hz).');
});

it('gives a range where a frequency moved by more than its deviation', () => {
  expect(frequencyText(alarm)).toBe('683.20\u202f±\u202f0.60');
  expect(frequencyText({ ...alarm, high_frequency_hz: 745.4 })).toBe('683 to 745');
  expect(frequencyText({ ...alarm, low_frequency_hz: 40.12, high_frequency_hz: 41.38, chatter_frequency_std_hz: null })).toBe('40.1 to 41.4');
  expect(frequencyText({ ...alarm, low_frequency_hz: null, high_frequency_hz: null, chatter_frequency_hz: null })).toBe('–');
});

describe('shaded stays', () => {
  const stay = (state: MonitorStay['state'], from_s: number, to_s: number): MonitorStay => ({ state, reason: null, from_s, to_s });
  it('are all that are not stable', () => {
    const stays = [stay('stable', 0, 1), stay('chatter', 1, 2), stay('blind', 2, 3)];
    expect(shadedStays(stays)).toEqual(stays.slice(1));
    expect(shadedStays([])).toEqual([]);
  });
  it('of very many are joined where they would touch, without losing the worst', () => {
    const stays = Array.from({ length: 2000 }, (_, i) => stay(i % 50 === 0 ? 'chatter' : i % 2 === 0 ? 'stable' : 'transition', i, i + 1));
    const shown = shadedStays(stays, 100);
    expect(shown.length).toBeLessThanOrEqual(200);
    for (const chatter of stays.filter(({ state }) => state === 'chatter')) {
      expect(shown.some(({ state, from_s, to_s }) => state === 'chatter' && from_s <= chatter.from_s && to_s >= chatter.to_s)).toBe(true);
    }
  });
});

it('marks where the frequency of chatter is, apart enough to be distinguished', () => {
  const low = Array.from({ length: 1000 }, (_, run) => (run < 500 ? null : run === 700 ? 300 : 680));
  const high = low.map((value, run) => (value !== null && run === 800 ? 900 : value));
  const { time_s, frequency_hz } = chatterMarks({ ...sample, decisions: { ...sample.decisions, run_s: 2, chatter_frequency_hz: { low, high } } }, 2000);
  expect(time_s[0]).toBe(1000);
  expect(time_s.length).toBeLessThan(40);
  for (const [time, frequency] of [[1400, 300], [1600, 900]]) expect(time_s.some((at, i) => at === time && frequency_hz[i] === frequency)).toBe(true);
  expect(Math.max(...time_s)).toBeGreaterThan(1950);
});

describe('the speed', () => {
  const decisions = (speed: Num[], deviation: Num[]) => ({
    ...sample,
    decisions: { ...sample.decisions, run_s: 0.5, spindle_speed_rpm: { low: speed, high: speed.map((value) => value && value + 10) }, spindle_speed_std_rpm: { low: deviation, high: deviation } },
  });
  const monitor = decisions([null, 3000, 3010, null, null, 6000], [null, 5, null, null, null, 1]);
  it('is a stretch for each time that it is known', () => {
    expect(speedStretches(monitor)).toEqual([
      { time_s: [0.5, 1, 1.5], speed_rpm: [3005, 3015, 3015], low_rpm: [2995, 3010, 3010], high_rpm: [3015, 3020, 3020] },
      { time_s: [2.5, 3], speed_rpm: [6005, 6005], low_rpm: [5999, 5999], high_rpm: [6011, 6011] },
    ]);
  });
  it('has multiples of rotation as far as they are within the map', () => {
    const lines = multiplesOver(speedStretches(monitor), 2, [1, 2], 202);
    expect(lines.x).toEqual([0.5, 1, 1.5, null, 2.5, 3, null, 0.5, 1, 1.5, null]);
    expect(lines.y.slice(0, 3).map((y) => y && Math.round(10 * y) / 10)).toEqual([100.2, 100.5, 100.5]);
  });
});
