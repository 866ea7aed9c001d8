// node serve_check.mjs PROGRAM FOLDER [--shots DIR] [--chromium PATH]
// Starts `PROGRAM serve` on a copy of FOLDER and works its page as a person would, by input events alone. Exit 0 or 1; times are said, none fails.
import { spawn } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join, resolve } from 'node:path';
import { launch, openPage } from './chromium.mjs';
import { settle } from './hand.mjs';
import { contrast, names, walk, width } from './serve_look.mjs';
import { editFile, runJob, sendFiles, tapTest } from './serve_tasks.mjs';
import { moveLobes } from './serve_lobes.mjs';
import { monitorSpindle } from './serve_monitor.mjs';

function argument(name, fallback) {
  const at = process.argv.indexOf(name);
  return at > 0 ? process.argv[at + 1] : fallback;
}

/** The server and the address that it says. */
async function serve(program, folder) {
  const child = spawn(program, ['serve', folder, '--port', '0'], { stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  const gone = new Promise((done) => child.once('exit', done));
  const url = await new Promise((found, fail) => {
    const read = (text) => {
      said += text;
      const address = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
      if (address) found(address[0]);
    };
    child.stdout.setEncoding('utf8').on('data', read);
    child.stderr.setEncoding('utf8').on('data', read);
    child.once('error', fail);
    gone.then((code) => fail(new Error(`${program} serve ended with ${code}: ${said.slice(-500)}`)));
  });
  const close = async () => {
    child.kill('SIGTERM');
    const timer = setTimeout(() => child.kill('SIGKILL'), 5000);
    await gone;
    clearTimeout(timer);
  };
  return { url, close };
}

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
    { name: 'files', hash: '#/files', there: `document.querySelector('#view table') !== null` },
    { name: 'jobs', hash: '#/jobs', there: 'true' },
    { name: 'tap', hash: '#/tap', there: 'true' },
    { name: 'monitor', hash: '#/monitor', there: `document.querySelector('[data-panel="monitor-start"]') !== null` },
  ];
  const lobes = fileOf(state, 'lobes');
  const job = fileOf(state, 'job') ?? lobes;
  if (job) views.push({ name: 'job', hash: `#/job/${job}`, there: `document.querySelector('.editor textarea')?.value.length > 0 && document.querySelector('.fields .field') !== null` });
  if (lobes) views.push({ name: 'lobes', hash: `#/lobes/${lobes}`, there: drawn });
  return views;
}

/** Every view, light and dark, wide and as a phone held sideways. */
async function look({ page, state, problems, shot }) {
  const sizes = [
    { width: 1280, height: 800, scheme: 'light', keys: true },
    { width: 1280, height: 800, scheme: 'dark' },
    { width: 640, height: 360, scheme: 'light', keys: true },
    { width: 640, height: 360, scheme: 'dark' },
  ];
  let walked = 0;
  for (const size of sizes) {
    await page.send('Emulation.setDeviceMetricsOverride', { width: size.width, height: size.height, deviceScaleFactor: 1, mobile: false });
    await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: size.scheme }] });
    for (const view of viewsOf(state)) {
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
  await page.send('Emulation.setDeviceMetricsOverride', { width: 1280, height: 800, deviceScaleFactor: 1, mobile: false });
  await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: 'light' }] });
  return walked;
}

/** The first plot: from the start of the server, the browser stands ready. */
async function firstPlot(browser, program, folder) {
  const begun = performance.now();
  const server = await serve(program, folder);
  const ready = performance.now();
  const state = await (await fetch(`${server.url}api/state`)).json();
  const lobes = fileOf(state, 'lobes');
  const page = await openPage(browser, `${server.url}#/lobes/${lobes ?? ''}`, { width: 1280, height: 800 });
  if (lobes) await page.until(`document.querySelector('.chart-place svg.main-svg .trace path') !== null`, 'the first plot', 30);
  return { server, page, state, lobes, said: `server ready after ${(ready - begun).toFixed(0)} ms, first plot after ${(performance.now() - begun).toFixed(0)} ms` };
}

async function check(browser, program, folder, shots) {
  const problems = [];
  const { server, page, state, lobes, said } = await firstPlot(browser, program, folder);
  const figures = [said];
  const shot = async (name) => shots && writeFileSync(join(shots, `${name}.png`), await page.screenshot());
  const at = { page, state, fileOf: (kind) => fileOf(state, kind), lobes, folder, problems, figures, shot, open: (hash, there) => open(page, hash, there) };
  try {
    const tasks = { moveLobes, editFile, runJob, sendFiles, tapTest, monitorSpindle };
    for (const [name, task] of Object.entries(tasks)) {
      await task(at).catch((error) => problems.push(`${name}: ${error.message}`));
      await shot(name);
    }
    figures.push(`${await look(at)} controls reached by Tab`);
  } finally {
    for (const error of page.errors) if (!/status of 409/.test(error)) problems.push(error); // a conflict is part of the work
    for (const address of new Set(page.requests)) if (!address.startsWith(server.url) && !/^(data|blob):/.test(address)) problems.push(`fetched ${address}`);
    await page.close();
    await server.close();
  }
  return { problems, figures };
}

async function main() {
  const [program, folder] = process.argv.slice(2);
  if (!program || !folder || !existsSync(folder)) {
    console.error('usage: node serve_check.mjs PROGRAM FOLDER [--shots DIR] [--chromium PATH]');
    return 1;
  }
  const shots = argument('--shots', undefined);
  if (shots) mkdirSync(shots, { recursive: true });
  const room = mkdtempSync(join(tmpdir(), 'robomill-serve-'));
  const copy = join(room, basename(resolve(folder)));
  cpSync(folder, copy, { recursive: true });
  const browser = await launch(argument('--chromium', process.env['CHROMIUM'] ?? '/usr/bin/chromium'));
  try {
    const { problems, figures } = await check(browser, resolve(program), copy, shots);
    for (const figure of figures) console.log(figure);
    for (const problem of problems) console.error(problem);
    return problems.length === 0 ? 0 : 1;
  } finally {
    await browser.close();
    rmSync(room, { recursive: true, force: true });
  }
}

process.exitCode = await main().catch((error) => {
  console.error(error.message);
  return 1;
});
