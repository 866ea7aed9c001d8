// Works the other views: a file is edited, a job is run, files are sent, hits are taken.
import { copyFileSync, existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, extname, join } from 'node:path';
import { button, chooseFiles, click, dropFiles, fill, press, type } from './hand.mjs';

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

/** Types and deletes a digit and goes on: a browser commits nothing then. */
async function typeAndDelete(page, selector) {
  await click(page, selector);
  await press(page, 'End');
  await type(page, '1');
  await press(page, 'Backspace');
  await press(page, 'Tab');
}

/** A number box goes on with its slider after a digit was typed and deleted in it. */
async function followSlider({ page, problems, open }, lobes) {
  await open(`#/lobes/${lobes}`, `document.querySelector('.chart-place svg.main-svg') !== null`);
  const [range, box] = ['range', 'number'].map((kind) => `.slider input[type=${kind}]:enabled`);
  const value = `document.querySelector('${box}').value`;
  const before = await page.evaluate(value);
  await typeAndDelete(page, box);
  if ((await page.evaluate(value)) !== before) problems.push('a number box has not what it had before a digit was typed and deleted');
  await page.evaluate(`document.querySelector('${range}').focus()`);
  const key = await page.evaluate(`(({ valueAsNumber, max }) => valueAsNumber < Number(max) ? 'ArrowRight' : 'ArrowLeft')(document.querySelector('${range}'))`);
  await press(page, key);
  await page.until(`${value} !== ${JSON.stringify(before)}`, 'the number box follows its slider', 10);
  await press(page, key === 'ArrowRight' ? 'ArrowLeft' : 'ArrowRight');
}

/** Options stay open while one is typed into, though it is wrong and right by turns. */
async function typeOption({ page, problems }) {
  await click(page, '[data-panel="run-form"] details summary');
  await click(page, '#run-at');
  const text = '6500, 0.8';
  for (const one of text) await type(page, one);
  const [focused, typed] = await page.evaluate(`[document.activeElement.id, document.querySelector('#run-at').value]`);
  if (focused !== 'run-at' || typed !== text) problems.push(`the option that is typed into has "${typed}", the focus is at "${focused}"`);
  await page.evaluate(`document.activeElement.select()`);
  await press(page, 'Backspace'); // Enter would run the job
  if (await page.evaluate(`document.querySelector('[data-panel="run"]') !== null`)) problems.push('a job runs that nobody started');
}

/** What was typed into the form the moment before is in the file that a job reads. */
async function runEdited(at, lobes) {
  const { page, folder, problems } = at;
  const field = '.field[data-key="tool.teeth"] input';
  const before = await page.evaluate(`document.querySelector('${field}').value`);
  await typeAndDelete(page, field);
  if (await page.evaluate(`[...document.querySelectorAll('#view .muted')].some((one) => one.textContent === 'Not saved yet')`)) problems.push('a digit that was typed and deleted is to be saved');
  await click(page, field);
  await page.evaluate(`document.activeElement.select()`);
  await type(page, '7');
  await button(page, 'Save; ');
  await page.until(`document.querySelector('[data-panel="run"]') !== null`, 'the job is shown', 20);
  const written = /teeth *= *(\S+)/.exec(readFileSync(join(folder, lobes), 'utf8'))?.[1];
  if (written !== '7') problems.push(`7 was typed into a field that held ${before}, and the job runs with ${written}`);
  await page.until(`document.querySelector('[data-panel="run"] h2')?.textContent === 'Result'`, 'the job ends', 120);
  await fill(page, field, before);
  await button(page, 'Save');
  await page.until(`[...document.querySelectorAll('#view .muted')].some((one) => one.textContent === 'Saved')`, 'saved as before', 10);
}

/** A verb with an option that it needs: what is missing takes the focus; then its result is shown. */
export async function runVerb(at) {
  const { page, fileOf, problems, open, shot } = at;
  const lobes = fileOf('lobes');
  if (!lobes) return;
  await followSlider(at, lobes);
  await open(`#/job/${lobes}`, `${ready} && document.querySelector('[data-panel="run-form"] details') !== null`);
  await typeOption(at);
  await runEdited(at, lobes);
  await open(`#/job/${lobes}`, `document.querySelector('[data-panel="run-form"] select') !== null`);
  const choices = await page.evaluate(`[...document.querySelectorAll('[data-panel="run-form"] .run-form > label option')].map((one) => one.textContent)`);
  const simulate = choices.findIndex((name) => name.startsWith('Simulate'));
  if (simulate < 0) return void problems.push(`${lobes} cannot be simulated: ${choices.join(', ')}`);
  await page.evaluate(`(() => { const select = document.querySelector('[data-panel="run-form"] .run-form > label select'); select.value = '${simulate}'; select.dispatchEvent(new Event('change', { bubbles: true })); })()`);
  await page.until(`document.querySelector('#run-at') !== null`, 'the options of simulate', 10);
  await button(page, 'Simulate the cut');
  await page.until(`document.activeElement?.id === 'run-at' && document.querySelector('#run-at-error') !== null`, 'what is missing has the focus', 10);
  await shot('run-missing');
  await fill(page, '#run-at', '9000, 0.1');
  await page.until(`document.querySelector('[data-panel="run"] h2')?.textContent === 'Result'`, 'the simulation ends', 120);
  await page.until(`document.querySelector('#main section, [data-panel="run"] .error') !== null`, 'its result', 60);
  const error = await page.evaluate(`document.querySelector('[data-panel="run"] .error')?.textContent ?? ''`);
  if (error !== '') problems.push(`the simulation: ${error}`);
  await shot('run-result');
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
  await page.until(`document.querySelector('[data-panel="run"] h2')?.textContent === 'Result'`, 'the job ends', 200);
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
  const dropped = join(dirname(folder), 'dropped.ngc');
  writeFileSync(dropped, 'G21 G90\nG0 X0 Y0 Z10\nG1 Z0 F60\nG1 X10\n');
  await dropFiles(page, '#view h1', [dropped]);
  await page.until(`[...document.querySelectorAll('#view td, #view th')].some(({ textContent }) => textContent.includes('dropped.ngc'))`, 'a program that is dropped stands in the list', 20);
  if (!existsSync(join(folder, 'dropped.ngc'))) problems.push('a program that was dropped is not in the folder');
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
    const tapped = `tapped_${i}_${name}`;
    copyFileSync(join(beside, name), join(beside, tapped));
    await page.until(`[...document.querySelectorAll('[aria-label="Hits"] td')].some((cell) => cell.textContent === ${JSON.stringify(tapped)})`, `hit ${i + 1} is taken`, 20);
  }
  await page.until(`document.querySelector('[data-plot="tap"] svg.main-svg') !== null`, 'the frequency response is drawn', 20);
  figures.push(`tap test: ${await page.evaluate(`document.querySelector('[data-panel="tap-count"] h2').textContent`)}`);
  await page.until(`document.querySelectorAll('[data-plot="tap-hits"] svg.main-svg').length > 1`, 'the hits are drawn over each other', 20);
  await shot('tap-running');
  // One that was accepted is left out by hand, used again, and all is saved.
  const has = (label) => `document.querySelector('[aria-label="Hits"] button[aria-label^="${label}"]') !== null`;
  if (await page.evaluate(has('Leave out'))) {
    await button(page, 'Leave out');
    await page.until(has('Use'), 'a hit is left out', 20);
    await button(page, 'Use');
    await page.until(`!(${has('Use')})`, 'it is used again', 20);
    await fill(page, '[data-panel="tap-save"] input', 'tapped/tip.uff'); // Enter saves
    await page.until(`document.querySelector('[data-panel="tap-save"] .good') !== null`, 'the FRFs are saved', 20);
    if (!existsSync(join(folder, 'tapped', 'tip.uff'))) problems.push('tapped/tip.uff was not written');
    await button(page, 'Save');
    await page.until(`/is there already/.test(document.querySelector('[data-panel="tap-save"]').textContent)`, 'nothing is overwritten unasked', 20);
    await button(page, 'Replace');
    await page.until(`document.querySelector('[data-panel="tap-save"] .good') !== null`, 'the FRFs are replaced', 20);
  }
  await press(page, 'Escape');
  await button(page, 'End the tap test');
  await page.until(`document.querySelector('[data-panel="tap-start"]') !== null`, 'the tap test ends', 10);
  if (await page.evaluate(`document.querySelector('[role=alert] .error') !== null`)) problems.push('the tap test ended with an error');
}
