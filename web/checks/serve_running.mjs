// What goes on while the application is looked at: a spindle that chatters, a tap test with hits; and the report of a job.
import { copyFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, extname, join } from 'node:path';
import { button } from './hand.mjs';
import { settings, startMonitor, writeCut } from './serve_monitor.mjs';

/** Runs for five minutes, and chatters nearly all the time. */
async function runSpindle({ page, folder, open }) {
  writeFileSync(join(folder, 'looked-at-monitor.toml'), settings);
  writeCut(join(folder, 'looked-at-cut.wav'), 5, [3, 60]);
  await open('#/monitor');
  await startMonitor(page, 'looked-at-monitor.toml', 'looked-at-cut.wav', 1);
  const hash = await page.evaluate(`window.location.hash`);
  return { name: 'monitor-running', hash, there: `document.querySelector('[data-panel="monitor-now"] .state-badge.chatter') !== null && document.querySelector('[aria-label="History"] tbody tr') !== null` };
}

/** Two hits are taken, and it goes on. */
async function runTap({ page, folder, open }, hits) {
  await open(`#/tap/${hits}`, `document.querySelector('[data-panel="tap-start"]') !== null`);
  await button(page, 'Start');
  await page.until(`document.querySelector('[data-panel="tap-count"]') !== null`, 'the tap test begins', 10);
  const beside = join(folder, dirname(hits));
  const records = readdirSync(beside).filter((name) => extname(name) === '.csv' && !name.startsWith('tapped_'));
  for (const [i, name] of records.slice(0, 2).entries()) {
    const tapped = `looked_at_${i}_${name}`;
    copyFileSync(join(beside, name), join(beside, tapped));
    await page.until(`[...document.querySelectorAll('[aria-label="Hits"] td')].some((cell) => cell.textContent === ${JSON.stringify(tapped)})`, `hit ${i + 1} is taken`, 20);
  }
  return { name: 'tap-running', hash: '#/tap', there: `document.querySelector('[data-panel="tap-save"]') !== null && document.querySelector('[data-plot="tap-hits"] svg.main-svg') !== null` };
}

function reportOf(jobs) {
  const done = jobs.filter(({ state, report }) => state === 'done' && report);
  const job = done.findLast(({ verb }) => verb === 'plan') ?? done.at(-1);
  const drawn = `[...document.querySelectorAll('#main figure[data-plot] .canvas')].filter((one) => one.offsetParent && !one.classList.contains('several')).every((one) => one.querySelector('svg.main-svg'))`;
  return job && { name: 'report', hash: `#/jobs/${job.id}`, there: `document.querySelector('#main section') !== null && ${drawn}` };
}

/** Starts what can run in this folder; the views of it. What cannot be looked at is a problem, where a job was to be run. */
export async function startRunning(at, ranJob) {
  const { server, problems } = at;
  const state = await (await fetch(`${server.url}api/state`)).json();
  const views = [];
  const report = reportOf(state.jobs);
  if (report) views.push(report);
  else if (ranJob) problems.push('no job has a report to look at');
  const hits = state.files.find(({ kind }) => kind === 'hits')?.path;
  const starts = { spindle: () => runSpindle(at), ...(hits ? { 'tap test': () => runTap(at, hits) } : {}) };
  for (const [what, start] of Object.entries(starts)) {
    await start().then(
      (view) => views.push(view),
      (error) => problems.push(`${what} to look at: ${error.message}`),
    );
  }
  return views;
}
