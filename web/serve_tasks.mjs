// Works the other views: a file is edited, a job is run, files are sent, hits are taken.
import { copyFileSync, existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, extname, join } from 'node:path';
import { chooseFiles, click, fill, press, type } from './hand.mjs';

/** Marks a button by its words, for a selector. */
async function button(page, words) {
  const found = await page.evaluate(`(() => {
    for (const one of document.querySelectorAll('[data-wanted]')) delete one.dataset.wanted;
    const one = [...document.querySelectorAll('#view button')].find((button) => button.textContent.startsWith(${JSON.stringify(words)}) && !button.disabled);
    if (one) one.dataset.wanted = 'true';
    return one !== undefined;
  })()`);
  if (!found) throw new Error(`there is no button "${words}"`);
  await click(page, '[data-wanted]');
}

const ready = `document.querySelector('.editor textarea')?.value.length > 0 && document.querySelector('.fields .field') !== null`;

/** A wrong number in the form is said at its field and marked at its line; a line typed into the text is saved. */
export async function editFile({ page, lobes, folder, problems, open, shot }) {
  await open(`#/job/${lobes}`, ready);
  const field = '.field[data-key="tool.teeth"]';
  const before = await page.evaluate(`document.querySelector('${field} input').value`);
  await fill(page, `${field} input`, '0');
  await page.until(`document.querySelector('${field} .error') !== null`, 'the error stands at its field', 10);
  if (!(await page.evaluate(`/teeth = 0/.test(document.querySelector('.editor textarea').value)`))) problems.push('the form did not change the text');
  if (!(await page.evaluate(`document.querySelector('.line-numbers span') !== null`))) problems.push('the line of the error is not marked');
  await shot('edit-error');
  await fill(page, `${field} input`, before);
  await page.until(`document.querySelector('${field} .error') === null && document.querySelector('.line-numbers span') === null`, 'the error goes', 10);
  await page.evaluate(`(({ value }, area) => { area.focus(); const at = value.search(/^teeth *= */m) + value.match(/^teeth *= */m)[0].length; area.setSelectionRange(at, at + value.slice(at).match(/^\\d+/)[0].length); })(document.querySelector('.editor textarea'), document.querySelector('.editor textarea'))`);
  await type(page, '5');
  await page.until(`document.querySelector('${field} input').value === '5'`, 'the form follows the text', 10);
  await button(page, 'Save');
  await page.until(`[...document.querySelectorAll('#view .muted')].some((one) => one.textContent === 'Saved')`, 'saved', 10);
  if (!/teeth *= *5/.test(readFileSync(join(folder, lobes), 'utf8'))) problems.push('what was typed is not in the file');
  // Someone else writes the file: saving over it must be asked about.
  writeFileSync(join(folder, lobes), readFileSync(join(folder, lobes), 'utf8').replace(/teeth *= *5/, `teeth = ${before}`));
  await fill(page, `${field} input`, '4');
  await page.until(`document.querySelector('${field} input').value === '4' && /teeth = 4/.test(document.querySelector('.editor textarea').value)`, 'changed once more', 10);
  await button(page, 'Save');
  await page.until(`/changed by someone else/.test(document.querySelector('#view').textContent)`, 'the conflict is said', 10);
  await button(page, 'Load their text');
  await page.until(`document.querySelector('${field} input').value === ${JSON.stringify(before)}`, 'their text is loaded', 10);
}

/** A job runs with progress; its report is shown. */
export async function runJob({ page, fileOf, problems, figures, open, shot }) {
  const job = fileOf('job');
  if (!job) return;
  await open(`#/job/${job}`, ready);
  await page.evaluate(`window.seenProgress = []; new MutationObserver(() => { const bar = document.querySelector('.progress progress'); if (bar) window.seenProgress.push(bar.value); }).observe(document.body, { subtree: true, childList: true, attributes: true })`);
  const begun = performance.now();
  await button(page, 'Run the job');
  await page.until(`document.querySelector('[data-panel="run"]') !== null`, 'the job is shown', 20);
  await page.until(`document.querySelector('[data-panel="run"] h2')?.textContent === 'Result'`, 'the job ends', 400);
  const seconds = (performance.now() - begun) / 1000;
  await page.until(`document.querySelector('#main section, [data-panel="run"] .error') !== null`, 'the result', 60);
  const error = await page.evaluate(`document.querySelector('[data-panel="run"] .error')?.textContent ?? ''`);
  if (error !== '') problems.push(`the job: ${error}`);
  await page.until(`[...document.querySelectorAll('#main figure[data-plot] .canvas')].filter((one) => one.offsetParent && !one.classList.contains('several')).every((one) => one.querySelector('svg.main-svg'))`, 'the plots of the report', 60);
  const seen = await page.evaluate(`window.seenProgress`);
  if (seen.length === 0) problems.push('no progress was shown');
  figures.push(`${job}: ${seconds.toFixed(1)} s, progress changed ${new Set(seen).size} times, ${await page.evaluate(`document.querySelectorAll('#main > section').length`)} sections in the report`);
  await shot('job-report');
  const hash = await page.evaluate(`window.location.hash`);
  if (await page.evaluate(`document.querySelector('header + nav a') !== null`)) await click(page, 'header + nav a');
  if ((await page.evaluate(`window.location.hash`)) !== hash) problems.push('a link inside the report leaves the job');
}

/** A recording that is sent is asked about; the answers become a hits.toml. */
export async function sendFiles({ page, state, folder, problems, open, shot }) {
  await open('#/files', `document.querySelector('input[type=file]') !== null`);
  const record = state.files.find(({ kind, path, bytes }) => kind === 'record' && extname(path) === '.csv' && bytes > 1000)?.path;
  const sent = join(dirname(folder), 'sent_x_1.csv');
  if (record) copyFileSync(join(folder, record), sent);
  else writeFileSync(sent, 'time_s,force_n,ax_m_per_s2\n' + Array.from({ length: 2048 }, (_, i) => `${i / 51200},${i === 20 ? 100 : 0},${Math.exp(-i / 300) * Math.sin(i / 8)}`).join('\n') + '\n');
  await chooseFiles(page, 'input[type=file]', [sent]);
  await page.until(`document.querySelector('[data-panel="hits-form"]') !== null`, 'the recording is recognised', 20);
  const empty = await page.evaluate(`[...document.querySelectorAll('.questions input')].filter((box) => box.value === '').map((box, i) => (box.dataset.box = String(i)))`);
  for (const box of empty) await fill(page, `[data-box="${box}"]`, '100');
  await shot('sent');
  const path = await page.evaluate(`document.querySelector('[data-panel="hits-form"] > .buttons input').value`);
  await button(page, 'Write it');
  await page.until(`/Open /.test(document.querySelector('[data-panel="hits-form"]').textContent)`, `${path} is written`, 10);
  if (!existsSync(join(folder, path)) || !/\[\[hits\]\]/.test(readFileSync(join(folder, path), 'utf8'))) problems.push(`${path} has no hits`);
}

/** Hits that appear in the folder are taken one by one. */
export async function tapTest({ page, fileOf, folder, problems, figures, open, shot }) {
  const hits = fileOf('hits');
  if (!hits) return;
  await open(`#/tap/${hits}`, `document.querySelector('[data-panel="tap-start"]') !== null`);
  await button(page, 'Start');
  await page.until(`document.querySelector('[data-panel="tap-count"]') !== null`, 'the tap test begins', 10);
  const beside = join(folder, dirname(hits));
  const records = readdirSync(beside).filter((name) => extname(name) === '.csv');
  for (const [i, name] of records.slice(0, 3).entries()) {
    copyFileSync(join(beside, name), join(beside, `tapped_${i}_${name}`));
    await page.until(`document.querySelectorAll('[aria-label="Hits"] tbody tr').length > ${i}`, `hit ${i + 1} is taken`, 20);
  }
  await page.until(`document.querySelector('[data-plot="tap"] svg.main-svg') !== null`, 'the frequency response is drawn', 20);
  figures.push(`tap test: ${await page.evaluate(`document.querySelector('[data-panel="tap-count"] h2').textContent`)}`);
  await shot('tap-running');
  await press(page, 'Escape');
  await button(page, 'End the tap test');
  await page.until(`document.querySelector('[data-panel="tap-start"]') !== null`, 'the tap test ends', 10);
  if (await page.evaluate(`document.querySelector('[role=alert] .error') !== null`)) problems.push('the tap test ended with an error');
}
