// Frames of monitored spindles: the ring, its pixels, and what the view says of them.
import type { ComponentChildren } from 'preact';
import { renderToString } from 'preact-render-to-string';
import { describe, expect, it, vi } from 'vitest';
import type { MonitorWhy } from '../../documents';
import { dark, light } from '../../figures/theme';
import { Why } from '../../sections/why';
import { openApi } from '../api';
import { ServeContext } from '../context';
import type { FileEntry, FolderState } from '../documents';
import { MonitorView, Spindles, withMessage } from './monitor';
import { FrequencyAxis, Scroller } from './canvas';
import type { MonitorFrame, MonitorMessage, MonitorRow, MonitorSummary } from './documents';
import { MonitorFeed } from './feed';
import { cutLines, deepest_db, Painter, palette, referenceFor, rgb, rowBands, scoreHeight, ticks } from './paint';
import { decodeSpectrum, emptyColumn, FrameRing, noLevel } from './ring';
import { Basis, factsOf, HistoryTable, Now } from './spindle';
import { News, newsText } from './news';
import { playable, StartMonitor } from './start';
import { stillThere, stopAction } from './stop';
import { beganText, highestChoices, highestFor, nameOf, rowNote, statusText, timeText, withRows } from './text';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

const quiet: MonitorFrame = {
  clock_s: 0.1,
  time_s: 5,
  state: 'stable',
  reason: null,
  score: 0.2,
  threshold: 1,
  spindle_speed_rpm: 3000,
  chatter_frequency_hz: null,
  chatter_frequency_std_hz: null,
  mode: null,
  mode_of: null,
  suggested_spindle_speed_rpm: null,
  no_speed: null,
  faults: [],
  compute_us: 180,
  pace: 50,
  peak_db: 20,
  spectrum: 'A_9A',
};
const chatter: MonitorFrame = { ...quiet, state: 'chatter', score: 3, chatter_frequency_hz: 683.2, chatter_frequency_std_hz: 0.6, mode: 8, mode_of: 'tool', suggested_spindle_speed_rpm: 5000 };
const row: MonitorRow = {
  number: 7,
  kind: 'chatter',
  clock_s: 12,
  from_s: 3661.25,
  to_s: 3663.5,
  reason: null,
  score: 3.1,
  low_frequency_hz: 680,
  high_frequency_hz: 690,
  chatter_frequency_hz: 683.2,
  chatter_frequency_std_hz: 0.6,
  channel: 'ax',
  hidden: null,
  mode: 8,
  mode_of: 'tool',
  suggested_spindle_speed_rpm: 5000,
  line_frequencies_hz: [],
  no_speed: null,
  what: null,
  count: 0,
  message: null,
  why: null,
};
const summary: MonitorSummary = {
  id: 2,
  config: 'monitor.toml',
  input: 'cut.wav',
  speed: 50,
  status: 'running',
  error: null,
  started: '2026-11-25T22:00:00Z',
  clock_s: 12,
  channels: ['ax', 'ay'],
  sample_rate_hz: 10240,
  teeth: 2,
  frame: quiet,
  why: null,
  alarm_count: 3,
  decision_count: 400,
  dropped_hops: 0,
  lost_blocks: 2,
  blind_s: { gap: 2.5 },
};
const why: MonitorWhy = {
  test: 'ratio',
  sensor: null,
  hops: 6,
  of: 6,
  speed_belief: 0.41,
  conditions: [
    { quantity: 'asynchronous_ratio', meaning: 'energy beside the orders', shown_in: null, value: 0.31, at_least: 0.2, holds: true },
    { quantity: 'above_quiet', meaning: 'above the quietest', shown_in: 'dB', value: 100, at_least: 10, holds: true },
    { quantity: 'order_change', meaning: 'movement of the order beside it', shown_in: null, value: 0.01, at_most: 0.005, holds: false },
  ],
};
const edges_hz = [5, 255, 505, 1005, 5005];
const at = (clock_s: number, more: Partial<MonitorFrame> = {}): MonitorFrame => ({ ...quiet, clock_s, ...more });

describe('a spectrum', () => {
  it('comes as letters, 63 dB below the peak and up', () => {
    const levels = new Int8Array(4);
    expect(decodeSpectrum(quiet, levels)).toBe(true);
    expect([...levels]).toEqual([20 - 63, 20, 18, 20 - 63]);
    expect(decodeSpectrum({ peak_db: null, spectrum: null }, levels)).toBe(false);
    expect([...levels]).toEqual([noLevel, noLevel, noLevel, noLevel]);
    decodeSpectrum({ peak_db: -120, spectrum: 'A_' }, levels);
    expect([...levels]).toEqual([-127, -120, noLevel, noLevel]);
  });
});

describe('the ring', () => {
  it('holds no more than it has room for, and the newest', () => {
    const ring = new FrameRing(4, 100);
    for (let i = 1; i <= 12_345; ++i) ring.push(at(0.1 * i));
    expect(ring.size).toBe(100);
    expect(ring.latest_s).toBeCloseTo(1234.5);
    const column = emptyColumn(4);
    ring.column(1200, 1201, column); // pushed out long ago
    expect(column.known).toBe(false);
    ring.column(1230, 1231, column);
    expect(column.known).toBe(true);
    ring.push(at(3)); // came late
    expect(ring.latest_s).toBeCloseTo(1234.5);
  });
  it('gives what was gravest in a time', () => {
    const ring = new FrameRing(4);
    ring.push(at(1));
    ring.push(at(1.1, { ...chatter, clock_s: 1.1, spectrum: '_AAA', peak_db: 26 }));
    ring.push(at(1.2, { score: 0.5, state: 'blind', reason: 'gap' }));
    const column = emptyColumn(4);
    ring.column(0.9, 1.3, column);
    expect([column.state, column.ratio, column.speed_rpm]).toEqual(['chatter', 3, 3000]);
    expect(column.chatter_hz).toBeCloseTo(683.2, 3);
    expect([...column.levels]).toEqual([26, 20, 18, -37]);
    ring.column(1.15, 1.3, column);
    expect([column.state, column.chatter_hz]).toEqual(['blind', NaN]);
    ring.column(1.2, 1.4, column);
    expect(column.known).toBe(false);
    expect([ring.peakSince(0), ring.peakSince(1.15), ring.peakSince(2)]).toEqual([26, 20, noLevel]);
  });
  it('lets a frame stand for the second before it, and no longer', () => {
    const ring = new FrameRing(4);
    ring.push(at(10));
    ring.push(at(11, { peak_db: null, spectrum: null }));
    ring.push(at(11.1));
    const column = emptyColumn(4);
    ring.column(9, 9.1, column);
    expect([column.known, column.levels[1]]).toEqual([true, 20]);
    ring.column(10.1, 10.2, column); // its spectrum is that of the frame after it
    expect([column.known, column.levels[1]]).toEqual([true, 20]);
    ring.column(8, 8.1, column);
    expect(column.known).toBe(false);
  });
});

describe('the picture', () => {
  it('has a colour a decibel, from the panel to the end of the scale', () => {
    for (const theme of [light, dark]) {
      const colours = palette(theme);
      expect(colours).toHaveLength(deepest_db + 1);
      expect(colours[0]).toEqual(rgb(theme.panel));
      expect(colours[deepest_db]).toEqual(rgb(theme.scale[theme.scale.length - 1]![1]));
    }
  });
  it('moves its scale in steps and not with every frame', () => {
    expect(referenceFor(23, null)).toBe(25);
    expect([25, 21, 16].map((peak) => referenceFor(peak, 25))).toEqual([25, 25, 25]);
    expect(referenceFor(26, 25)).toBe(30);
    expect(referenceFor(15, 25)).toBe(15);
    expect(referenceFor(noLevel, 25)).toBe(25);
  });
  it('gives each row its bands, the highest on top', () => {
    const rows = rowBands(edges_hz, 1000, 4);
    expect(rows).toEqual([[2, 3], [1, 3], [0, 2], [0, 1]]);
  });
  it('is in the colour of the panel before the first frame', () => {
    vi.stubGlobal('ImageData', class {});
    const filled: unknown[] = [];
    const canvas = () => {
      const context = { fillStyle: '', fillRect: (...area: number[]) => void filled.push([context.fillStyle, ...area]) };
      return { clientWidth: 300, width: 0, height: 0, getContext: () => context } as unknown as HTMLCanvasElement;
    };
    const scroller = new Scroller(new FrameRing(4), [canvas(), canvas()], { edges_hz, teeth: 2, highest_hz: 1000, span_s: 60 });
    scroller.restart(dark);
    scroller.draw(dark);
    vi.unstubAllGlobals();
    expect(filled).toEqual([[dark.panel, 0, 0, 300, 260], [dark.panel, 0, 0, 300, 48]]);
  });
  it('marks tooth passing, or the rotation', () => {
    expect(cutLines(3000, 2, 450)).toEqual([100, 200, 300, 400]);
    expect(cutLines(3000, null, 450)).toEqual([50, 100, 150]);
    expect(cutLines(NaN, 2, 450)).toEqual([]);
    expect(cutLines(3000, 2, 1e5)).toHaveLength(12);
  });
  it('paints a column: the loudest band, marks, and the score over the state', () => {
    const ring = new FrameRing(4);
    ring.push(at(0.1, { ...chatter, clock_s: 0.1, spectrum: 'AA_A' }));
    const painter = new Painter(ring, { edges_hz, teeth: 2, highest_hz: 1000, span_s: 60, theme: light }, 100, 20, 0.1);
    painter.reference_db = 20;
    const [upper, lower] = [new Uint8ClampedArray(400), new Uint8ClampedArray(80)];
    const pixel = (of: Uint8ClampedArray, line: number) => [...of.slice(4 * line, 4 * line + 3)];
    painter.paint(0, upper, lower);
    expect(pixel(upper, 20)).toEqual(rgb(light.scale[4]![1])); // 800 Hz
    expect(pixel(upper, 99)).toEqual(rgb(light.panel)); // 63 dB below
    expect(pixel(upper, 31)).toEqual(rgb(light.chatter)); // 683 Hz
    expect(pixel(lower, 10)).toEqual(rgb(light.chatter)); // the threshold
    expect(pixel(lower, 19)).toEqual(rgb(light.text));
    expect(pixel(lower, 6)).toEqual(rgb(light.text)); // three times the threshold: three quarters
    expect(pixel(lower, 3)).not.toEqual(rgb(light.text));
    expect(painter.pixelAt(6000.05)).toBe(60_000);
  });
  it('reaches the middle of the strip at the threshold, whatever the score', () => {
    expect([0, 1, 3, Infinity, NaN].map(scoreHeight)).toEqual([0, 0.5, 0.75, 1, 0]);
  });
  it('has round ticks', () => {
    expect(ticks(2000, 6)).toEqual([0, 500, 1000, 1500, 2000]);
    expect(ticks(5115, 6)).toEqual([0, 1000, 2000, 3000, 4000, 5000]);
    expect(renderToString(<FrequencyAxis highest_hz={2000} />)).toContain('bottom:25%');
    expect(highestChoices([5, 5115])).toEqual([200, 500, 1000, 2000, 5115]);
    expect([null, 683, 3000, 9000].map((hz) => highestFor([200, 2000, 5000, 9995], hz))).toEqual([2000, 2000, 5000, 9995]);
  });
});

describe('the history', () => {
  it('takes what changed, the newest first, and forgets the oldest', () => {
    const rows = withRows([{ ...row, to_s: null }], [{ ...row, number: 8 }, row]);
    expect(rows.map(({ number, to_s }) => [number, to_s])).toEqual([[8, 3663.5], [7, 3663.5]]);
    let all: MonitorRow[] = [];
    for (let number = 1; number <= 1200; ++number) all = withRows(all, [{ ...row, number }]);
    expect([all.length, all[0]!.number, all[499]!.number]).toEqual([500, 1200, 701]);
    expect(withRows(all, [])).toBe(all);
  });
  it('says what was, and what befell the input', () => {
    const notice: MonitorRow = { ...row, number: 8, kind: 'notice', what: 'lost-blocks', message: 'blocks of the stream never came', count: 3, chatter_frequency_hz: null };
    const html = renderToString(<HistoryTable rows={[notice, row]} summary={summary} />);
    for (const part of ['1:01:01.3', '2.25', '683.20', 'mode\u00a08', '5000', 'blocks of the stream never came (3 times)', 'class="chatter"']) expect(html).toContain(part);
    expect(rowNote({ ...row, no_speed: 'arm' })).toContain('a mode of the arm');
    expect(renderToString(<HistoryTable rows={[{ ...row, to_s: null }]} summary={summary} />)).toContain('lasts');
    expect(beganText(row, { speed: null, started: 'x' })).toBe('0:12.0');
    expect([0, 59.96, 61.2, 28_799.9].map(timeText)).toEqual(['0:00.0', '1:00.0', '1:01.2', '7:59:59.9']);
  });
});

const file = (path: string, kind: FileEntry['kind']): FileEntry => ({ path, kind, bytes: 1, modified: '' });
const folder: FolderState = { version: '', folder: 'shop', files: [file('a/monitor.toml', 'monitor'), file('cut.wav', 'record'), file('events.jsonl', 'record')], files_left_out: 0, record_endings: ['.csv', '.tdms'], jobs: [] };

function shown(view: ComponentChildren, files = folder.files): string {
  const nothing = () => {};
  return renderToString(
    <ServeContext value={{ api: openApi({ token: '' }), folder: { ...folder, files }, verbs: [], tap: null, tookTap: nothing, announce: nothing, refresh: nothing, take: nothing }}>
      {view}
    </ServeContext>,
  );
}

it('plays recordings, and the vibration of a simulated cut', () => {
  const files: FileEntry[] = [...folder.files, { ...file('vibration.csv', 'result'), document: 'vibration' }, { ...file('blocks.csv', 'result'), document: 'blocks' }];
  expect(playable(files).map(({ path }) => path)).toEqual(['cut.wav', 'vibration.csv']);
});

it('shows what was assumed and what its files say unusually', () => {
  const assumed = [{ what: 'Teeth', taken: '2', key: 'process.teeth', file: 'monitor.toml' }];
  const html = renderToString(<Basis assumed={assumed} warnings={['monitor.toml:8: is unusual']} />);
  for (const text of ['process.teeth', 'of monitor.toml', 'Before you trust it', 'monitor.toml:8: is unusual']) expect(html).toContain(text);
  expect(renderToString(<Basis assumed={[]} warnings={[]} />)).toBe('');
});

it('explains an alarm, and silence', () => {
  const cells = (html: string) => [...html.matchAll(/<td[^>]*>(.*?)<\/td>/g)].map(([, cell]) => cell);
  const alarm = renderToString(<Why why={why} alarm />);
  expect(alarm).toContain('<summary>by ratio, 6 of 6 hops</summary>');
  expect(cells(alarm)).toEqual([
    'energy beside the orders', '0.31', 'at least 0.2', 'yes',
    'above the quietest', '20.0 dB', 'at least 10.0 dB', 'yes',
    'movement of the order beside it', '0.01', 'at most 0.005', '<strong>no</strong>',
  ]);
  expect(renderToString(<HistoryTable rows={[{ ...row, why }, row]} summary={summary} />)).toContain('by ratio, 6 of 6 hops');
  expect(renderToString(<HistoryTable rows={[row]} summary={summary} />)).not.toContain('>Why<');
  const silent = renderToString(<Now summary={{ ...summary, why: { ...why, hops: 2 } }} />);
  expect(silent).toContain('closest: ratio, 2 of 6 hops, 2 of 3 conditions hold');
});

describe('the view', () => {
  it('names states by words and colours', () => {
    const spindles: MonitorSummary[] = [
      { ...summary, frame: chatter },
      { ...summary, id: 3, frame: at(1, { state: 'blind', reason: 'no-signal' }) },
      { ...summary, id: 4, status: 'failed', error: { text: 'no connection', file: null, line: null, field: null, value: null, unit: null, rule: null, hint: null } },
    ];
    const html = renderToString(<Spindles spindles={spindles} selected={2} ending={new Set([3])} stop={() => {}} />);
    for (const part of ['state-badge chatter">chatter<', 'state-badge blind">undetermined: no usable signal<', '>failed<', 'aria-current="true"', 'aria-label="Stop Spindle 3: cut.wav"', 'aria-label="Remove Spindle 4: cut.wav"', 'href="#/monitor/3"']) {
      expect(html).toContain(part);
    }
    expect(html).toMatch(/<button[^>]*disabled[^>]*aria-label="Stop Spindle 3/);
    expect(html.match(/ disabled/g)).toHaveLength(1);
    expect(renderToString(<Now summary={spindles[2]!} />)).toContain('no connection');
    expect([{ status: 'starting' as const }, { status: 'done' as const }, { status: 'running' as const, frame: null }].map((one) => statusText({ frame: quiet, ...one }))).toEqual(['starting', 'ended', 'no samples yet']);
  });
  it('ends a spindle once, a running one after a question, and none by the second click of a double click', () => {
    const none = new Set<number>();
    expect(stopAction(summary, none, Infinity)).toBe('ask');
    expect(stopAction({ ...summary, status: 'done' }, none, Infinity)).toBe('end');
    expect(stopAction({ ...summary, status: 'done' }, new Set([2]), Infinity)).toBe('nothing');
    expect([stopAction({ ...summary, id: 3 }, none, 120), stopAction({ ...summary, status: 'done' }, none, 120)]).toEqual(['nothing', 'nothing']);
    const ids = new Set([2, 3]);
    expect(stillThere(ids, [{ id: 1 }, { id: 2 }, { id: 3 }])).toBe(ids);
    expect([...stillThere(ids, [{ id: 3 }])]).toEqual([3]);
  });
  it('says speed, suggestion, frequency and mode', () => {
    const html = renderToString(<Now summary={{ ...summary, frame: chatter }} />);
    for (const part of ['3000', '5000', '683.2', 'mode 8', '180 µs', '50.0 of 50.0 ×', 'samples lost, 2.50 s', '2 blocks of the stream']) expect(html).toContain(part);
    expect(renderToString(<Now summary={{ ...summary, frame: { ...chatter, suggested_spindle_speed_rpm: null, no_speed: 'arm' } }} />)).toContain('no spindle speed avoids it');
    expect(factsOf({ ...summary, speed: null }).map(({ label }) => label)).not.toContain('Pace');
    const said = factsOf({ ...summary, speed: null, dropped_hops: 3 }).map(({ label, value }) => `${label}: ${value}`);
    expect(said).toEqual(expect.arrayContaining(['Monitored for: 0:05.0', 'Undetermined: samples lost, 2.50 s', 'Lost: 2 blocks of the stream, 3 hops (samples came faster than they are processed)']));
    expect(factsOf({ ...summary, frame: null })).toHaveLength(1);
  });
  it('follows what is said of a spindle', () => {
    const message: MonitorMessage = { id: 2, frame: chatter, why, alarms: [row], alarm_count: 4, decision_count: 401, dropped_hops: 0, lost_blocks: 2, blind_s: {} };
    expect(withMessage(summary, message)).toMatchObject({ frame: chatter, why, alarm_count: 4, input: 'cut.wav' });
    expect(withMessage(summary, message)).not.toHaveProperty('alarms');
    expect(withMessage({ ...summary, frame: at(9) }, message).frame!.clock_s).toBe(9); // an old one
    expect(withMessage(summary, undefined)).toBe(summary);
  });
  it('tells who cannot see it what changed', () => {
    const name = nameOf(summary);
    expect(newsText(name, 'stable', chatter)).toMatch(/^Spindle 2: cut.wav: chatter at 683.20.*Hz, mode 8$/);
    expect(newsText(name, 'chatter', quiet)).toBe('Spindle 2: cut.wav: stable');
    expect(newsText(name, undefined, quiet)).toBeNull();
  });
  it('tells chatter before all else, of each spindle the newest', () => {
    const news = new News();
    const rest = () => Array.from({ length: 9 }, () => news.next()).filter((text) => text !== null);
    for (const [id, frame] of [[1, quiet], [2, quiet], [3, chatter]] as const) news.take(id, `${id}`, frame);
    expect(rest()).toEqual([expect.stringMatching(/^3: chatter/)]);
    news.take(2, '2', at(1, { state: 'blind', reason: 'gap' }));
    news.take(1, '1', chatter);
    news.take(3, '3', quiet);
    news.take(2, '2', quiet);
    news.take(1, '1', quiet); // chatter that is over is told all the same
    expect(rest()).toEqual([expect.stringMatching(/^1: chatter/), '2: stable', '1: stable', '3: stable']);
  });
  it('does not tell chatter again that comes and goes by transitions', () => {
    const news = new News();
    for (let i = 0; i < 20; ++i) news.take(1, '1', i % 2 === 0 ? chatter : at(i, { state: 'transition' }));
    expect([news.next(), news.next()]).toEqual([expect.stringMatching(/^1: chatter/), null]);
    news.take(1, '1', quiet);
    news.take(1, '1', chatter);
    expect([news.next(), news.next()]).toEqual([expect.stringMatching(/^1: chatter/), null]);
    news.take(1, '1', quiet);
    news.forget(1);
    expect(news.next()).toBeNull();
  });
  it('begins with settings and a recording, or a stream', () => {
    const html = shown(<MonitorView path="" feed={new MonitorFeed()} />);
    for (const part of ['<h1', 'a/monitor.toml', 'cut.wav', 'a stream of a broker', 'max="50"', 'type="submit"']) expect(html).toContain(part);
    expect(html).not.toContain('events.jsonl');
    expect(shown(<StartMonitor path="" />, [file('a/monitor.toml', 'monitor')])).toContain('mqtt://HOST/TOPIC');
    expect(shown(<StartMonitor path="" />, [])).toContain('robomill init monitor');
    expect(playable(folder.files).map(({ path }) => path)).toEqual(['cut.wav']);
  });
  it('hears of nothing after it was left', () => {
    const feed = new MonitorFeed();
    const heard: number[] = [];
    const leave = feed.messages.listen(({ id }) => heard.push(id));
    feed.messages.say({ id: 1 } as MonitorMessage);
    leave();
    feed.messages.say({ id: 2 } as MonitorMessage);
    expect(heard).toEqual([1]);
  });
});
