// Works the overview of a job: its plan is run, the other views open on its files, a program that is dropped is named in it.
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { button, click, dropFiles } from './hand.mjs';

const state = (stage) => `[...document.querySelectorAll('[aria-label="Stages"] tbody tr')].find((row) => row.cells[0].textContent === '${stage}')?.cells[1].textContent`;

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
  await shot('overview-dropped');
  writeFileSync(file, before);
  if (!named) await page.until(`${state('Program')} === 'not used'`, 'the job is as before', 20);
  await button(page, 'Clear the list');
}
