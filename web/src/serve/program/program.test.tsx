// The view of a program: what is asked, what is answered, what it shows.
import type { ComponentChildren } from 'preact';
import { renderToString } from 'preact-render-to-string';
import { describe, expect, it, vi } from 'vitest';
import type { BlocksDocument, Decision, GammaMap } from '../../documents';
import { blocksSample } from '../../blocks_sample';
import { light } from '../../figures/theme';
import { pathData, samePlaces } from '../../path_views';
import { Selection } from '../../selection';
import { openApi } from '../api';
import { ServeContext, type Serve } from '../context';
import type { FileEntry, FolderState, Job } from '../documents';
import { sampleReport } from '../../report_sample';
import type { Frame } from '../frame';
import { apart, curvePath, linePoints, liveGammaFigure, mapHeight, pixelsAt } from './gamma_figure';
import { boundsOf, lineAlong, lineMargin, marginsAlong, type GammaLine } from './gamma_line';
import { GammaPanel, Knots } from './gamma_panel';
import { MarginCurve } from './margin_curve';
import { ProgramView } from './program';
import { ProgramStart } from './start';
import type { ProgramAnswer, ProgramRequest } from './documents';
import { evaluatorOf, requestOf, type Evaluation } from './live';
import { blocksAround, candidates, evaluatedOutcome, jobName, keyTurn, lineText, outcomeOf, programOf, standingText, stillKnown, type LoadedProgram } from './views';
import { AnswerPanel, Outcomes, ProgramWork } from './work';

vi.mock('plotly.js-cartesian-dist-min', () => ({}));

const map: GammaMap = {
  block: [2, 3, 5],
  path_mm: [10, 20, 40],
  gamma_deg: [-30, 0, 30],
  margin: [
    [-0.6, 0.1, null],
    [0.2, 0.3, 0.1],
    [0.4, -0.1, 0.5],
  ],
  chosen_deg: [10, 10, 20],
  programmed_deg: [0, 0, 0],
  least_margin: 0.2,
};
const document: BlocksDocument = {
  ...blocksSample,
  blocks: {
    block: [1, 2, 3, 4, 5],
    line: [11, 12, 13, 14, 15],
    x_mm: [0, 10, 20, 30, 40],
    y_mm: [0, 0, 0, 0, 0],
    z_mm: [5, 0, 0, 0, 0],
    axial_depth_mm: [null, 1, 1, 1, 1],
    spectral_radius: [null, 0.9, 1.1, 0.8, 0.7],
    stability_margin: [null, 0.2, -0.1, 0.3, 0.4],
    peak_f_n: [null, 90, 120, 80, 70],
    deflection_um: [null, 20, 31, 18, 12],
    regime: [null, 'regenerative', 'regenerative', 'none', 'none'],
  },
  summary: { ...blocksSample.summary, blocks: 5, cutting: 4, engagement_lost: 0 },
  limit_over: [],
};
const sample = sampleReport();
const decision: Decision = { ...sample.plan!.decision!, gamma_map: map };
const program: LoadedProgram = { id: 3, input: 'job.toml', document, decision };
const answer: ProgramAnswer = {
  sequence: 1,
  blocks: { ...document, blocks: { ...document.blocks, spectral_radius: [null, 0.9, 0.8, 0.8, null], stability_margin: [null, 0.2, 0.35, 0.3, null], axial_depth_mm: [null, 1, 1, 1, null] } },
  lost: [{ block: 5, line: 15, text: 'joint 5 is beyond its limit' }],
  gamma: { block: [2, 3, 5], path_mm: [10, 20, 40], gamma_deg: [0, 0, 0], margin: [0.2, 0.35, null] },
  unstable: 0,
  least_margin: 0.2,
  worst_block: 2,
  notes: ['Forces are those of the job.'],
  milliseconds: 412,
};
const line: GammaLine = [[10, 0], [40, 15]];
const bounds = boundsOf(map);
const margins = marginsAlong(map, line);
const nothing = () => {};

const job = (id: number, more: Partial<Job> = {}): Job => ({ id, verb: 'plan', input: 'job.toml', output: 'out', state: 'done', exit: 0, task: '', fraction: 1, seconds: 9, error: null, summary: null, report: true, ...more });
const file = (path: string, kind: FileEntry['kind']): FileEntry => ({ path, kind, bytes: 1, modified: '' });
const folder: FolderState = { version: '0.1.0', folder: 'shop', files: [file('job.toml', 'job'), file('a/face.toml', 'job')], files_left_out: 0, record_endings: ['.csv', '.tdms'], jobs: [] };

function shown(view: ComponentChildren, more: Partial<Serve> = {}): string {
  const api = openApi({ token: '' }, () => new Promise(() => {}));
  const serve: Serve = { api, folder, verbs: [{ verb: 'plan', does: 'Run the job', inputs: ['job'], several: false, output: 'out', options: [] }], tap: null, tookTap: nothing, announce: nothing, refresh: nothing, take: nothing, ...more };
  return renderToString(<ServeContext value={serve}>{view}</ServeContext>);
}

describe('a request', () => {
  it('has the knots of the line, to a thousandth', () => {
    expect(requestOf(3, [[10.00049, -20.12345], [40, 0]], 'c', 7)).toEqual({ job: 3, gamma: [[10, -20.123], [40, 0]], client: 'c', channel: 'program', sequence: 7 });
  });
  it('is given up for a newer line, and what comes late is dropped', async () => {
    const sent: { body: ProgramRequest; answer: (response: Response) => void; aborted: () => boolean }[] = [];
    const api = openApi({ token: 'T' }, (path, { body, signal }) => {
      expect(path).toBe('/api/program');
      return new Promise((resolve, reject) => {
        signal!.addEventListener('abort', () => reject(new DOMException('', 'AbortError')));
        sent.push({ body: JSON.parse(body as string) as ProgramRequest, answer: resolve, aborted: () => signal!.aborted });
      });
    });
    const got: (Evaluation | string)[] = [];
    const evaluator = evaluatorOf({ api, job: 3, client: 'c', answered: (one) => got.push(one), failed: (error) => got.push(error?.fault.text ?? 'superseded') });
    const settle = () => new Promise((resolve) => setTimeout(resolve, 0));
    evaluator.put([[10, 1]]);
    evaluator.put([[10, 2]]);
    await settle();
    expect(sent.map(({ body }) => [body.sequence, body.gamma])).toEqual([[1, [[10, 1]]], [2, [[10, 2]]]]);
    expect(sent.map(({ aborted }) => aborted())).toEqual([true, false]);
    sent[0]!.answer(new Response(JSON.stringify(answer)));
    sent[1]!.answer(new Response(JSON.stringify({ ...answer, sequence: 2 })));
    await settle();
    expect(got).toEqual([{ answer: { ...answer, sequence: 2 }, line: [[10, 2]] }]);
    evaluator.put([[10, 3]]);
    sent[2]!.answer(new Response('{"superseded":true}', { status: 409 }));
    await settle();
    evaluator.put([[10, 4]]);
    sent[3]!.answer(new Response('{"error":{"text":"run it again"}}', { status: 404 }));
    await settle();
    expect(got.slice(1)).toEqual(['superseded', 'run it again']);
  });
});

describe('programs', () => {
  it('are those of plans that are done, the newest first', () => {
    const jobs = [job(1), job(2, { state: 'running' }), job(3, { report: false }), job(4, { exit: 3 }), job(5, { verb: 'other' })];
    expect(candidates(jobs).map(({ id }) => id)).toEqual([4, 1]);
    expect(programOf(job(3), { ...sample, blocks: document, plan: { ...sample.plan!, decision } })).toEqual(program);
    expect(programOf(job(3), { ...sample, blocks: null, plan: null })).toBeNull();
    expect(jobName(program)).toBe('as chosen by the job');
    expect(jobName({ ...program, decision: null })).toBe('as programmed');
  });
  it('are forgotten with their jobs, but for the one that is shown', () => {
    const known = new Map([[1, 'a'], [2, 'b'], [3, 'c']]);
    expect([...stillKnown(known, [job(3)], 1).keys()]).toEqual([1, 3]);
    expect([...stillKnown(known, [job(3)], null).keys()]).toEqual([3]);
    expect(stillKnown(known, [job(1), job(2), job(3), job(4)], null)).toBe(known);
  });
  it('come to what their blocks come to', () => {
    expect(outcomeOf(document)).toEqual({ unstable: 1, least: -0.1, block: 3, force_n: 120, deflection_um: 31, engagement_lost: 0, cannot_take: null });
    expect(evaluatedOutcome({ answer, line })).toEqual({ unstable: 0, least: 0.2, block: 2, force_n: 120, deflection_um: 31, engagement_lost: 0, cannot_take: 1 });
    expect(outcomeOf({ ...document, blocks: { ...document.blocks, stability_margin: [null, null, null, null, null] } })).toMatchObject({ least: null, block: null });
  });
  it('tell lost engagement from blocks that the robot cannot take', () => {
    const pushed = { ...document, summary: { ...document.summary, engagement_lost: 2 } };
    const turned = evaluatedOutcome({ answer: { ...answer, blocks: { ...answer.blocks, summary: pushed.summary } }, line });
    expect(outcomeOf(pushed)).toMatchObject({ engagement_lost: 2, cannot_take: null });
    expect(turned).toMatchObject({ engagement_lost: 2, cannot_take: 1 });
    const html = renderToString(<Outcomes rows={[{ name: 'a', outcome: outcomeOf(pushed), shown: false }, { name: 'b', outcome: turned, shown: true }]} />);
    for (const part of ['>Engagement lost</th>', '>Robot cannot take</th>', '<td class="number">2</td><td class="number">–</td>', '<td class="number">2</td><td class="number">1</td>']) expect(html).toContain(part);
  });
  it('keep their place in space with other verdicts and more digits', () => {
    const more = { ...document.blocks, x_mm: [0, 10.0000004, 20, 30, 40] };
    expect(samePlaces(pathData(document.blocks), pathData({ ...more, spectral_radius: answer.blocks.blocks.spectral_radius! }))).toBe(true);
    expect(samePlaces(pathData(document.blocks), pathData({ ...more, y_mm: [0, 0, 0.1, 0, 0] }))).toBe(false);
    expect(samePlaces(pathData(document.blocks), pathData({ ...more, z_mm: [5, 0, 0, 0, 1] }))).toBe(false);
  });
  it('list the blocks around one of them', () => {
    expect(blocksAround(document.blocks, null, 2)).toEqual([1, 2]);
    expect(blocksAround(document.blocks, 3, 3)).toEqual([2, 3, 4]);
    expect(blocksAround(document.blocks, 4, 2)).toEqual([3, 4]);
    expect(blocksAround(document.blocks, 0, 3)).toEqual([0, 1, 2]);
  });
});

describe('words', () => {
  const standing = { shown: 'line' as const, name: 'as chosen by the job', evaluation: { answer, line }, current: true, busy: false };
  it('say which numbers are shown', () => {
    expect(standingText(standing)).toBe('Shown: re-evaluated with your γ in 0.412 s.');
    expect(standingText({ ...standing, current: false, busy: true })).toBe('Shown: re-evaluated with your γ as it was before the last change. Your γ is being evaluated …');
    expect(standingText({ ...standing, shown: 'job' })).toBe('Shown: as chosen by the job.');
    expect(standingText({ ...standing, evaluation: null })).toBe('Shown: as chosen by the job.');
  });
  it('say the least margin along the line', () => {
    expect(lineText(lineMargin([0.3, -0.1, null]), map)).toBe('Least margin on the map -0.1 at block 3 (20.0 mm). 1 of 3 places chatter. At 1 the robot cannot stand so.');
    expect(lineText(lineMargin([null]), map)).toBe('The map has no margin along this line.');
  });
});

describe('keys', () => {
  it('turn by 1° and 10°, and to the ends', () => {
    const turn = (key: string, shift = false) => keyTurn(key, shift, 5, bounds);
    expect(['ArrowUp', 'ArrowRight', 'ArrowDown', 'ArrowLeft', 'PageUp', 'PageDown', 'Home', 'End', 'a'].map((key) => turn(key))).toEqual([6, 6, 4, 4, 15, -5, -30, 30, null]);
    expect([turn('ArrowUp', true), turn('ArrowLeft', true)]).toEqual([15, -5]);
  });
});

describe('the figure', () => {
  const frame: Frame = { left: 50, top: 20, width: 300, height: 120, x: [10, 40], y: [-30, 30] };
  it('has places for lines and curves', () => {
    expect(pixelsAt(frame, [10, 30])).toEqual([50, 20]);
    expect(pixelsAt(frame, [25, 0])).toEqual([200, 80]);
    expect(linePoints(frame, [[20, 0], [30, 30]])).toBe('0.0,60.0 100.0,60.0 200.0,0.0 300.0,0.0');
    expect(curvePath([1, 2, 3, 4], [0, null, 1, 2], (x, y) => [x, y])).toBe('M1.0,0.0M3.0,1.0L4.0,2.0');
    expect(apart([[0, 1], [4, 1], [17, 2], [20, 3]], 16)).toEqual([[0, 1], [17, 2]]);
  });
  it('keeps the map of the report, without dragging a zoom', () => {
    const { data, layout } = liveGammaFigure(map, 1, light, false, mapHeight(360));
    expect(data[0]).toMatchObject({ type: 'heatmap', z: map.margin });
    expect(layout).toMatchObject({ dragmode: false, height: 300 });
    expect((data[0]!['colorbar'] as { y: number }).y).toBeLessThan(-0.2);
    expect(mapHeight(2000)).toBe(470);
  });
  it('shows three margins under the map', () => {
    const html = renderToString(<MarginCurve frame={frame} map={map} margins={margins} chosen={margins} evaluated={answer.gamma} selected={1} />);
    for (const part of ['class="by-map"', 'class="evaluated" d=', 'class="chosen" d=', 'class="asked"', 'class="least"', 'class="selected"', '−0.5']) expect(html).toContain(part);
    expect(renderToString(<MarginCurve frame={null} map={map} margins={margins} chosen={margins} evaluated={null} selected={null} />)).not.toContain('<path');
  });
});

describe('the view', () => {
  const moves = { line, bounds, map, margins, change: nothing, rest: nothing };
  it('says how to get a program, and runs a job for one', () => {
    const html = shown(<ProgramView path="" />);
    for (const part of ['data-panel="program-start"', 'Run the job', 'value="a/face.toml"', 'value="out"']) expect(html).toContain(part);
    expect(shown(<ProgramView path="" />, { folder: { ...folder, files: [] } })).toContain('robomill init job');
    expect(html).toContain('No finished job has a program');
    expect(shown(<ProgramStart none={false} />)).not.toContain('No finished job');
    expect(shown(<ProgramView path="9" />)).toContain('Job 9 has no program to show');
    expect(shown(<ProgramView path="" />, { folder: { ...folder, jobs: [job(1)] } })).toContain('are loading');
    const running = shown(<ProgramView path="" />, { folder: { ...folder, jobs: [job(1, { state: 'running', fraction: 0.4, task: 'map of γ', report: false })] } });
    for (const part of ['map of γ', 'value="0.4"', 'Cancel']) expect(running).toContain(part);
    expect(running).not.toContain('Run the job');
  });
  it('has path, map, blocks and the line in numbers', () => {
    const html = shown(<ProgramWork program={program} />);
    for (const part of ['data-panel="path"', 'data-plot="gamma-line"', 'data-panel="blocks"', 'data-panel="knots"', 'Shown: as chosen by the job.', 'data-shown="job"', 'tr class="selected"']) expect(html).toContain(part);
    expect(html).toMatch(/class="chatter">.*?>3<\/button>/);
    for (const name of ['Stability margin', 'Peak force', 'Deflection', 'Regime']) expect(html).toContain(`<span>${name}</span>`);
    expect(lineAlong(map, map.chosen_deg)).toHaveLength(3);
    expect(html.match(/Remove handle/g)).toHaveLength(3);
  });
  it('shows path and blocks alone where nothing was decided', () => {
    const html = shown(<ProgramWork program={{ ...program, decision: null }} />);
    for (const part of ['[decide]', 'data-panel="path"', 'data-panel="blocks"']) expect(html).toContain(part);
    expect(html).not.toContain('gamma-line');
  });
  it('has the margin, buttons and numbers of the line', () => {
    const html = renderToString(<GammaPanel {...moves} answer={null} selected={1} select={nothing} undo={null} />);
    for (const part of ['As programmed', 'As chosen', 'Add a handle', 'At block 3: γ 5.0°, margin 0.233', 'Least margin on the map 0.2 at block 2 (10.0 mm)']) expect(html).toContain(part);
    expect(html).toMatch(/<button[^>]*disabled[^>]*>Undo/);
    const numbers = renderToString(<Knots {...moves} line={[[10, 3.14159]]} />);
    for (const part of ['aria-label="Handle 1, γ, degrees"', 'value="3.14"', 'min="-30"']) expect(numbers).toContain(part);
    expect(numbers).toMatch(/<button[^>]*disabled/);
  });
  it('lists the blocks that are lost, and links them', () => {
    const html = renderToString(<Selection blocks={[1, 2, 3, 4, 5]}><AnswerPanel answer={answer} /></Selection>);
    for (const part of ['One block cannot be cut', 'block 5 (line 15)</a>: joint 5 is beyond its limit', 'Forces are those of the job.']) expect(html).toContain(part);
    const many = { ...answer, lost: Array.from({ length: 30 }, (_, i) => ({ block: i + 1, line: null, text: 'x' })), notes: [] };
    const all = renderToString(<AnswerPanel answer={many} />);
    for (const part of ['30 blocks', 'and 10 more']) expect(all).toContain(part);
    expect(renderToString(<AnswerPanel answer={{ ...answer, lost: [], notes: [] }} />)).toBe('');
  });
  it('sets both evaluations side by side', () => {
    const html = renderToString(<Outcomes rows={[{ name: 'a', outcome: outcomeOf(document), shown: false }, { name: 'b', outcome: null, shown: true }]} />);
    expect(html).toContain('-0.1');
    expect(html).toMatch(/<tr class="selected"><td>b<\/td><td class="number">–/);
  });
});
