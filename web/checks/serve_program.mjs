// Works the program: handles and the line are dragged, by mouse, finger and keys; both evaluations are compared; a block is selected in each part.
import { button, choose, click, drag, fill, placeOf, press, swipe } from './hand.mjs';
import { redrawsText, watchRedraws } from './serve_times.mjs';

const knots = `[...document.querySelectorAll('.handle.knot')].map((one) => Number(one.getAttribute('aria-valuenow')))`;
const standing = `document.querySelector('.standing').dataset`;
const evaluated = `${standing}.current === 'true' && ${standing}.shown === 'line'`;
const line = `document.querySelector('.line-margin').textContent`;

const gammaPanel = '[data-panel="gamma"]';
const startPanel = '[data-panel="program-start"]';

/** Runs a job from the view, unless one is done already. */
async function program({ page, fileOf, figures, open, shot }) {
  const there = `document.querySelector('.gamma-place .handle.knot') !== null`;
  await open('#/program', `(${there}) || document.querySelector('${startPanel}') !== null`);
  if (await page.evaluate(there)) return;
  await shot('program-start');
  if (await page.evaluate(`document.querySelector('${startPanel} select') !== null`)) await choose(page, 'Job', fileOf('job'), startPanel);
  const begun = performance.now();
  await button(page, 'Run the job', startPanel);
  await page.until(`(${there}) || document.querySelector('${startPanel} .error') !== null`, 'the job gives a program with a map', 200);
  if (!(await page.evaluate(there))) throw new Error(`the job: ${await page.evaluate(`document.querySelector('${startPanel} .error').textContent`)}`);
  figures.push(`program: the job took ${((performance.now() - begun) / 1000).toFixed(1)} s`);
}

/** Runs in the page: gathers its layouts, frame by frame, until an evaluation begins: a hand that pauses asks for one, and its answer takes room. */
function watchLayout() {
  const begun = document.querySelector('.standing [role=status]').textContent;
  const layouts = new Set();
  let frames = 0;
  let watching = true;
  const look = () => {
    watching &&= document.querySelector('.standing [role=status]').textContent === begun;
    if (!watching) return;
    const places = [...document.querySelectorAll('#view section, .gamma-place, .path-view')].map((one) => one.getBoundingClientRect());
    layouts.add(places.map(({ x, y, width, height }) => [x, y, width, height].map(Math.round).join()).join(' '));
    ++frames;
    requestAnimationFrame(look);
  };
  look();
  window.watchedLayout = () => {
    watching = false;
    return { layouts: layouts.size, frames };
  };
}

/** A handle is dragged; the line and its margin follow, the page keeps its layout, and the server answers for where it was let go. */
async function dragHandle({ page, figures, problems, shot }) {
  const before = await page.evaluate(knots);
  const said = await page.evaluate(line);
  const index = before.length > 2 ? 1 : 0;
  const from = await placeOf(page, `#knot-${index}`);
  await watchRedraws(page);
  await page.evaluate(`(${watchLayout})()`);
  const way = before[index] > 0 ? 60 : -60;
  let live = '';
  await drag(page, from, { x: from.x, y: from.y + way }, { steps: 40, held: async () => void (live = await page.evaluate(line)) });
  const { layouts, frames } = await page.evaluate(`window.watchedLayout()`);
  if (layouts > 1) problems.push(`the page had ${layouts} layouts while a handle was dragged`);
  const after = await page.evaluate(knots);
  if (after[index] === before[index]) problems.push('the handle did not follow the pointer');
  if (after.some((gamma, i) => i !== index && gamma !== before[i])) problems.push('another handle moved, too');
  if (live === said) problems.push('the margin on the map did not follow the handle');
  const released = performance.now();
  await page.until(evaluated, 'the line is re-evaluated', 120);
  const answered = performance.now() - released;
  const redraws = await redrawsText(page, 'γ', problems);
  if (redraws !== null) figures.push(`γ: ${redraws}, the layout looked at in ${frames} frames; re-evaluated ${answered.toFixed(0)} ms after letting go`);
  await shot('program-evaluated');
}

/** By keys one degree and ten; undone in steps. */
async function useKeys({ page, problems }) {
  await page.evaluate(`document.querySelector('#knot-0').focus()`);
  const at = `Number(document.querySelector('#knot-0').getAttribute('aria-valuenow'))`;
  const first = await page.evaluate(at);
  const [one, ten] = first < 0 ? ['ArrowUp', 'PageUp'] : ['ArrowDown', 'PageDown'];
  const sign = first < 0 ? 1 : -1;
  await press(page, one);
  await press(page, ten);
  const moved = await page.evaluate(at);
  if (Math.abs(moved - first - sign * 11) > 0.11) problems.push(`keys moved a handle from ${first} to ${moved}, not by 11`);
  await press(page, one, 8);
  if (Math.abs((await page.evaluate(at)) - moved - sign * 10) > 0.11) problems.push('shift and an arrow key do not move by 10');
  await page.until(evaluated, 'the line is re-evaluated after keys', 120);
  await button(page, 'Undo', gammaPanel);
  if (Math.abs((await page.evaluate(at)) - first) > 0.11) problems.push('undo does not take the keys back');
  await page.until(evaluated, 'the line is re-evaluated after undo', 120);
}

/** The line as a whole, by mouse where no handle is, and by a finger at its grip. */
async function moveWhole({ page, problems }) {
  const shifts = async (what, act) => {
    const before = await page.evaluate(knots);
    await act();
    const after = await page.evaluate(knots);
    const by = after.map((gamma, i) => gamma - before[i]);
    if (Math.abs(by[0]) < 0.5 || by.some((one) => Math.abs(one - by[0]) > 0.25)) problems.push(`${what}: the handles moved by ${by.map((one) => one.toFixed(1)).join(', ')}`);
  };
  await button(page, 'As programmed', gammaPanel);
  const between = await page.evaluate(`(() => {
    const [a, b] = [...document.querySelectorAll('.handle.knot')].slice(0, 2).map((one) => one.getBoundingClientRect());
    return { x: (a.x + b.x + a.width) / 2, y: (a.y + b.y + a.height) / 2 };
  })()`);
  await shifts('the line dragged by the mouse', () => drag(page, between, { x: between.x, y: between.y - 25 }, { steps: 12 }));
  const grip = await placeOf(page, '#grip');
  await shifts('the grip dragged by a finger', () => swipe(page, grip, { x: grip.x, y: grip.y + 30 }));
  await page.evaluate(`document.querySelector('#grip').focus()`);
  await shifts('the grip by keys', () => press(page, 'PageUp'));
  await page.until(evaluated, 'the moved line is re-evaluated', 120);
}

async function changeKnots({ page, problems }) {
  const count = `document.querySelectorAll('.handle.knot').length`;
  const before = await page.evaluate(count);
  await button(page, 'Add a handle', gammaPanel);
  if ((await page.evaluate(count)) !== before + 1) problems.push('no handle was added');
  await page.evaluate(`document.querySelector('#knot-1').focus()`);
  await press(page, 'Delete');
  if ((await page.evaluate(count)) !== before) problems.push('Delete removes no handle');
  if (!(await page.evaluate(`document.activeElement.matches('.handle.knot')`))) problems.push('after a handle was removed none has the focus');
  await fill(page, '[data-panel="knots"] tbody tr td:nth-child(3) input', '7.5');
  if ((await page.evaluate(knots))[0] !== 7.5) problems.push('a typed γ does not move its handle');
  await page.until(evaluated, 'the typed line is re-evaluated', 120);
}

/** What is selected in one part is selected in the others. */
async function selectBlocks({ page, problems }) {
  const selected = `document.querySelector('[data-panel="path"] .steps input').value`;
  const number = await page.evaluate(`document.querySelector('[data-panel="blocks"] tbody tr:nth-child(2) .link').textContent.replace(/\\D/g, '')`);
  await click(page, '[data-panel="blocks"] tbody tr:nth-child(2) .link');
  if ((await page.evaluate(selected)) !== number) problems.push('a block of the table is not selected in the path');
  if (!(await page.evaluate(`document.querySelector('.margin-curve line.selected') !== null`))) problems.push('a block of the table is not marked on the map');
  const place = await placeOf(page, '.gamma-place .nsewdrag', [0.5, 0.6]);
  const clickMap = async () => {
    await drag(page, place, place, { steps: 1 });
    await page.until(`${selected} !== ${JSON.stringify(number)}`, 'a click on the map selects a block', 10);
  };
  await clickMap().catch(clickMap);  // a press while the map is drawn anew for the table's block is lost
  const now = await page.evaluate(selected);
  await click(page, '[data-panel="blocks"] .choice label:last-of-type');
  await page.until(`document.querySelector('[data-panel="blocks"] tr.selected .link')?.textContent.replace(/\\D/g, '') === ${JSON.stringify(now)}`, 'the table shows the block of the map', 10);
}

/** Both evaluations, by the switch. */
async function switchShown({ page, problems, figures }) {
  await click(page, '.standing .choice label:first-of-type');
  if ((await page.evaluate(`${standing}.shown`)) !== 'job') problems.push("the switch does not show the job's numbers");
  const rows = await page.evaluate(`[...document.querySelectorAll('.standing tbody tr')].map((row) => [...row.cells].map(({ textContent }) => textContent).slice(0, 3).join(' '))`);
  figures.push(`program: ${rows.join(' | ')}`);
  await click(page, '.standing .choice label:last-of-type');
  if ((await page.evaluate(`${standing}.shown`)) !== 'line') problems.push('the switch does not show the re-evaluated numbers');
  if (!(await page.evaluate(`/re-evaluated with your γ/.test(document.querySelector('.standing [role=status]').textContent)`))) problems.push('which numbers are shown is not said');
}

export async function workProgram(at) {
  const { page, state, figures, problems } = at;
  if (!at.fileOf('job') || !state.files.some(({ kind }) => kind === 'program')) {
    figures.push('program: the folder has none');
    return;
  }
  await program(at);
  if ((await page.evaluate(`document.querySelector('.path-view canvas') === null`))) problems.push('the path is not drawn');
  for (const part of [dragHandle, useKeys, moveWhole, changeKnots, selectBlocks, switchShown]) await part(at);
  await button(page, 'As chosen', gammaPanel);
  await page.until(evaluated, 'the line as chosen is re-evaluated', 120);
}
