// node serve_check.mjs PROGRAM [FOLDER] [--shots DIR] [--only TASK,TASK] [--chromium PATH]
// Starts `PROGRAM serve` on a copy of FOLDER, or on what `PROGRAM init job --example` writes, and works its page as a person would, by input events alone. Exit 0 or 1; times are said, none fails.
import { spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join, resolve } from 'node:path';
import { argument, chromiumPath, run } from './arguments.mjs';
import { launch, openPage } from './chromium.mjs';
import { settle } from './hand.mjs';
import { contrast, names, walk, width } from './serve_look.mjs';
import { startRunning } from './serve_running.mjs';
import { editFile, runJob, runVerb, sendFiles, tapTest } from './serve_tasks.mjs';
import { moveLobes } from './serve_lobes.mjs';
import { monitorSpindle } from './serve_monitor.mjs';
import { openJob } from './serve_overview.mjs';
import { workProgram } from './serve_program.mjs';
import { serve } from './serve_start.mjs';

const tasks = { openJob, moveLobes, editFile, runVerb, runJob, workProgram, sendFiles, tapTest, monitorSpindle };

/** Goes to a view by its address and waits until it is there. */
async function open(page, hash, heading = 'true') {
  await page.evaluate(`window.location.hash = ${JSON.stringify(hash)}`);
  await page.until(`document.querySelector('#view h1') !== null && (${heading})`, hash, 20);
  await settle(page);
}

/** A file of a kind; the one that is named after it, where there is one. */
function fileOf(state, kind) {
  const all = state.files.filter((file) => file.kind === kind).map(({ path }) => path);
  return all.find((path) => basename(path) === `${kind}.toml`) ?? all[0];
}

/** The views, each with what says that it is complete. */
function viewsOf(state) {
  const drawn = `document.querySelector('.chart-place svg.main-svg') !== null`;
  const views = [
    { name: 'overview', hash: '#/overview', there: `document.querySelector('[aria-label="Stages"] table, [aria-label="Jobs"] table, [aria-label="How to begin"]') !== null` },
    { name: 'files', hash: '#/files', there: `document.querySelector('#view table') !== null` },
    { name: 'jobs', hash: '#/jobs', there: 'true' },
    { name: 'program', hash: '#/program', there: `document.querySelector('.gamma-place .handle, [data-panel="program-start"]') !== null` },
    { name: 'tap', hash: '#/tap', there: 'true' },
    { name: 'monitor', hash: '#/monitor', there: `document.querySelector('[data-panel="monitor-start"], #view .notice') !== null` },
  ];
  const lobes = fileOf(state, 'lobes');
  const job = fileOf(state, 'job') ?? lobes;
  if (job) views.push({ name: 'job', hash: `#/job/${job}`, there: `document.querySelector('.editor textarea')?.value.length > 0 && document.querySelector('.fields .field') !== null` });
  const frf = fileOf(state, 'frf');
  if (frf) views.push({ name: 'run', hash: `#/job/${frf}`, there: `document.querySelector('[data-panel="run-form"] form') !== null` });
  if (lobes) views.push({ name: 'lobes', hash: `#/lobes/${lobes}`, there: drawn });
  return views;
}

const sizes = [
  { width: 1280, height: 800, scheme: 'light', keys: true },
  { width: 1280, height: 800, scheme: 'dark' },
  { width: 640, height: 360, scheme: 'light', keys: true },
  { width: 640, height: 360, scheme: 'dark' },
];

async function resize(page, { width, height, scheme }) {
  await page.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
  await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: scheme }] });
}

/** Every one of these views, light and dark, wide and as a phone held sideways. */
async function lookAt({ page, problems, shot }, views) {
  let walked = 0;
  for (const size of sizes) {
    await resize(page, size);
    for (const view of views) {
      const where = `${view.name}, ${size.width} × ${size.height}, ${size.scheme}`;
      await open(page, view.hash, view.there);
      await width(page, where, problems);
      await contrast(page, where, problems);
      await shot(`${view.name}-${size.width}-${size.scheme}`);
      if (!size.keys) continue;
      await names(page, where, problems);
      walked += await walk(page, where, problems);
    }
  }
  await resize(page, sizes[0]);
  return walked;
}

/** The views as they are when nothing runs, then those in which something does. */
async function look(at, ranJob) {
  const begun = performance.now();
  const idle = await lookAt(at, viewsOf(at.state));
  const views = await startRunning(at, ranJob);
  const running = await lookAt(at, views);
  const seconds = (performance.now() - begun) / 1000;
  at.figures.push(`${idle + running} controls reached by Tab; also looked at while it runs: ${views.map(({ name }) => name).join(', ')}; ${seconds.toFixed(0)} s`);
}

/** The first plot: from the start of the server, the browser stands ready. */
async function firstPlot(browser, program, folder) {
  const begun = performance.now();
  const server = await serve(program, folder);
  const ready = performance.now();
  try {
    const state = await (await fetch(`${server.url}api/state`)).json();
    const lobes = fileOf(state, 'lobes');
    const page = await openPage(browser, `${server.url}#/lobes/${lobes ?? ''}`, { width: 1280, height: 800 });
    if (lobes) await page.until(`document.querySelector('.chart-place svg.main-svg .trace path') !== null`, 'the first plot', 30);
    return { server, page, state, lobes, said: `server ready after ${(ready - begun).toFixed(0)} ms, first plot after ${(performance.now() - begun).toFixed(0)} ms` };
  } catch (error) {
    await server.close();
    throw error;
  }
}

async function check(browser, { program, folder, shots, wanted }) {
  const problems = [];
  const { server, page, state, lobes, said } = await firstPlot(browser, program, folder);
  const figures = [said];
  const shot = async (name) => shots && writeFileSync(join(shots, `${name}.png`), await page.screenshot());
  const at = { page, server, state, fileOf: (kind) => fileOf(state, kind), lobes, folder, problems, figures, shot, open: (hash, there) => open(page, hash, there) };
  try {
    for (const name of wanted) {
      await tasks[name](at).catch((error) => problems.push(`${name}: ${error.message}`));
      await shot(name);
    }
    await look(at, wanted.includes('runJob') && at.fileOf('job') !== undefined);
  } catch (error) {
    problems.push(error.message);
  } finally {
    for (const error of page.errors) if (!/status of 409/.test(error)) problems.push(error); // a conflict is part of the work
    for (const address of new Set(page.requests)) if (!address.startsWith(server.url) && !/^(data|blob):/.test(address)) problems.push(`fetched ${address}`);
    await page.close().catch(() => {}); // nothing is left to close where the browser has ended
    await server.close();
  }
  return { problems, figures };
}

/** A folder as somebody has it who begins. */
function begin(program, folder) {
  mkdirSync(folder);
  for (const kind of ['lobes', 'job']) { // a cut in a file of its own, and the job that names it
    const { status, stderr } = spawnSync(program, ['init', kind, '--example', '-o', join(folder, `${kind}.toml`)], { encoding: 'utf8' });
    if (status !== 0) throw new Error(`${program} init ended with ${status}: ${stderr}`);
  }
}

/** The tasks that are asked for, all where none is. */
function wantedTasks() {
  const all = Object.keys(tasks);
  const names = argument('--only', all.join()).split(',');
  const unknown = names.filter((name) => !all.includes(name));
  if (unknown.length > 0) throw new Error(`--only: there is no task ${unknown.join(', ')}; there are ${all.join(', ')}`);
  return all.filter((name) => names.includes(name));
}

async function main() {
  const [program, second] = process.argv.slice(2);
  const given = second?.startsWith('--') ? undefined : second;
  if (!program || (given && !existsSync(given))) {
    console.error('usage: node serve_check.mjs PROGRAM [FOLDER] [--shots DIR] [--only TASK,TASK] [--chromium PATH]');
    return 1;
  }
  const [wanted, shots] = [wantedTasks(), argument('--shots', undefined)];
  if (shots) mkdirSync(shots, { recursive: true });
  const room = mkdtempSync(join(tmpdir(), 'robomill-serve-'));
  let browser;
  try {
    const folder = join(room, given ? basename(resolve(given)) : 'begun');
    if (given) cpSync(given, folder, { recursive: true });
    else begin(resolve(program), folder);
    browser = await launch(chromiumPath());
    const { problems, figures } = await check(browser, { program: resolve(program), folder, shots, wanted });
    for (const figure of figures) console.log(figure);
    for (const problem of problems) console.error(problem);
    return problems.length === 0 ? 0 : 1;
  } finally {
    await browser?.close();
    rmSync(room, { recursive: true, force: true });
  }
}

await run(main);
