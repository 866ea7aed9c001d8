// The views of the application as text, and what they are made of.
import type { ComponentChildren } from 'preact';
import { renderToString } from 'preact-render-to-string';
import { describe, expect, it, vi } from 'vitest';
import { Page } from '../page';
import { sampleReport } from '../report_sample';
import { ApiError, faultOf, openApi } from './api';
import { Arrivals, FreeNames, receivedText, withArrival } from './files/arrivals';
import { Bar, follow, saidAfter, Trouble } from './app';
import { ServeContext, type Serve } from './context';
import type { Fault, FileEntry, FolderState, Job, Tap } from './documents';
import type { Entry } from './files/edited_file';
import { Editor, lineNumbers, lineRange } from './files/editor';
import { byKind, FilesTable, FilesView } from './files/files';
import { Form, showsFault } from './files/form';
import { freeName } from './files/hits_form';
import { JobsView } from './jobs/jobs';
import { laterTap, withFolder, withJob } from './later';
import { LobesView, PointPanel, resetAll } from './lobes/lobes';
import { faultText } from './pieces';
import { href, parseRoute } from './route';
import { Course, durationText, leftText, Outcome } from './jobs/running';
import { ModeSwitches, Slider } from './lobes/sliders';
import { countText, TapView } from './tap/tap';
import { writeChanges } from './lobes/write_back';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

const file = (path: string, kind: FileEntry['kind']): FileEntry => ({ path, kind, bytes: 1234, modified: '2026-11-25T22:00:00Z' });
const job: Job = { id: 1, verb: 'plan', input: 'job.toml', output: 'out', state: 'running', exit: null, task: 'stability lobes', fraction: 0.4, seconds: 12.1, error: null, summary: null, report: false };
const folder: FolderState = {
  version: '0.1.0',
  folder: 'shop',
  files: [file('lobes.toml', 'lobes'), file('a/hits.toml', 'hits'), file('job.toml', 'job'), file('x_1.csv', 'record'), file('part.ngc', 'program')],
  files_left_out: 2,
  record_endings: ['.csv'],
  jobs: [job],
};

function shown(view: ComponentChildren, more: Partial<Serve> = {}): string {
  const nothing = () => {};
  const serve: Serve = { api: openApi({ token: '' }), folder, verbs: [], tap: null, tookTap: nothing, announce: nothing, refresh: nothing, take: nothing, ...more };
  return renderToString(<ServeContext value={serve}>{view}</ServeContext>);
}

describe('route', () => {
  it.each(['overview', 'files', 'job', 'program', 'lobes', 'tap'] as const)('%s comes back from its address', (view) => {
    for (const path of ['', 'lobes.toml', 'a b/ü#1%.toml']) expect(parseRoute(href(view, path))).toEqual({ view, path });
  });
  it('is the overview for anything else', () => {
    for (const hash of ['', '#lobes', '#/nothing/x', '#/lobes-x']) expect(parseRoute(hash)).toEqual({ view: 'overview', path: '' });
    expect(parseRoute('#/job/50%.toml')).toEqual({ view: 'job', path: '50%.toml' });
  });
});

describe('files', () => {
  it('come by kind, jobs first', () => {
    expect(byKind(folder.files).map(({ path }) => path)).toEqual(['job.toml', 'a/hits.toml', 'lobes.toml', 'x_1.csv', 'part.ngc']);
    expect(byKind([file('a', 'of later' as 'other'), file('b', 'other')]).map(({ name, first }) => [name, first])).toEqual([['Other files', true], ['Other files', false]]);
  });
  it('say what can be done with each', () => {
    const html = renderToString(<FilesTable files={folder.files} verbs={[]} describe={() => {}} />);
    for (const part of ['href="#/lobes/lobes.toml" aria-label="Lobes: lobes.toml"', 'href="#/tap/a/hits.toml"', 'href="#/job/job.toml"', 'aria-label="What is it: x_1.csv"', '1.2 kB']) expect(html).toContain(part);
  });
  it('can be dropped, chosen, and may be too many', () => {
    const html = shown(<FilesView />);
    expect(html).toContain('type="file"');
    expect(html).toContain('2 more files are not listed');
    expect(shown(<FilesView />, { folder: { ...folder, files: [] } })).toContain('robomill init job');
  });
  it('that arrived are asked about', () => {
    const columns = [
      { name: 'ch1', unit: 'V', guess: 'force' as const },
      { name: 'ch2', unit: 'g', guess: 'response' as const },
    ];
    const inspection = { kind: 'record' as const, columns, rows: 4096, sample_rate_hz: 51200, direction_guess: 'y', questions: ['What is the sensitivity of the hammer?'], files: [], time: null };
    const html = shown(<Arrivals arrivals={[{ name: 'tap.csv', path: 'tap-2.csv', inspection, error: null }]} clear={() => {}} forms={new Map()} taken={['hits.toml']} />);
    for (const part of ['tap-2.csv since there is a tap.csv already', '4096 rows', 'What is the sensitivity of the hammer?', 'Sensitivity of the hammer (mV per N)', 'value="hits-2.toml"', 'The force is in volts']) expect(html).toContain(part);
    expect(html).toMatch(/<option value="y" selected/);
  });
  it('that are one hit together are asked about together', () => {
    const columns = [{ name: 'f', unit: 'N', guess: 'force' as const }, { name: 'a', unit: 'g', guess: 'response' as const }];
    const inspection = { kind: 'record' as const, columns, rows: 9, sample_rate_hz: 100, direction_guess: 'y', questions: [], files: ['f.txt', 'a.txt'], time: null };
    const alone = { ...inspection, columns: [columns[0]!], files: [] };
    const html = shown(<Arrivals arrivals={[{ name: 'f.txt', path: 'f.txt', inspection: alone, error: null }, { name: 'a.txt', path: 'a.txt', inspection, error: null }]} clear={() => {}} forms={new Map()} taken={[]} />);
    for (const part of ['; one hit with f.txt', 'A recording: f.txt + a.txt', '[&quot;f.txt&quot;, &quot;a.txt&quot;]']) expect(html.replaceAll('"f.txt"', '&quot;f.txt&quot;').replaceAll('"a.txt"', '&quot;a.txt&quot;')).toContain(part);
    expect(html.match(/data-panel="hits-form"/g)).toHaveLength(1);
  });
  it('keep their forms and answers while others are on their way', () => {
    const inspection = { kind: 'record' as const, columns: [{ name: 'f', unit: 'N', guess: 'force' as const }, { name: 'a', unit: 'g', guess: 'response' as const }], rows: 9, sample_rate_hz: 100, direction_guess: 'y', questions: [], files: [], time: null };
    const forms = new Map();
    const one = { name: 'a.csv', path: 'a.csv', inspection, error: null };
    const view = (arrivals: Parameters<typeof Arrivals>[0]['arrivals']) => shown(<Arrivals arrivals={arrivals} clear={() => {}} forms={forms} taken={[]} />);
    expect(view([one])).toContain('A recording: a.csv');
    const [columns, form] = [...forms][0]!;
    forms.set(columns, { ...form, answers: { ...form.answers, directions: { 'a.csv': '-z' } }, path: 'mine.toml' });
    const later = view([one, { name: 'b.csv', path: 'b.csv', inspection: null, error: null }, { ...one, name: 'c.csv', path: 'c.csv' }]);
    for (const part of ['on its way', '2 recordings with the same columns', 'value="mine.toml"', 'force_direction = &quot;-z&quot;', 'force_direction = &quot;y&quot;']) expect(later.replaceAll('"-z"', '&quot;-z&quot;').replaceAll('= "y"', '= &quot;y&quot;')).toContain(part);
  });
  it('keep what is known of a file that is looked at again', () => {
    const inspection = { kind: 'program' as const, columns: [], rows: null, sample_rate_hz: null, direction_guess: null, questions: [], files: [], time: null };
    const known = [{ name: 'a', path: 'a', inspection, error: null }, { name: 'b', path: 'b', inspection: null, error: new ApiError(500, faultOf('x')) }];
    expect(withArrival(known, 'a', 'a')).toEqual(known);
    expect(withArrival(known, 'b', 'b')[1]).toEqual({ name: 'b', path: 'b', inspection: null, error: null });
    expect(withArrival(known, 'c', 'c-2')).toHaveLength(3);
  });
  it('are counted as they were received', () => {
    expect([receivedText(1, 0), receivedText(2, 0), receivedText(2, 1), receivedText(0, 2)]).toEqual(['1 file received', '2 files received', '2 files received, 1 not', '2 files not received']);
  });
  it('do not take the name of one that is on its way', () => {
    const names = new FreeNames();
    expect([names.give('a.csv', []), names.give('a.csv', []), names.give('a.csv', ['a.csv'])]).toEqual(['a.csv', 'a-2.csv', 'a-3.csv']);
    names.back('a-2.csv');
    expect(names.give('a.csv', ['a.csv'])).toBe('a-2.csv');
    expect(names.give('a.csv', ['a-2.csv'])).toBe('a.csv'); // the first was deleted
  });
  it('get a name that is free', () => {
    expect(freeName('hits.toml', [])).toBe('hits.toml');
    expect(freeName('a.b/hits', ['a.b/hits', 'a.b/hits-2'])).toBe('a.b/hits-3');
  });
});

describe('form', () => {
  const fields = [
    { key: 'tool.teeth', value: 0, line: 2, comment: 'as many as it has' },
    { key: 'cut.radial_depth_mm', value: 1.8, line: 5, comment: null },
    { key: 'lobes.grid', value: [200, 100], line: 9, comment: null },
    { key: 'acquisition.force_window', value: true, line: 12, comment: null },
  ];
  const fault = { text: 'lobes.toml:2: tool.teeth = 0; must be >= 1', file: 'lobes.toml', line: 2, field: 'tool.teeth', value: '0', unit: null, rule: 'must be >= 1', hint: 'A cutter has teeth.' };
  const typing = (entries: [string, Entry][]) => ({ entries: new Map(entries), enter: () => {}, commit: () => {}, leave: () => {} });
  const untouched = typing([]);
  it('has a labelled control for each key, and its comment', () => {
    const html = renderToString(<Form fields={fields} fault={null} file="lobes.toml" typing={untouched} />);
    for (const part of ['<legend>Tool</legend>', 'for="field-tool.teeth"', ', millimetres', 'value="200, 100"', 'type="checkbox"', 'as many as it has', 'aria-describedby="field-tool.teeth-help"']) expect(html).toContain(part);
    expect(html).not.toContain('class="error"');
  });
  it('shows the error at its field, and at no other', () => {
    const html = renderToString(<Form fields={fields} fault={fault} file="lobes.toml" typing={untouched} />);
    expect(html.match(/class="error"/g)).toHaveLength(1);
    expect(html).toContain('id="field-tool.teeth-error">lobes.toml:2: tool.teeth = 0; must be >= 1. A cutter has teeth.');
    expect(html).toContain('aria-describedby="field-tool.teeth-error field-tool.teeth-help"');
    expect(showsFault(fields, fault, 'lobes.toml')).toBe(true);
    expect(showsFault(fields, { ...fault, field: 'tool.pitch_deg' }, 'lobes.toml')).toBe(false);
  });
  it('keeps what is typed, and says why it is not in the text', () => {
    const entries = typing([
      ['tool.teeth', { typed: 'four', wrong: 'A number is needed.', version: null }],
      ['acquisition.force_window', { typed: 'false', wrong: null, version: 3 }],
    ]);
    const html = renderToString(<Form fields={fields} fault={null} file="lobes.toml" typing={entries} />);
    for (const part of ['value="four"', 'id="field-tool.teeth-error">A number is needed.']) expect(html).toContain(part);
    expect(html).not.toContain('checked');
  });
  it('says a hint once', () => {
    expect(faultText({ ...fault, text: 'x. A cutter has teeth.' })).toBe('x. A cutter has teeth.');
  });
});

describe('editor', () => {
  const text = 'a\nbb\n\nd';
  it('numbers its lines and finds them', () => {
    expect(lineNumbers(text)).toBe('1\n2\n3\n4');
    expect([1, 2, 3, 4, 9].map((line) => text.slice(...lineRange(text, line)))).toEqual(['a', 'bb', '', 'd', 'd']);
  });
  it('marks the line of the error', () => {
    const html = renderToString(<Editor label="Text" text={text} type={() => {}} wrong={{ line: 2, text: 'x' }} jump={0} />);
    expect(html).toContain('top:20px');
    expect(html).toContain('aria-invalid="true"');
  });
});

describe('jobs', () => {
  it('say how far they are and what is left', () => {
    const html = shown(<Course job={job} />);
    for (const part of ['stability lobes', 'value="0.4"', '40 %', 'about 18 s left', 'Cancel']) expect(html).toContain(part);
    expect(leftText({ seconds: 1, fraction: 0.001 })).toBe('');
    expect([0.52, 59.6, 125, 3600, null].map(durationText)).toEqual(['0.5 s', '1 min', '2 min 5 s', '60 min', '–']);
  });
  it('say how they ended', () => {
    const failed = { ...job, state: 'failed' as const, error: { text: 'lobes.toml:3: bad', file: 'lobes.toml', line: 3, field: null, value: null, unit: null, rule: null, hint: null }, summary: 'what was done' };
    const html = renderToString(<Outcome job={failed} />);
    for (const part of ['lobes.toml:3: bad', 'href="#/job/lobes.toml"', '<pre>what was done</pre>', 'failed']) expect(html).toContain(part);
    const short = renderToString(<Outcome job={{ ...job, state: 'done', exit: 3, inputs: ['job.toml', 'b'], shortfall: 'the fit did not converge' }} />);
    for (const part of ['done, but the answer was not reached', 'The answer was not reached: the fit did not converge.', 'and 1 more']) expect(short).toContain(part);
  });
  it('may fail with a text alone', () => {
    expect(renderToString(<Outcome job={{ ...job, state: 'failed', error: { text: 'x' } as Fault }} />)).toContain('role="alert">x</p>');
  });
  it('are listed, one is shown', () => {
    expect(shown(<JobsView path="" />)).toContain('href="#/jobs/1"');
    expect(shown(<JobsView path="1" />)).toContain('data-panel="run"');
    expect(shown(<JobsView path="7" />)).toContain('There is no job 7');
  });
  it('show their report inside of the page', () => {
    const report = { ...sampleReport(), title: 'Plan' };
    const page = (within: boolean) => renderToString(<Page report={report} within={within} />);
    expect(page(true)).toContain('<section id="lobes"');
    expect(page(true)).not.toMatch(/<main|<h1|class="skip"/);
    expect(page(false)).toMatch(/class="skip".*<h1>Plan<\/h1>.*<main id="main">/);
  });
  it('take the place of what was known of them', () => {
    expect(withJob(folder, { ...job, fraction: 1 })!.jobs).toEqual([{ ...job, fraction: 1 }]);
    expect(withJob(folder, { ...job, id: 2 })!.jobs.map(({ id }) => id)).toEqual([1, 2]);
    expect(withJob(null, job)).toBeNull();
  });
  it('do not go back when an older answer comes late', () => {
    const done = { ...folder, jobs: [{ ...job, state: 'done' as const, fraction: 1 }] };
    expect(withFolder(done, folder).jobs[0]!.state).toBe('done');
    expect(withFolder(folder, done).jobs[0]!.state).toBe('done');
    expect(withFolder(folder, { ...folder, jobs: [{ ...job, fraction: 0.3 }] }).jobs[0]!.fraction).toBe(0.4);
    expect(withFolder(folder, { ...folder, jobs: [] }).jobs).toEqual([]);
    expect(withFolder(null, folder)).toEqual(folder);
  });
});

describe('lobes', () => {
  it('offer the files of the folder', () => {
    expect(shown(<LobesView path="" />, { folder: { ...folder, files: [file('a.toml', 'lobes'), file('b.toml', 'lobes')] } })).toContain('href="#/lobes/b.toml"');
    expect(shown(<LobesView path="" />, { folder: { ...folder, files: [] } })).toContain('robomill init job');
    expect(shown(<LobesView path="" />)).toContain('The first curve is being computed');
  });
  it('have sliders with label, number, lock and reset', () => {
    const html = renderToString(
      <Slider name="cut.radial_depth_mm" value={1.8} min={0} max={12} step={0.1} first={1.8} locked wrong={null} lock={() => {}} move={() => {}} rest={() => {}} />,
    );
    for (const part of ['for="slider-cut.radial_depth_mm"', 'type="range"', 'aria-label="Radial depth, number, millimetres"', 'aria-label="Lock Radial depth"', 'aria-label="Reset Radial depth"']) expect(html).toContain(part);
    expect(html.match(/ disabled/g)).toHaveLength(3);
  });
  it('keep one mode at least', () => {
    const modes = [1, 2].map((number) => ({ number, frequency_hz: 17.4, damping_ratio: 0.021, kept: true }));
    expect(renderToString(<ModeSwitches modes={modes} kept={[1, 2]} keep={() => {}} />)).not.toContain('disabled');
    expect(renderToString(<ModeSwitches modes={modes} kept={[2]} keep={() => {}} />)).toContain('One mode at least');
  });
  it('say the operating point in words', () => {
    const facts = { stable: false, evaluated: true, limit_mm: 0.5, searched_mm: 3, margin: -0.6, frequency_hz: 545.3, mode: 'mode 8' };
    const html = renderToString(<PointPanel point={[6500, 0.8]} facts={facts} />);
    expect(html).toContain('role="status" class="verdict chatter"');
    for (const part of ['6500 rpm', '0.8 mm', '0.500 mm', '<dt>Chatter frequency</dt>', '545.3 Hz, mode 8', 'verdict chatter']) expect(html).toContain(part);
    expect(renderToString(<PointPanel point={[6500, 0.8]} facts={{ ...facts, stable: true, limit_mm: null, margin: null }} />)).toMatch(/none up to 3 mm.*<dt>Chatter frequency above the limit<\/dt>/);
  });
  it('reset all that is not locked', () => {
    const settings = { set: { 'tool.teeth': 4, 'cut.radial_depth_mm': 2 }, modes: [1], point: [7000, 1] as [number, number] };
    const locks = new Set(['tool.teeth', 'operating_point.axial_depth_mm']);
    expect(resetAll(settings, locks, [6000, 0.5])).toEqual({ set: { 'tool.teeth': 4 }, modes: null, point: [6000, 1] });
  });
  it('write each change over the file that was read', async () => {
    const sent: string[] = [];
    const api = openApi({ token: '' }, (path, { method, body, headers }) => {
      sent.push(`${method} ${path} ${(headers as Record<string, string>)['If-Match'] ?? ''}`);
      if (path === '/api/edit') {
        const { text, key, value } = JSON.parse(body as string) as { text: string; key: string; value: unknown };
        return Promise.resolve(new Response(JSON.stringify({ text: `${text}${key}=${String(value)};` })));
      }
      if (method === 'PUT') sent.push(body as string);
      return Promise.resolve(method === 'PUT' ? new Response('{"etag":"b"}') : new Response('x;', { headers: { ETag: '"a"' } }));
    });
    await writeChanges(api, 'lobes.toml', [
      { key: 'tool.teeth', before: 3, after: 4 },
      { key: 'dynamics.keep_modes', before: [1, 2], after: [1] },
    ]);
    expect(sent).toEqual(['GET /api/file?path=lobes.toml ', 'POST /api/edit ', 'POST /api/edit ', 'PUT /api/file?path=lobes.toml "a"', 'x;tool.teeth=4;dynamics.keep_modes=1;']);
  });
});

describe('tap test', () => {
  const tap: Tap = {
    id: 1,
    revision: 4,
    hits: 'a/hits.toml',
    stream: null,
    force_direction: null,
    running: true,
    good: 1,
    wanted: 5,
    taken: [
      { number: 1, file: 'x_1.csv', accepted: true, excluded: false, reasons: [], force_direction: 'x', peak_force_n: 212 },
      { number: 2, file: 'x_2.csv', accepted: false, excluded: false, reasons: ['double hit'], force_direction: 'x', peak_force_n: null },
    ],
    frf: { document: 'frf/1', frequency_hz: [1, 2], receptance_m_per_n: { xx: { re: [1e-6, 2e-6], im: [0, 0] } }, coherence: { xx: [1, 1] } },
    peaks: [{ frequency_hz: 540.1, name: 'xx', receptance_m_per_n: 8.3e-6, coherence: 0.994 }],
  };
  it('begins with settings and a folder', () => {
    const html = shown(<TapView path="" />);
    for (const part of ['a/hits.toml', 'Folder to watch', 'Start']) expect(html).toContain(part);
    expect(shown(<TapView path="" />, { folder: { ...folder, files: [] } })).toContain('needs a hits.toml');
  });
  it('counts good hits, and says why one was rejected', () => {
    const html = shown(<TapView path="" />, { tap });
    for (const part of ['1 of 5 good hits; 4 more', 'x_2.csv: rejected; double hit', 'Receptance (µm/N)', '>8.3<', 'data-plot="tap"', 'End the tap test', 'Each hit is drawn here']) expect(html).toContain(part);
    expect(html.indexOf('x_2.csv</td>')).toBeLessThan(html.indexOf('x_1.csv</td>'));
    expect(laterTap(tap, { ...tap, revision: 3 })).toBe(tap);
    expect(laterTap({ ...tap, revision: 3 }, tap)).toBe(tap);
    expect(laterTap(tap, { ...tap, id: 2, revision: 1 })).toMatchObject({ id: 2 });
    expect(laterTap(tap, null)).toBeNull();
    expect(countText({ good: 5, wanted: 5 })).toContain('that is enough');
    expect(shown(<TapView path="" />, { tap: { ...tap, frf: null, taken: [], running: false } })).toContain('The first good hit draws');
  });
});

it('says what the server answered, or that it does not', () => {
  const text = (error: ApiError) => renderToString(<Trouble error={error} />);
  expect(text(new ApiError(0, faultOf('x')))).toContain('does not answer');
  expect(text(new ApiError(503, faultOf('too many connections')))).toMatch(/role="alert">The server answers with an error, .*too many connections/);
});

describe('a link to a place', () => {
  const click = (more: Partial<MouseEvent> = {}) => {
    let prevented = false;
    const link = { getAttribute: () => '#modes' };
    follow({ button: 0, ...more, target: { closest: () => link }, preventDefault: () => void (prevented = true) } as unknown as MouseEvent);
    return prevented;
  };
  it('takes the focus there, into a section too', () => {
    const done: string[] = [];
    const place = { tabIndex: -1, scrollIntoView: () => void done.push('scrolled'), focus: () => void done.push('focused') };
    let set: number | undefined;
    Object.defineProperty(place, 'tabIndex', { get: () => -1, set: (value: number) => void (set = value) });
    vi.stubGlobal('document', { getElementById: (id: string) => (id === 'modes' ? place : null) });
    expect(click()).toBe(true);
    expect([done, set]).toEqual([['scrolled', 'focused'], -1]);
    vi.unstubAllGlobals();
  });
  it('is left to the browser where it is to open another tab', () => {
    for (const more of [{ ctrlKey: true }, { metaKey: true }, { shiftKey: true }, { altKey: true }, { button: 1 }]) expect(click(more)).toBe(false);
  });
});

it('says the same once more', () => {
  const texts = ['a was written', 'a was written', 'a was written', 'b'].reduce<string[]>((all, text) => [...all, saidAfter(all[all.length - 1] ?? '', text)], []);
  expect(texts).toEqual(['a was written', 'a was written\u00a0', 'a was written', 'b']);
});

it('marks the view that is shown', () => {
  expect(renderToString(<Bar folder="shop" view="lobes" />)).toMatch(/href="#\/lobes" aria-current="page"/);
  expect(renderToString(<Bar folder="shop" view="job" />)).toMatch(/href="#\/files" aria-current="page"/);
});
