// Works the lobes: a slider and the point are dragged, a mode is switched, two settings are overlaid.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { button, click, drag, placeOf, press } from './hand.mjs';
import { redrawsText, watchRedraws } from './serve_times.mjs';

const curve = `(document.querySelector('.chart-place .scatterlayer')?.innerHTML ?? '')`;
const whole = `document.querySelector('.chart-place').dataset.whole === 'true'`;
const controls = '.live-controls';

/** Resolves when the curve differs from before. */
function changes(page, before, what) {
  return page.until(`${curve} !== ${JSON.stringify(before)}`, what, 20);
}

async function dragSlider({ page, figures, problems }, key) {
  const slider = `.slider[data-key="${key}"] input[type=range]`;
  const { width } = await placeOf(page, slider);
  const value = await page.evaluate(`(({ value, min, max }) => (value - min) / (max - min))(document.querySelector('${slider}'))`);
  const from = await placeOf(page, slider, [(8 + value * (width - 16)) / width, 0.5]);
  const before = await page.evaluate(curve);
  await watchRedraws(page);
  const [left, right] = [from.x - value * (width - 16), from.x + (1 - value) * (width - 16)];
  await drag(page, from, { x: left + 0.15 * (right - left), y: from.y }, { steps: 40 });
  await drag(page, { x: left + 0.15 * (right - left), y: from.y }, { x: left + 0.8 * (right - left), y: from.y }, { steps: 80 });
  const released = performance.now();
  await changes(page, before, `${key}: the curve follows the slider`);
  await page.until(whole, `${key}: the whole chart after the slider was let go`, 30);
  const rested = performance.now() - released;
  const redraws = await redrawsText(page, key, problems);
  if (redraws !== null) figures.push(`${key}: ${redraws}; the whole chart ${rested.toFixed(0)} ms after letting go`);
}

async function movePoint({ page, problems }) {
  const says = `document.querySelector('.handle').getAttribute('aria-label')`;
  const before = await page.evaluate(says);
  const from = await placeOf(page, '.handle');
  await drag(page, from, { x: from.x + 60, y: from.y - 50 }, { steps: 15 });
  await page.until(`${says} !== ${JSON.stringify(before)}`, 'the point follows the pointer', 10);
  await page.until(`document.querySelector('.point-facts').dataset.evaluated === 'true'`, 'the point is evaluated where it was let go', 20);
  const dragged = await page.evaluate(says);
  await page.evaluate(`document.querySelector('.handle').focus()`);
  for (const key of ['ArrowRight', 'ArrowUp']) await press(page, key);
  await page.until(`${says} !== ${JSON.stringify(dragged)}`, 'the point follows the arrow keys', 10);
  await page.until(`document.querySelector('.point-facts').dataset.evaluated === 'true'`, 'the point is evaluated after the keys', 20);
  const facts = await page.evaluate(`document.querySelector('.point-facts').textContent`);
  if (!/stable|chatter/.test(facts) || !/Margin/.test(facts)) problems.push(`the point says: ${facts}`);
}

/** What the sliders changed stands in the file after it was shown; then the file is as before. */
async function writeBack({ page, lobes, folder, problems, figures }) {
  const file = join(folder, lobes);
  const before = readFileSync(file, 'utf8');
  await button(page, 'Write into', controls);
  await page.until(`document.querySelector('[data-panel="changes"] tbody tr') !== null`, 'the changes are shown', 10);
  const changes = await page.evaluate(`[...document.querySelectorAll('[data-panel="changes"] tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))`);
  await button(page, 'Write', controls);
  await page.until(`document.querySelector('[data-panel="changes"]') === null`, 'the changes are written', 10);
  const after = readFileSync(file, 'utf8').split('\n');
  for (const [key, , , value] of changes) {
    const last = key.slice(key.lastIndexOf('.') + 1);
    if (!after.some((line) => line.trim().startsWith(last) && line.includes(value))) problems.push(`${key} = ${value} is not in the file`);
  }
  figures.push(`written into the file: ${changes.map(([key, , was, value]) => `${key} ${was} to ${value}`).join(', ')}`);
  writeFileSync(file, before);
}

export async function moveLobes(at) {
  const { page, lobes, open, problems, figures } = at;
  if (!lobes) throw new Error('the folder has no lobes.toml');
  await open(`#/lobes/${lobes}`, `document.querySelector('.chart-place svg.main-svg') !== null`);
  await page.until(whole, 'the whole chart', 30);
  const keys = await page.evaluate(`[...document.querySelectorAll('.slider')].map((slider) => slider.dataset.key)`);
  figures.push(`sliders: ${keys.join(', ')}`);
  for (const key of ['cut.radial_depth_mm', 'tool.teeth', 'coefficients.tangential_n_per_mm2']) if (keys.includes(key)) await dragSlider(at, key);
  await movePoint(at);
  const before = await page.evaluate(curve);
  if (await page.evaluate(`document.querySelectorAll('.modes input').length > 1`)) {
    const last = await page.evaluate(`document.querySelectorAll('.modes input').length`);
    await click(page, `.modes label:nth-of-type(${last}) input`);
    await changes(page, before, 'a mode that is switched off changes the curve');
    await page.until(whole, 'the whole chart without the mode', 30);
  }
  await button(page, 'Keep this curve', controls);
  await page.evaluate(`document.querySelector('.slider[data-key="tool.teeth"] input[type=range], .slider[data-key^="cut."] input[type=range]').focus()`);
  for (let i = 0; i < 3; ++i) await press(page, 'ArrowLeft');
  await page.until(`/kept: /.test(document.querySelector('.chart-place .legend')?.textContent ?? '')`, 'the kept curve in the legend', 20);
  await page.until(`!/same settings/.test(document.querySelector('.chart-place .legend')?.textContent)`, 'the legend says what differs', 20);
  figures.push(`overlaid: ${await page.evaluate(`[...document.querySelectorAll('.chart-place .legendtext')].map((text) => text.textContent).join(' | ')`)}`);
  await page.until(whole, 'the whole chart beside the kept curve', 30);
  await writeBack(at);
  await button(page, 'Reset all', controls);
  await page.until(whole, 'the whole chart after a reset', 30);
  if (!(await page.evaluate(`document.querySelector('.live-controls .buttons button:last-of-type').disabled`))) problems.push('after a reset there are still changes to write');
}
