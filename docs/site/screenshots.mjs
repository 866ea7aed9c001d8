// node docs/site/screenshots.mjs [BUILD] [--only NAME] [--chromium PATH]
// Makes the pictures of pictures/pictures.json from the running product: runs the commands of each in a copy of the examples, and takes the named sections of the page,
// or the image that a command makes.
// Writes the hash of its sources beside it; docs/site/check_pictures fails where they have changed since. BUILD is build/ unless given.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { copyFileSync, cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { argument, chromiumPath, run } from '../../web/checks/arguments.mjs';
import { launch, openPage } from '../../web/checks/chromium.mjs';
import { settle } from '../../web/checks/hand.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const root = resolve(here, '../..');
const list = join(here, 'pictures/pictures.json');
const view = { width: 900, height: 900 };

/** Of each source its path and content; as check_pictures has it. */
function hashOf(sources) {
  const hash = createHash('sha256');
  for (const path of [...sources].sort()) {
    const content = readFileSync(join(root, path));
    hash.update(`${path}\0${content.length}\0`).update(content);
  }
  return hash.digest('hex');
}

/** Runs in the page: leaves some sections, without what can be unfolded in them. */
function leaveSections(ids) {
  const kept = ids.map((id) => document.getElementById(id));
  if (kept.some((one) => one === null)) throw new Error(`no such section: ${ids}; there are ${[...document.querySelectorAll('main [id]')].map(({ id }) => id)}`);
  const hide = (part) => (part.style.display = 'none');
  for (const part of document.querySelectorAll('#page > *, main > *')) if (!kept.some((one) => part.contains(one))) hide(part);
  document.querySelectorAll('details, .modebar-container').forEach(hide);
  window.dispatchEvent(new Event('resize'));
}

async function picture(browser, { page: file, sections, height: most }, scratch, target) {
  const page = await openPage(browser, pathToFileURL(join(scratch, file)).href, view);
  await page.until(`document.documentElement.dataset.plots === 'ready'`, 'plots ready');
  await page.evaluate(`(${leaveSections})(${JSON.stringify(sections)})`);
  await settle(page);
  await page.until(`document.documentElement.dataset.plots === 'ready'`, 'plots ready');
  const height = await page.evaluate(`Math.ceil(document.querySelector('main').getBoundingClientRect().bottom + window.scrollY)`);
  writeFileSync(target, await page.screenshot({ x: 0, y: 0, width: view.width, height: Math.min(height, most ?? height), scale: 1 }));
}

async function make(one, build, browser) {
  const scratch = mkdtempSync(join(tmpdir(), 'robomill-pictures-'));
  try {
    for (const folder of ['examples', 'data', 'python/examples']) cpSync(join(root, folder), join(scratch, folder), { recursive: true });
    for (const [to, from] of Object.entries(one.copies ?? {})) copyFileSync(join(root, from), join(scratch, to));
    const env = { ...process.env, PYTHONPATH: join(build, 'python'), PYTHONDONTWRITEBYTECODE: '1', MPLBACKEND: 'Agg' };
    for (const [program, ...words] of one.commands) execFileSync(resolve(build, program), words, { cwd: scratch, stdio: ['ignore', 'ignore', 'inherit'], env });
    const target = join(here, 'pictures', one.picture);
    if (one.image) copyFileSync(join(scratch, one.image), target);
    else await picture(browser, one, scratch, target);
    one.sha256 = hashOf(one.sources);
    console.log(one.picture);
  } finally {
    rmSync(scratch, { recursive: true });
  }
}

await run(async () => {
  const build = resolve(process.argv[2] && !process.argv[2].startsWith('--') ? process.argv[2] : join(root, 'build'));
  const only = argument('--only', '');
  const pictures = JSON.parse(readFileSync(list, 'utf8'));
  const browser = await launch(chromiumPath());
  try {
    for (const one of pictures) if (!only || one.picture === only) await make(one, build, browser);
  } finally {
    await browser.close();
  }
  const keys = (one) => Object.entries(one).map(([key, value]) => `    ${JSON.stringify(key)}: ${JSON.stringify(value)}`);
  writeFileSync(list, `[\n${pictures.map((one) => `  {\n${keys(one).join(',\n')}\n  }`).join(',\n')}\n]\n`);
  return 0;
});
