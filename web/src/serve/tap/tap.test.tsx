// The tap test: hits over each other, left out by hand, out of a stream, saved.
import { renderToString } from 'preact-render-to-string';
import { describe, expect, it, vi } from 'vitest';
import { light } from '../../figures/theme';
import { openApi } from '../api';
import { ServeContext, type Serve } from '../context';
import type { FolderState, Tap, TapHit, TapHitCurves, TapStream } from '../documents';
import { withStream } from '../later';
import { TapShown, withEarlier } from './tap';
import { HitsTable, loadCurves, overlaid } from './hits';
import { frfNames, hitFrfFigure, pulseRange, timeFigure, timeNames } from './overlay';
import { acceptedOf, besideSettings, unsavedText } from './save';
import { requestOf } from './start';
import { streamText } from './stream';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

const row = (number: number, more: Partial<TapHit> = {}): TapHit => ({ number, file: `hit ${number}`, accepted: true, excluded: false, reasons: [], force_direction: 'x', peak_force_n: 100, ...more });
const curves = (number: number, more: Partial<TapHitCurves> = {}): TapHitCurves => ({
  ...row(number),
  force: { time_s: [-1e-3, -1e-4, 0, 1e-4, 1e-3], values: [0, 60, 100, 60, 0] },
  responses: { x: { time_s: [0, 1], values: [1, null] } },
  frf: { frequency_hz: [10, 200, 1000], magnitude_m_per_n: { xx: [1e-7, 1e-5, 1e-8], yx: [1e-8, 1e-8, 1e-8] } },
  ...more,
});
const stream: TapStream = { address: 'mqtt://cell/hammer', status: 'receiving', error: null, sample_rate_hz: 8192, record_s: 0.5, level_n: 12.34, recording: false, triggered: 1, discarded: [], notices: [] };
const tap: Tap = { id: 2, revision: 1, hits: 'a/hits.toml', stream, force_direction: '3x', running: true, good: 1, wanted: 5, taken: [row(1), row(2, { accepted: false, reasons: ['double hit'] })], frf: null, peaks: [] };

function shown(view: preact.ComponentChildren): string {
  const nothing = () => {};
  const folder: FolderState = { version: '', folder: '', files: [], files_left_out: 0, record_endings: ['.csv', '.tdms'], jobs: [] };
  const serve: Serve = { api: openApi({ token: '' }), folder, verbs: [], tap, tookTap: nothing, announce: nothing, refresh: nothing, take: nothing };
  return renderToString(<ServeContext value={serve}>{view}</ServeContext>);
}

describe('overlay of hits', () => {
  const taken = [row(1), row(2, { accepted: false, reasons: ['double hit'] }), row(3, { accepted: false, excluded: true }), row(4)];
  const all = [1, 2, 3, 4].map((number) => curves(number));
  it('draws used hits, the newest on top, others only where asked for', () => {
    expect(overlaid(all, taken, false).map(({ hit }) => hit.number)).toEqual([1, 4]);
    expect(overlaid(all, taken, true).map(({ used, newest }) => [used, newest])).toEqual([[true, false], [false, false], [false, false], [true, true]]);
    // The newest is drawn even where it was rejected; one that could not be read has nothing to draw.
    expect(overlaid(all, taken.slice(0, 3), false).map(({ hit }) => hit.number)).toEqual([1, 3]);
    const { force, ...unread } = curves(1);
    expect(force).toBeDefined();
    expect(overlaid([unread], taken, true)).toEqual([]);
  });
  it('makes three traces of any number of hits, parted by gaps', () => {
    const many = Array.from({ length: 200 }, (_, i) => curves(i + 1));
    const rows = many.map(({ number }) => row(number, { accepted: number % 2 === 0 }));
    const figure = timeFigure(overlaid(many, rows, true), 'force', false, light);
    expect(figure.data.map(({ name }) => name)).toEqual(['used', 'not used', 'newest']);
    const [used, unused, newest] = figure.data as { x: (number | null)[]; y: (number | null)[]; customdata: number[]; line: { dash?: string; width: number } }[];
    expect(used!.x).toHaveLength(99 * 6);
    expect(used!.x.filter((x) => x === null)).toHaveLength(99);
    expect(used!.customdata).toHaveLength(used!.x.length);
    expect(used!.y[2]).toBe(100);
    expect(unused!.line.dash).toBeDefined();
    expect(newest!.customdata[0]).toBe(200);
    expect(newest!.line.width).toBeGreaterThan(used!.line.width);
    expect(newest!.x[1]).toBeCloseTo(-0.1, 12); // ms
  });
  it('shows the pulse alone', () => {
    const [from, to] = pulseRange(all[0]!.force)!;
    expect(from).toBeCloseTo(-0.6, 9);
    expect(to).toBeCloseTo(1.6, 9);
    expect(pulseRange(undefined)).toBeNull();
    expect(pulseRange({ time_s: [0], values: [null] })).toBeNull();
    const drawn = timeFigure(overlaid(all, taken, false), 'force', true, light);
    expect((drawn.layout['xaxis'] as { range: number[] }).range[0]).toBeCloseTo(-0.6, 9);
  });
  it('draws responses and own FRFs where there are any', () => {
    const some = [curves(1), curves(2, { frf: null })];
    expect(timeNames(some)).toEqual(['force', 'x']);
    expect(frfNames(some)).toEqual(['xx', 'yx']);
    const drawn = overlaid(some, [row(1), row(2, { accepted: false })], true);
    const frf = hitFrfFigure(drawn, 'yx', true, light);
    expect(frf.data).toHaveLength(1);
    expect((frf.layout['xaxis'] as { type: string }).type).toBe('log');
    expect(timeFigure(drawn, 'x', true, light).data).toHaveLength(2);
    // In the unit of the average.
    const [trace] = frf.data as { y: (number | null)[]; hovertemplate: string }[];
    expect([trace!.y.slice(0, 2), trace!.hovertemplate.includes('µm/N')]).toEqual([[expect.closeTo(0.01, 9), expect.closeTo(0.01, 9)], true]);
    expect(JSON.stringify(frf.layout)).toContain('|yx| (µm/N)');
    expect(JSON.stringify(timeFigure(drawn, 'x', true, light).layout)).toContain('Response in x (as recorded)');
  });
  it('asks for each hit once', async () => {
    const asked: number[] = [];
    const got: number[] = [];
    const api = { tapHit: (number: number) => (asked.push(number), Promise.resolve(curves(number))) };
    await loadCurves(api, 2, 19, (hits) => got.push(...hits.map(({ number }) => number)), new AbortController().signal);
    expect(asked).toEqual(Array.from({ length: 17 }, (_, i) => i + 3));
    expect(got).toEqual(asked);
    const ended = new AbortController();
    ended.abort();
    await loadCurves(api, 0, 3, () => expect.unreachable(), ended.signal);
  });
});

describe('a hit by hand', () => {
  it('is left out and used again, but not one that was rejected by itself', () => {
    const html = renderToString(<HitsTable busy={false} taken={[row(1), row(2, { accepted: false, reasons: ['double hit'] }), row(3, { accepted: false, excluded: true })]} accept={() => {}} />);
    for (const part of ['aria-label="Leave out hit 1"', 'aria-label="Use hit 3"', 'left out by hand', 'double hit']) expect(html).toContain(part);
    expect(html).not.toContain('hit 2"');
    expect(renderToString(<HitsTable busy={false} taken={[row(1)]} />)).not.toContain('button');
  });
  it('is sent as such', async () => {
    const sent: unknown[] = [];
    const api = openApi({ token: 't' }, (path, { method, body, headers }) => {
      sent.push([method, path, JSON.parse(body as string), (headers as Record<string, string>)['X-Robomill-Token']]);
      return Promise.resolve(new Response('{}'));
    });
    await api.acceptHit(3, false);
    await api.turnTap('-y');
    await api.saveTap('tip.uff', true);
    expect(sent).toEqual([
      ['PUT', '/api/tap/3', { accepted: false }, 't'],
      ['PUT', '/api/tap', { force_direction: '-y' }, 't'],
      ['POST', '/api/tap/save', { path: 'tip.uff', replace: true }, 't'],
    ]);
  });
});

it('keeps averages of fewer hits alone, each once', () => {
  const of = (...counts: number[]) => counts.map((hits) => ({ hits, frfs: [] }));
  expect(withEarlier(of(1, 2), of(3)[0]!, 4)).toEqual(of(1, 2, 3));
  expect(withEarlier(of(1, 2, 3), of(4)[0]!, 3)).toEqual(of(1, 2));
  expect(withEarlier(of(1, 2), of(2)[0]!, 3)).toEqual(of(1, 2));
  expect(withEarlier(of(1, 2), null, 0)).toEqual([]);
  expect(withEarlier(of(1, 2, 3, 4, 5, 6), of(7)[0]!, 8)).toEqual(of(2, 3, 4, 5, 6, 7));
});

describe('hits out of a stream', () => {
  it('says what to do now', () => {
    expect(streamText(stream)).toContain('hit now. A force beyond 12.3 N');
    expect(streamText({ ...stream, recording: true })).toContain('keep still');
    expect(streamText({ ...stream, level_n: null })).toContain('wait');
    expect(streamText({ ...stream, status: 'silent' })).toContain('No samples');
    expect(streamText({ ...stream, status: 'failed' })).toContain('ended');
    expect(streamText({ ...stream, status: 'connecting' })).toContain('mqtt://cell/hammer');
  });
  it('shows the direction, what was discarded and what befell it', () => {
    const told = { ...stream, discarded: [{ reason: 'samples were lost in it', count: 2 }], notices: [{ what: 'lost-blocks', count: 1, message: 'blocks never came' }] };
    const html = shown(<TapShown tap={{ ...tap, stream: told }} wrote={() => {}} />);
    for (const part of ['<option value="3x" selected', 'Direction of the hits that come', 'Discarded: samples were lost in it (2 times)', 'lost-blocks: blocks never came', 'data-panel="tap-save"', 'value="a/tip.uff"']) expect(html).toContain(part);
    expect(shown(<TapShown tap={{ ...tap, stream: null }} wrote={() => {}} />)).not.toContain('data-panel="tap-stream"');
  });
  it('takes what is said of the stream of this test alone', () => {
    const silent: TapStream = { ...stream, status: 'silent' };
    expect(withStream(tap, { id: 2, stream: silent })?.stream).toBe(silent);
    expect(withStream(tap, { id: 1, stream: silent })).toBe(tap);
    expect(withStream(null, { id: 2, stream: silent })).toBeNull();
  });
  it('asks for one source alone', () => {
    const form = { hits: 'hits.toml', source: 'files', watch: ' in ', stream: 'mqtt://a/b', direction: '-y', level: '20', wanted: '' };
    expect(requestOf(form)).toEqual({ hits: 'hits.toml', wanted: 0, watch: 'in' });
    expect(requestOf({ ...form, source: 'stream' })).toEqual({ hits: 'hits.toml', wanted: 0, stream: 'mqtt://a/b', force_direction: '-y', trigger_level_n: 20 });
  });
  it('asks before accepted hits are lost, unless just these were saved', () => {
    const saved = acceptedOf(tap);
    expect(unsavedText(tap, null)).toBe('The accepted hit is not saved and will be lost.');
    expect(unsavedText(tap, saved)).toBeNull();
    expect(unsavedText({ ...tap, id: 3 }, saved)).not.toBeNull();
    expect(unsavedText({ ...tap, taken: [...tap.taken, row(3)] }, saved)).toBe('The 2 accepted hits are not saved and will be lost.');
    expect(unsavedText({ ...tap, taken: [...tap.taken, row(3, { accepted: false })] }, saved)).toBeNull();
    expect(unsavedText({ ...tap, taken: [row(1, { accepted: false, excluded: true })] }, null)).toBeNull();
  });
  it('saves beside the settings', () => {
    expect(besideSettings('a/b/hits.toml', 'tip.uff')).toBe('a/b/tip.uff');
    expect(besideSettings('hits.toml', 'tip.uff')).toBe('tip.uff');
  });
});
