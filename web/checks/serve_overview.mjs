// Works the overview of a job: its plan is run, the other views open on its files, a program that is dropped is named in it, a pair of records becomes one hit.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { button, click, dropFiles } from './hand.mjs';

const state = (stage) => `[...document.querySelectorAll('[aria-label="Stages"] tbody tr')].find((row) => row.cells[0].textContent === '${stage}')?.cells[1].textContent`;

/** A hit whose force and response are in files of their own: two files, one [[hits]]. */
async function dropPair({ page, folder, problems }, besideHits) {
  const columns = { force: (i) => (i >= 150 && i < 160 ? 100 * Math.sin((Math.PI * (i - 150)) / 10) : 0), accel: (i) => (i < 150 ? 0 : 20 * Math.exp(-0.02 * (i - 150)) * Math.sin(0.4 * (i - 150))) };
  const names = Object.keys(columns).map((what) => `pair9_${what}.txt`);
  const files = names.map((name) => join(dirname(folder), name));
  Object.entries(columns).forEach(([what, value], k) => {
    const rows = Array.from({ length: 1000 }, (_, i) => `${(1e-4 * i).toFixed(6)} ${value(i).toFixed(9)}`);
    writeFileSync(files[k], `time_s ${what === 'force' ? 'force_n' : 'ax_m_per_s2'}\n${rows.join('\n')}\n`);
  });
  await dropFiles(page, '#view h1', files);
  const form = `document.querySelector('[data-panel="hits-form"] pre')?.textContent ?? ''`;
  await page.until(`/file = \\["[^"]*pair9_force.txt", "[^"]*pair9_accel.txt"\\]/.test(${form})`, 'a pair of records is one hit', 20);
  if (await page.evaluate(`document.querySelectorAll('[data-panel="hits-form"]').length !== 1`)) problems.push('a pair of records that was dropped has several forms');
  for (const name of names) if (!existsSync(join(folder, besideHits, name))) problems.push(`${name} is not beside hits.toml`);
}

/** The first view is the job; its stages follow from what is in the folder. */
export async function openJob({ page, fileOf, folder, problems, open, shot }) {
  const job = fileOf('job');
  if (!job) return;
  const file = join(folder, job);
  const before = readFileSync(file, 'utf8');
  await open(`#/overview/${job}`, `document.querySelectorAll('[aria-label="Stages"] tbody tr').length === 9`);
  await shot('overview');
  if (await page.evaluate(`document.querySelector('button[aria-label^="Run the plan"]') !== null`)) {
    await button(page, 'Run the plan');
    await page.until(`document.querySelector('[data-panel="run"] h2')?.textContent === 'Result'`, 'the plan ends', 200);
    await page.until(`['done', 'guessed', 'no answer'].includes(${state('Decision')})`, 'the decision has a result', 20);
    if (!(await page.evaluate(`/ rpm/.test(document.querySelector('[aria-label="Stages"]').textContent)`))) problems.push('the overview has no limit and no speed');
  }
  // What was computed of another cut says so.
  writeFileSync(file, `${before}\n`);
  await page.until(`${state('Lobes')} === 'outdated'`, 'lobes are outdated once the job changed', 20);
  await shot('overview-outdated');
  await click(page, '.top-bar nav a[href^="#/tap"]');
  await page.until(`document.querySelector('[data-panel="tap-start"] select, [data-panel="tap-count"], #view .notice') !== null`, 'the tap test of the job', 10);
  await click(page, '.top-bar nav a[href^="#/overview"]');
  await page.until(`document.querySelector('[aria-label="Stages"] table') !== null`, 'back to the job', 10);
  const dropped = join(dirname(folder), 'dropped-on-job.ngc');
  writeFileSync(dropped, 'G21 G90\nG0 X0 Y0 Z10\nG1 Z0 F60\nG1 X10\n');
  const named = /^\s*program\s*=/m.test(before);
  await dropFiles(page, '#view h1', [dropped]);
  await page.until(`/dropped-on-job.ngc/.test(document.querySelector('[data-panel="received"]')?.textContent ?? '')`, 'the program is received', 20);
  if (!existsSync(join(folder, dirname(job), 'dropped-on-job.ngc'))) problems.push('a program that was dropped on the job is not beside it');
  if (!named) {
    await page.until(`/job\\.program/.test(document.querySelector('[data-panel="received"]').textContent)`, 'the page says that the job names the program', 20);
    if (!/program = "dropped-on-job\.ngc"/.test(readFileSync(file, 'utf8'))) problems.push('the job does not name the program that was dropped');
    await page.until(`document.querySelector('[aria-label="Stages"] .error') !== null`, 'a program without a robot is said at its stage', 20);
  }
  await dropPair({ page, folder, problems }, dirname(fileOf('hits') ?? job));
  await shot('overview-dropped');
  writeFileSync(file, before);
  if (!named) await page.until(`${state('Program')} === 'not used'`, 'the job is as before', 20);
  await button(page, 'Clear the list');
}
