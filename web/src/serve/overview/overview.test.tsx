// The overview of a job as text, and where dropped files go.
import type { ComponentChildren } from 'preact';
import { renderToString } from 'preact-render-to-string';
import { describe, expect, it, vi } from 'vitest';
import { ApiError, faultOf, openApi } from '../api';
import { Bar } from '../app';
import { ServeContext, type Serve } from '../context';
import type { FileEntry, FolderState, Job } from '../documents';
import { parseRoute } from '../route';
import { belongsTo, folderFor, keyFor, pathFrom } from './belongs';
import { chosenJob, OverviewsContext, type Overviews } from './chosen';
import type { Overview, Stage, StageName } from './documents';
import { OverviewView } from './overview';
import { jobFiles, nextText, pathIn, stateWords } from './stages';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

const names: StageName[] = ['hits', 'frfs', 'modes', 'cut', 'lobes', 'robot', 'program', 'decision', 'monitor'];

function overview(file: string, some: Partial<Record<StageName, Partial<Stage>>> = {}, more: Partial<Overview> = {}): Overview {
  const stages = names.map((stage): Stage => ({ stage, state: 'unused', says: '', file: null, guesses: 0, error: null, newer: null, next: null, ...some[stage] }));
  return { file, title: '', error: null, results: null, names: [], stages, next: null, ...more };
}

const missing = { ...faultOf('job.toml:12: tool.teeth is missing'), file: 'job.toml', line: 12, field: 'tool.teeth', rule: 'is missing' };
const job = overview(
  'a/job.toml',
  {
    hits: { state: 'done', says: '3 of 5 hits good', file: 'a/hits.toml', next: { does: 'tap', file: 'a/hits.toml', line: null } },
    frfs: { state: 'outdated', says: 'xx good', newer: { file: 'a/hits.toml', since: '2026-11-27T18:57:00Z' }, next: { does: 'run', file: null, line: null } },
    cut: { state: 'missing', file: 'a/job.toml', error: missing, next: { does: 'edit', file: 'a/job.toml', line: 12 } },
    lobes: { state: 'waiting', says: 'needs cut' },
    robot: { state: 'guessed', file: 'cell.toml', guesses: 2, next: { does: 'edit', file: 'cell.toml', line: 4 } },
    decision: { state: 'unreached', says: 'no safe depth', next: { does: 'report', file: null, line: null } },
    monitor: { state: 'given', file: 'a/monitor.toml', next: { does: 'monitor', file: 'a/monitor.toml', line: null } },
  },
  { title: 'A bracket', next: 'cut', results: 'a/out', names: ['hits'] },
);

const entry = (path: string, kind: FileEntry['kind']): FileEntry => ({ path, kind, bytes: 9, modified: '2026-11-27T18:57:00Z' });
const run: Job = { id: 4, verb: 'plan', input: 'a/job.toml', output: 'a/out', state: 'done', exit: 3, task: '', fraction: 1, seconds: 2, error: null, summary: null, report: true };
const folder: FolderState = { version: '', folder: 'shop', files: [entry('a/job.toml', 'job'), entry('z.toml', 'job'), entry('a/hits.toml', 'hits')], files_left_out: 0, record_endings: ['.csv', '.tdms'], jobs: [run] };

function shown(view: ComponentChildren, known: Overviews, some: Partial<FolderState> = {}): string {
  const nothing = () => {};
  const serve: Serve = { api: openApi({ token: '' }), folder: { ...folder, ...some }, verbs: [], tap: null, tookTap: nothing, announce: nothing, refresh: nothing, take: nothing };
  return renderToString(
    <ServeContext value={serve}>
      <OverviewsContext value={known}>{view}</OverviewsContext>
    </ServeContext>,
  );
}

describe('overview of a job', () => {
  const html = shown(<OverviewView path="a/job.toml" />, new Map([['a/job.toml', job]]));
  it('has each stage with its state in words, its number and its next step', () => {
    for (const part of ['<h1 tabindex="-1">A bracket</h1>', '3 of 5 hits good', '<span class="grade poor">missing</span>', 'a/hits.toml changed', 'needs cut', '2 values are samples or guesses', 'no safe depth']) expect(html).toContain(part);
    expect(html.match(/<tr/g)).toHaveLength(1 + names.length);
    for (const { word } of Object.values(stateWords)) expect(word).not.toBe('');
  });
  it('leads to where a stage is worked on', () => {
    for (const part of [
      'href="#/job/a/job.toml" aria-label="Cut: Fill in tool.teeth, line 12 of a/job.toml"',
      'href="#/tap/a/hits.toml" aria-label="Hits: Tap test"',
      'href="#/job/cell.toml" aria-label="Robot: Check line 4 of cell.toml"',
      'href="#/jobs/4" aria-label="Decision: Report"',
      'href="#/monitor/a/monitor.toml"',
      'aria-label="Run the plan: FRFs"',
      '<a href="#/overview">All jobs</a>',
    ]) expect(html).toContain(part);
    expect(html).toContain('class="step main" href="#/job/a/job.toml"');
  });
  it('says what is wrong with a job that cannot be read', () => {
    const error = { ...faultOf('z.toml:1: is no TOML'), file: 'z.toml', line: 1 };
    const broken = shown(<OverviewView path="z.toml" />, new Map([['z.toml', overview('z.toml', {}, { error })]]));
    for (const part of ['role="alert"', 'z.toml:1: is no TOML', 'Correct line 1 of z.toml']) expect(broken).toContain(part);
    expect(shown(<OverviewView path="z.toml" />, new Map([['z.toml', new ApiError(500, faultOf('its process ended'))]]))).toContain('its process ended');
    expect(shown(<OverviewView path="none.toml" />, new Map())).toContain('There is no such job');
  });
  it('is the only job, or a list of several, or how to begin', () => {
    const one = [entry('a/job.toml', 'job')];
    expect(shown(<OverviewView path="" />, new Map([['a/job.toml', job]]), { files: one })).toContain('A bracket');
    const list = shown(<OverviewView path="" />, new Map([['a/job.toml', job]]));
    for (const part of ['href="#/overview/a/job.toml"', 'href="#/overview/z.toml"', 'A bracket', '3 of 5 hits good', 'Cut: missing', 'loading']) expect(list).toContain(part);
    expect(shown(<OverviewView path="" />, new Map(), { files: [] })).toContain('robomill init job -o job.toml');
  });
});

describe('the chosen job', () => {
  it('is that of the address, else the one before, else the only one', () => {
    const at = (hash: string) => parseRoute(hash);
    expect(chosenJob(at('#/overview/b.toml'), 'a.toml', ['a.toml'])).toBe('b.toml');
    expect(chosenJob(at('#/lobes/x.toml'), 'a.toml', ['a.toml', 'b.toml'])).toBe('a.toml');
    expect(chosenJob(at('#/files'), 'gone.toml', ['a.toml'])).toBe('a.toml');
    expect(chosenJob(at(''), null, ['a.toml', 'b.toml'])).toBeNull();
  });
  it('gives the other views their files', () => {
    const cut = (file: string) => ({ cut: { state: 'given' as const, file }, lobes: { state: 'ready' as const } });
    const [mine, other] = [overview('a.toml', cut('lobes.toml')), overview('b.toml', cut('lobes.toml'))];
    expect(pathIn('lobes', mine, [mine])).toBe('lobes.toml');
    expect(pathIn('lobes', mine, [mine, other])).toBe('a.toml'); // the cut of several has no structure
    expect(pathIn('lobes', job)).toBe('');
    expect([pathIn('tap', job), pathIn('monitor', job), pathIn('program', job), pathIn('files', job), pathIn('tap', null)]).toEqual(['a/hits.toml', 'a/monitor.toml', 'a/job.toml', '', '']);
    const bar = renderToString(<Bar folder="shop" view="overview" pathOf={(view) => pathIn(view, job)} />);
    for (const part of ['href="#/overview" aria-current="page">Job', 'href="#/tap/a/hits.toml"', 'href="#/program/a/job.toml"', 'href="#/files"']) expect(bar).toContain(part);
  });
  it('comes from the jobs of the folder, upper ones first', () => {
    expect(jobFiles(folder)).toEqual(['z.toml', 'a/job.toml']);
    expect(jobFiles(null)).toEqual([]);
    expect([nextText(job), nextText(overview('x'))]).toEqual(['Cut: missing', 'Nothing is left to do']);
  });
});

describe('dropped files', () => {
  it('go beside hits.toml or the job', () => {
    const apart = overview('job.toml', { hits: { state: 'given', file: 'taps/hits.toml' } });
    const place = (name: string, of = apart) => folderFor(name, of, folder.record_endings);
    expect([place('x_1.CSV'), place('x_1.tdms'), place('part.ngc'), place('x_1.csv', overview('a/job.toml'))]).toEqual(['taps/', 'taps/', '', 'a/']);
  });
  it('are named in the job where it has nothing in their place', () => {
    const blank = overview('job.toml');
    expect([keyFor('program', blank), keyFor('cell', blank), keyFor('modes', blank), keyFor('lobes', blank), keyFor('record', blank)]).toEqual(['program', 'cell', 'modes', null, null]);
    expect(keyFor('program', { ...blank, names: ['program'] })).toBeNull();
    expect(keyFor('modes', { ...blank, names: ['hits'] })).toBeNull();
    expect(keyFor('cell', job)).toBeNull(); // the job has an arm
  });
  it('are named by their path from the job', () => {
    expect([pathFrom('job.toml', 'part.ngc'), pathFrom('a/job.toml', 'a/part.ngc'), pathFrom('a/b/job.toml', 'a/c/part.ngc')]).toEqual(['part.ngc', 'part.ngc', '../c/part.ngc']);
  });
  it('are written into the job over the state that was read, the first of several', async () => {
    const sent: [string, string][] = [];
    const send = async (path: string, { method, body, headers }: RequestInit) => {
      sent.push([`${method} ${path}`, String(body ?? '')]);
      if (path === '/api/edit') return Response.json({ text: 'edited' });
      if (method === 'PUT') expect((headers as Record<string, string>)['If-Match']).toBe('"7"');
      return method === 'PUT' ? Response.json({ etag: '"8"' }) : new Response('[job]', { headers: { ETag: '"7"' } });
    };
    const belongs = belongsTo(openApi({ token: '' }, send), overview('a/job.toml'), folder.record_endings);
    expect(await belongs.settle('a/part.ngc', 'program')).toBe('a/job.toml names it now as job.program');
    expect(await belongs.settle('a/other.ngc', 'program')).toBeNull();
    expect(sent.map(([request]) => request)).toEqual(['GET /api/file?path=a%2Fjob.toml', 'POST /api/edit', 'PUT /api/file?path=a%2Fjob.toml']);
    expect(JSON.parse(sent[1]![1])).toEqual({ text: '[job]', key: 'job.program', value: 'part.ngc' });
  });
});
