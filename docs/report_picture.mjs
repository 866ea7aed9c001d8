// node docs/report_picture.mjs [BUILD] [--chromium PATH]
// Makes docs/report.png, the picture of README.md: the recommended cut and the stability lobes of the report that examples/new-tool gives. BUILD is build/ unless given.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { chromiumPath, run } from '../web/checks/arguments.mjs';
import { launch, openPage } from '../web/checks/chromium.mjs';
import { settle } from '../web/checks/hand.mjs';

const root = resolve(fileURLToPath(import.meta.url), '../..');
const view = { width: 1220, height: 900 };

/** Runs in the page: leaves the two sections, side by side, without what can be unfolded in them. */
function leaveTwoSections() {
  const kept = [document.querySelector('main > .hero'), document.getElementById('lobes')];
  const hide = (part) => (part.style.display = 'none');
  for (const part of document.querySelectorAll('#page > *, main > *')) if (!kept.some((one) => part.contains(one))) hide(part);
  document.querySelectorAll('#lobes details, .modebar-container').forEach(hide);
  const main = document.querySelector('main');
  main.style.cssText = 'display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 1rem; max-width: none; padding: 0 1rem';
  for (const cell of main.querySelectorAll('th, td')) cell.style.paddingInline = '0.25rem';
  window.dispatchEvent(new Event('resize'));
}

async function picture(report, file) {
  const browser = await launch(chromiumPath());
  try {
    const page = await openPage(browser, pathToFileURL(report).href, view);
    await page.until(`document.documentElement.dataset.plots === 'ready'`, 'plots ready');
    await page.evaluate(`(${leaveTwoSections})()`);
    await settle(page);
    const height = await page.evaluate(`Math.ceil(document.querySelector('main').getBoundingClientRect().bottom + window.scrollY)`);
    writeFileSync(file, await page.screenshot({ x: 0, y: 0, width: view.width, height, scale: 1 }));
  } finally {
    await browser.close();
  }
}

await run(async () => {
  const build = process.argv[2] && !process.argv[2].startsWith('--') ? process.argv[2] : join(root, 'build');
  const out = mkdtempSync(join(tmpdir(), 'robomill-picture-'));
  try {
    execFileSync(join(build, 'robomill'), ['plan', join(root, 'examples/new-tool/job.toml'), '-o', out], { stdio: ['ignore', 'ignore', 'inherit'] });
    await picture(join(out, 'report.html'), join(root, 'docs/report.png'));
  } finally {
    rmSync(out, { recursive: true });
  }
  return 0;
});
