// What can be run on a file, and the form that asks for it.
import type { ComponentChildren } from 'preact';
import { renderToString } from 'preact-render-to-string';
import { describe, expect, it, vi } from 'vitest';
import { openApi } from '../api';
import { ServeContext, type Serve } from '../context';
import type { FileEntry, FolderState, Verb, VerbOption } from '../documents';
import { FilesTable } from '../files/files';
import { JobView } from '../files/job';
import { documentText, filesOf, proposedOutput, runsOf } from '../verbs';
import { RunForm } from './run_form';
import { parseOption, jobRequest, wrongOptions } from './run_options';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

const option = (name: string, takes: VerbOption['takes'], more: Partial<VerbOption> = {}): VerbOption => ({ name, does: `The ${name}`, takes, required: false, ...more });
const verbs: Verb[] = [
  { verb: 'plan', does: 'Run the job', inputs: ['job'], several: false, output: 'out', options: [option('seed', 'whole')] },
  {
    verb: 'modes',
    does: 'Fit modes',
    inputs: ['frf', 'record'],
    several: true,
    output: 'modes.json',
    options: [option('band_hz', 'numbers', { count: 2 }), option('method', 'word', { words: ['hybrid', 'lscf'] }), option('accept_fit', 'flag')],
  },
  { verb: 'joint', does: 'Find the joint', inputs: ['assembly'], several: false, output: 'joint.json', options: [option('measured', 'files', { required: true, kinds: ['frf'] })] },
  { verb: 'lobes', does: 'Compute lobes', inputs: ['lobes'], several: false, output: 'lobes.json', options: [option('at', 'points')] },
  { verb: 'simulate', does: 'Simulate the cut', inputs: ['lobes'], several: false, output: 'vibration.csv', options: [option('at', 'point', { required: true }), option('seconds', 'number')] },
  { verb: 'cell check', does: 'Check the cell', inputs: ['cell'], several: false, output: 'check.json', options: [option('program', 'file', { kinds: ['program'] })] },
  { verb: 'smooth', does: 'Smooth the program', inputs: ['program'], several: false, output: 'trajectory.csv', options: [option('cell', 'file', { required: true, kinds: ['cell'] })] },
];
const verb = (name: string) => verbs.find((one) => one.verb === name)!;

const file = (path: string, kind: FileEntry['kind'], document: string | null = null): FileEntry => ({ path, kind, document, bytes: 1, modified: '' });
const folder: FolderState = {
  version: '',
  folder: 'shop',
  files: [file('cell.toml', 'cell'), file('a/tip_x.uff', 'frf'), file('a/tip_y.uff', 'frf'), file('tap.csv', 'record'), file('part.ngc', 'program'), file('out/plan.json', 'result', 'plan'), file('lobes.json', 'result', 'lobes')],
  files_left_out: 0,
  record_endings: ['.csv'],
  jobs: [],
};

function shown(view: ComponentChildren): string {
  const nothing = () => {};
  const serve: Serve = { api: openApi({ token: '' }), folder, verbs, tap: null, tookTap: nothing, announce: nothing, refresh: nothing, take: nothing };
  return renderToString(<ServeContext value={serve}>{view}</ServeContext>);
}

describe('a kind of file', () => {
  it('has the verbs that read it, then those that need it', () => {
    const names = (kind: FileEntry['kind']) => runsOf(verbs, kind).map(({ verb, as }) => `${verb.verb}${as ? ` as ${as.name}` : ''}`);
    expect(names('job')).toEqual(['plan']);
    expect(names('lobes')).toEqual(['lobes', 'simulate']);
    expect(names('frf')).toEqual(['modes', 'joint as measured']);
    expect(names('cell')).toEqual(['cell check', 'smooth as cell']);
    expect(names('program')).toEqual(['smooth']);
    expect(names('other')).toEqual([]);
    expect(runsOf([], 'job')).toEqual([]);
  });
  it('has a place for results beside it, with its name where it is no usual one', () => {
    expect(proposedOutput(verb('plan'), 'a/job.toml')).toBe('a/out');
    expect(proposedOutput(verb('lobes'), 'lobes.toml')).toBe('lobes.json');
    expect(proposedOutput(verb('lobes'), 'b/ball-end.toml')).toBe('b/ball-end-lobes.json');
    expect(proposedOutput(verb('modes'), 'tip_x')).toBe('tip_x-modes.json');
  });
  it('is chosen from among the files, in the order of kinds', () => {
    expect(filesOf(folder.files, ['record', 'frf']).map(({ path }) => path)).toEqual(['tap.csv', 'a/tip_x.uff', 'a/tip_y.uff']);
    expect([documentText({ document: 'plan' }), documentText({ document: 'of later' }), documentText({})]).toEqual(['a plan', 'of later', '']);
  });
});

describe('options', () => {
  const value = (takes: VerbOption['takes'], typed: string | boolean | string[], more = {}) => parseOption(option('x', takes, more), typed);
  it('are read as they are typed', () => {
    expect(value('number', ' 0.5 ')).toEqual({ value: 0.5 });
    expect(value('whole', '3')).toEqual({ value: 3 });
    expect(value('numbers', '10, -5 15')).toEqual({ value: [10, -5, 15] });
    expect(value('texts', 'xx, yy')).toEqual({ value: ['xx', 'yy'] });
    expect(value('point', '6500, 0.8')).toEqual({ value: [6500, 0.8] });
    expect(value('points', '6500, 0.8; 8000 1;')).toEqual({ value: [[6500, 0.8], [8000, 1]] });
    expect(value('word', 'lscf')).toEqual({ value: 'lscf' });
    expect(value('files', ['a', 'b'])).toEqual({ value: ['a', 'b'] });
    expect(value('flag', true)).toEqual({ value: true });
    for (const nothing of ['', ' ', false, []] as (string | boolean | string[])[]) expect(value('file', nothing)).toBeNull();
  });
  it('say what is wrong with them', () => {
    expect(value('number', 'long')).toEqual({ wrong: 'A number is needed.' });
    expect(value('whole', '1.5')).toEqual({ wrong: 'A whole number is needed.' });
    expect(value('numbers', '1,,2')).toHaveProperty('wrong');
    expect(value('numbers', '1, 2, 3', { count: 2 })).toEqual({ wrong: '2 numbers are needed.' });
    for (const point of ['6500', '0, 1', 'a, b', '1, 2, 3']) expect(value('point', point)).toHaveProperty('wrong');
    expect(value('points', '6500, 0.8; 8000')).toHaveProperty('wrong');
    expect(value('file', '', { required: true })).toEqual({ wrong: 'Needed.' });
    expect(wrongOptions(verb('simulate'), { seconds: 'x' })).toEqual({ at: 'Needed.', seconds: 'A number is needed.' });
  });
  it('make the request, those that were not given left out', () => {
    expect(jobRequest(verb('simulate'), ['lobes.toml'], ' v.csv ', { at: '6500, 0.8', seconds: '' })).toEqual({ verb: 'simulate', input: 'lobes.toml', output: 'v.csv', options: { at: [6500, 0.8] } });
    expect(jobRequest(verb('modes'), ['a', 'b'], '', { accept_fit: true })).toEqual({ verb: 'modes', input: ['a', 'b'], output: '', options: { accept_fit: true } });
  });
});

describe('the form', () => {
  const form = (kind: FileEntry['kind'], path: string, dirty = false) => shown(<RunForm kind={kind} path={path} dirty={dirty} save={async () => true} started={() => {}} />);
  it('has the verb of a file, and saves before it', () => {
    expect(form('job', 'a/job.toml')).toContain('value="a/out"');
    expect(form('job', 'a/job.toml')).toContain('>Run the job</button>');
    expect(form('job', 'a/job.toml', true)).toContain('Save; run the job');
    expect(form('other', 'x')).toBe('');
  });
  it('offers a choice where there are several verbs', () => {
    const html = form('lobes', 'lobes.toml');
    for (const part of ['What to do', 'Compute lobes (lobes)', 'Simulate the cut (simulate)', 'It replaces lobes.json']) expect(html).toContain(part);
  });
  it('has several FRFs to choose, the file itself chosen', () => {
    const html = form('frf', 'a/tip_x.uff');
    expect(html).toMatch(/<legend>Files<\/legend>.*checked[^>]*> ?a\/tip_x\.uff/s);
    expect(html.match(/type="checkbox"/g)).toHaveLength(4); // three files and a switch
    for (const part of ['a/tip_y.uff', 'tap.csv', '<label for="run-band_hz">The band_hz</label>', '<option value="lscf">', 'value="a/tip_x-modes.json"']) expect(html).toContain(part);
  });
  it('takes the only file that an option can be', () => {
    expect(form('program', 'part.ngc')).toMatch(/<option value="cell\.toml" selected|<option selected value="cell\.toml"/);
  });
  it('stands in the view of a file that is not edited', () => {
    const html = shown(<JobView path="a/tip_x.uff" />);
    for (const part of ['data-panel="run-form"', 'Fit modes', 'Listed under FRFs']) expect(html).toContain(part);
    expect(html).not.toContain('<textarea');
    expect(shown(<JobView path="none.uff" />)).toContain('There is no such file');
    expect(shown(<JobView path="out/plan.json" />)).toContain('nothing to run');
  });
  it('is reached from the list of files, which names results', () => {
    const html = renderToString(<FilesTable files={folder.files} verbs={verbs} describe={() => {}} />);
    for (const part of ['aria-label="Run: a/tip_x.uff"', 'aria-label="Smooth the program: part.ngc"', 'aria-label="Edit and run: cell.toml"', 'Results', 'a plan']) expect(html).toContain(part);
    expect(html).not.toContain('aria-label="Run: out/plan.json"');
  });
});
