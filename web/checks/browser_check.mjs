// node browser_check.mjs REPORT.html [--shots FOLDER] [--chromium PATH] [--quick]
// Opens a report in headless Chromium and looks: every plot is there, no script error, nothing fetched, nothing too wide. Exit 0 or 1.
// --quick looks at one width only, and at the path with WebGL only.
import { existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { argument, chromiumPath, run } from './arguments.mjs';
import { launch, openPage } from './chromium.mjs';
import { settle } from './hand.mjs';
import { tryDecision, tryPath } from './path_check.mjs';

/** Runs in the page: what each plot shows. A panel without a drawn mark is a missing plot. */
function inspect() {
  const marks = '.scatterlayer .trace path, .heatmaplayer image, .contourlayer path, .scatterlayer .point, .barlayer .point path';
  const plots = [...document.querySelectorAll('figure[data-plot]')].map((figure) => {
    const canvas = figure.querySelector('.canvas');
    const roots = canvas.classList.contains('several') ? [...canvas.children] : [canvas];
    return {
      name: figure.dataset.plot,
      panels: roots.length,
      drawn: roots.filter((root) => root.querySelector('svg.main-svg') && root.querySelector(marks)).length,
      caption: (figure.querySelector('figcaption')?.textContent ?? '').trim().length,
      titles: [...figure.querySelectorAll('.xtitle, .ytitle, .gtitle')].length,
    };
  });
  const bad = [...document.querySelectorAll('svg text')].filter((text) => /NaN|undefined|Infinity/.test(text.textContent)).length;
  // Labels of the drawing: none over another, none outside.
  const drawing = document.querySelector('svg.assembly');
  const labels = drawing ? [...drawing.querySelectorAll('text')].map((text) => text.getBBox()) : [];
  const overlaps = (a, b) => Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x) > 1 && Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y) > 3;
  const room = drawing?.viewBox.baseVal;
  const outside = labels.filter((a) => a.x < -1 || a.x + a.width > room.width + 1 || a.y < -1 || a.y + a.height > room.height + 1).length;
  const over = labels.filter((a, i) => labels.some((b, j) => j > i && overlaps(a, b))).length;
  const root = document.documentElement;
  return { drawing: { labels: labels.length, over, outside }, plots, bad, scroll: root.scrollWidth, inner: window.innerWidth, height: root.scrollHeight, tables: document.querySelectorAll('table').length };
}

const openAll = `for (const part of document.querySelectorAll('details')) part.open = true`;
const allDrawn = `[...document.querySelectorAll('figure[data-plot] .canvas')].every((canvas) =>
  (canvas.classList.contains('several') ? [...canvas.children] : [canvas]).every((root) => root.querySelector('svg.main-svg')))`;

async function look(browser, url, view, problems, shots) {
  const where = `${view.name} (${view.width} px, ${view.scheme})`;
  const page = await openPage(browser, url, view);
  const hasPlots = await page.evaluate(`document.querySelector('figure[data-plot]') !== null`);
  if (hasPlots) {
    await page.until(`document.documentElement.dataset.plots === 'ready'`, `${where}: plots ready`);
    if (shots) writeFileSync(join(shots, `${view.name}.png`), await page.screenshot(await whole(page, view)));
    await page.evaluate(openAll);
    await page.until(allDrawn, 'all drawn', 15).catch(() => {}); // which is missing, inspect says
    await settle(page);
  } else {
    problems.push(`${where}: the report has no plots`);
  }
  const seen = await page.evaluate(`(${inspect})()`);
  for (const plot of seen.plots) {
    if (plot.drawn < plot.panels || plot.panels === 0) problems.push(`${where}: plot ${plot.name}: ${plot.drawn} of ${plot.panels} panels drawn`);
    if (plot.caption === 0) problems.push(`${where}: plot ${plot.name} has no caption`);
    if (plot.titles === 0) problems.push(`${where}: plot ${plot.name} has no title on any axis`);
  }
  const { over, outside } = seen.drawing;
  if (over + outside > 0) problems.push(`${where}: of the drawing's labels ${over} stand over another, ${outside} outside`);
  if (seen.bad > 0) problems.push(`${where}: ${seen.bad} labels read NaN, undefined or Infinity`);
  if (seen.scroll > seen.inner) problems.push(`${where}: ${seen.scroll} px wide in a window of ${seen.inner} px`);
  for (const error of page.errors) problems.push(`${where}: ${error}`);
  const fetched = page.requests.filter((address) => address !== url && !/^(data|blob):/.test(address));
  for (const address of fetched) problems.push(`${where}: fetched ${address}`);
  if (shots) writeFileSync(join(shots, `${view.name}-open.png`), await page.screenshot(await whole(page, view)));
  await tryPath(page, where, problems, view);
  if (view.controls) await tryDecision(page, where, problems);
  if (hasPlots && view.controls) await tryControls(page, where, problems);
  if (hasPlots && view.controls) await tryResize(page, where, problems, view);
  if (hasPlots && view.controls) await tryPrint(page, where, problems, shots && join(shots, `${view.name}-print.png`));
  await page.close();
  return seen;
}

async function whole(page, view) {
  const height = await page.evaluate('document.documentElement.scrollHeight');
  return { x: 0, y: 0, width: view.width, height: Math.min(height, 16000), scale: 1 };
}

/** Every radio button is chosen once; each FRF must then be the one drawn. */
async function tryControls(page, where, problems) {
  const count = await page.evaluate(`document.querySelectorAll('fieldset.choice input').length`);
  for (let i = 0; i < count; ++i) {
    await page.evaluate(`document.querySelectorAll('fieldset.choice input')[${i}].click()`);
    await settle(page);
  }
  const names = await page.evaluate(`[...document.querySelectorAll('[data-plot="frf"] fieldset.choice')]
    .filter((group) => group.querySelector('legend').textContent === 'FRF')
    .flatMap((group) => [...group.querySelectorAll('label span')].map((span) => span.textContent))`);
  for (const [i, name] of names.entries()) {
    await page.evaluate(`document.querySelectorAll('[data-plot="frf"] fieldset.choice input')[${i}].click()`);
    await page.until(`document.querySelector('[data-plot="frf"] .ytitle')?.textContent.startsWith('|' + ${JSON.stringify(name)} + '|')`,
      `${where}: FRF ${name} chosen`, 10);
  }
  for (const error of page.errors) if (!problems.some((problem) => problem.endsWith(error))) problems.push(`${where}: ${error}`);
}

/** A window that becomes narrower and wide again, as a telephone does that is turned, leaves every plot as high as it was. */
async function tryResize(page, where, problems, { width }) {
  const heights = `JSON.stringify([...document.querySelectorAll('.canvas svg.main-svg')].map((svg) => Math.round(svg.getBoundingClientRect().height)))`;
  const fitted = `[...document.querySelectorAll('figure[data-plot] .canvas:not(.several)')].every((canvas) =>
    canvas.offsetParent === null || Math.abs(canvas.querySelector('svg.main-svg').getBoundingClientRect().width - canvas.clientWidth) < 2)`;
  const before = await page.evaluate(heights);
  for (const now of [width - 200, width, width - 200, width]) {
    await page.send('Emulation.setDeviceMetricsOverride', { width: now, height: 900, deviceScaleFactor: 1, mobile: false });
    await page.until(`window.innerWidth === ${now} && ${fitted}`, `${where}: plots at ${now} px`, 15);
  }
  const after = await page.evaluate(heights);
  if (before !== after) problems.push(`${where}: plots are ${before} px high, and ${after} px after the window was resized`);
}

/** On paper (A4 between its margins) no plot may be wider than the page, nor keep the dark colours. */
async function tryPrint(page, where, problems, shot) {
  const width = 688;
  await page.send('Emulation.setDeviceMetricsOverride', { width, height: 970, deviceScaleFactor: 1, mobile: false });
  await page.send('Emulation.setEmulatedMedia', { media: 'print', features: [{ name: 'prefers-color-scheme', value: 'dark' }] });
  await page.evaluate(`window.dispatchEvent(new Event('beforeprint'))`);
  await settle(page);
  const widest = await page.evaluate(`Math.max(...[...document.querySelectorAll('svg.main-svg')].map((svg) => svg.getBoundingClientRect().right))`);
  if (widest > width) problems.push(`${where}: printed, a plot reaches ${widest} px on ${width} px of paper`);
  const ink = await page.evaluate(`getComputedStyle(document.querySelector('.xtitle')).fill`);
  if (!/rgb\(28, 36, 48\)/.test(ink)) problems.push(`${where}: printed, axis titles are ${ink}`);
  if (shot) writeFileSync(shot, await page.screenshot(await whole(page, { width })));
  await page.evaluate(`window.dispatchEvent(new Event('afterprint'))`);
}

/** Once more in a browser without WebGL, if the report has a path. */
async function lookWithoutWebgl(chromium, url, name, problems, shots) {
  const browser = await launch(chromium, ['--disable-3d-apis']);
  try {
    const view = { name: `${name}-plane`, width: 1280, scheme: 'light', controls: true, painter: 'canvas' };
    const page = await openPage(browser, url, view);
    await page.until(`document.documentElement.dataset.plots === 'ready'`, 'plots ready');
    await tryPath(page, `${view.name} (${view.width} px, ${view.scheme})`, problems, view);
    if (shots) writeFileSync(join(shots, `${view.name}.png`), await page.screenshot(await whole(page, view)));
  } finally {
    await browser.close();
  }
}

async function main() {
  const file = process.argv[2];
  if (!file || file.startsWith('--') || !existsSync(file)) {
    console.error(`usage: node browser_check.mjs REPORT.html [--shots FOLDER] [--chromium PATH] [--quick]${file ? `; no file ${file}` : ''}`);
    return 1;
  }
  const shots = argument('--shots', undefined);
  if (shots) mkdirSync(shots, { recursive: true });
  const url = pathToFileURL(resolve(file)).href;
  const name = basename(file, '.html');
  const views = [
    { name: `${name}-light`, width: 1280, scheme: 'light', controls: true },
    { name: `${name}-dark`, width: 1280, scheme: 'dark' },
    { name: `${name}-narrow`, width: 360, scheme: 'light' },
  ];
  const problems = [];
  const chromium = chromiumPath();
  const quick = process.argv.includes('--quick');
  const browser = await launch(chromium);
  try {
    let seen;
    for (const view of quick ? views.slice(0, 1) : views) seen = await look(browser, url, view, problems, shots);
    if (!quick) await lookWithoutWebgl(chromium, url, name, problems, shots);
    if (problems.length === 0) {
      console.log(`${file}: ${seen.plots.map((plot) => `${plot.name} (${plot.panels})`).join(', ')}; ${seen.drawing.labels} labels in the drawing; ${seen.tables} tables; no error, nothing fetched`);
    }
  } finally {
    await browser.close();
  }
  for (const problem of problems) console.error(problem);
  return problems.length === 0 ? 0 : 1;
}

await run(main);
