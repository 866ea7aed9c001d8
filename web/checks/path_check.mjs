// Looks at the path in three dimensions of an open report: it is drawn, and a click in it, in a plot or on a link of the decision selects a block.
import { clickAt, placeOf, press, settle } from './hand.mjs';

/** Runs in the page: how many pixels are coloured, and where in the window one of them is. */
function coloured() {
  const drawn = document.querySelector('.path-view canvas');
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [drawn.width, drawn.height];
  const context = copy.getContext('2d');
  context.drawImage(drawn, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  const found = [];
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b, a] = data.subarray(i, i + 4);
    if (a > 250 && Math.max(r, g, b) - Math.min(r, g, b) > 60) found.push(i / 4);
  }
  const box = drawn.getBoundingClientRect();
  const middle = found[Math.floor(found.length / 2)] ?? 0;
  const ratio = copy.width / box.width;
  return { count: found.length, x: box.x + ((middle % copy.width) + 0.5) / ratio, y: box.y + (Math.floor(middle / copy.width) + 0.5) / ratio };
}

const selected = `document.querySelector('.path input[type=number]').value`;

/** Nothing where the report has no path. */
export async function tryPath(page, where, problems, { controls, painter = 'webgl' }) {
  if (!(await page.evaluate(`document.querySelector('.path') !== null`))) return;
  const used = await page.evaluate(`document.querySelector('.path').dataset.painter`);
  if (used !== painter) problems.push(`${where}: the path is drawn by ${used}, not by ${painter}`);
  await placeOf(page, '.path-view');
  await settle(page);
  const seen = await page.evaluate(`(${coloured})()`);
  if (seen.count < 300) problems.push(`${where}: the path has ${seen.count} coloured pixels`);
  if (!controls) return;
  await clickAt(page, seen);
  const byClick = await page.evaluate(selected);
  if (byClick === '') problems.push(`${where}: a click on the path selects no block`);
  if (!(await page.evaluate(`document.querySelector('[data-plot="program-limit"] .shapelayer path') !== null`))) {
    problems.push(`${where}: the block that was clicked is not marked in the plot`);
  }
  await page.evaluate(`document.querySelector('.path-view').focus()`);
  await press(page, 'ArrowLeft');
  const turned = await page.evaluate(`(${coloured})()`);
  if (turned.x === seen.x && turned.y === seen.y && turned.count === seen.count) problems.push(`${where}: the arrow key does not turn the path`);
  await clickInPlot(page, 'program-limit');
  await page.until(`${selected} !== '' && ${selected} !== ${JSON.stringify(byClick)}`, `${where}: a click in the plot selects another block`, 10);
}

async function clickInPlot(page, plot) {
  await placeOf(page, `[data-plot="${plot}"]`);
  await settle(page);
  await clickAt(page, await placeOf(page, `[data-plot="${plot}"] .nsewdrag`, [0.31, 0.5]));
}

/** A link of the decision goes to its block in the path, a click in the map over γ selects one; nothing where the report has no decision on a path. */
export async function tryDecision(page, where, problems) {
  if (!(await page.evaluate(`document.querySelector('#decision') !== null && document.querySelector('.path') !== null`))) return;
  const link = `document.querySelector('#decision a.block-link')`;
  const named = await page.evaluate(`${link}.textContent.match(/block (\\d+)/)[1]`);
  await page.evaluate(`${link}.focus()`);
  await press(page, 'Enter');
  await page.until(`${selected} === '${named}'`, `${where}: the link selects block ${named}`, 10);
  await page.until(`(({ top, bottom }) => top < window.innerHeight && bottom > 0)(document.querySelector('.path-view').getBoundingClientRect())`, `${where}: the link goes to the path`, 10);
  if (!(await page.evaluate(`document.querySelector('[data-plot="gamma-map"]') !== null`))) return;
  const marked = `(document.querySelector('[data-plot="gamma-map"] .shapelayer path')?.getAttribute('d') ?? '')`;
  await page.until(`${marked} !== ''`, `${where}: the linked block is marked in the map over γ`, 10);
  const before = await page.evaluate(marked);
  await clickInPlot(page, 'gamma-map');
  await page.until(`${selected} !== '${named}' && ${marked} !== ${JSON.stringify(before)}`, `${where}: a click in the map over γ selects another block`, 10);
  const facts = await page.evaluate(`document.querySelector('#decision [aria-live]').textContent`);
  if (!facts.includes(await page.evaluate(selected))) problems.push(`${where}: nothing is said of the place that was clicked in the map over γ`);
}
