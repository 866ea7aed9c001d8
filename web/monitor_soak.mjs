// node monitor_soak.mjs PROGRAM [--hours 8] [--speed 50] [--spindles 1] [--chromium PATH]
// Plays hours of a made-up cut to `PROGRAM serve` with the page open: memory of the server and of the page each simulated hour. Exit 1 where either has grown by more than 8 MiB since the first.
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { launch, openPage } from './chromium.mjs';
import { settings, startMonitor, writeCut } from './serve_monitor.mjs';

const most_grown_mib = 8;

function argument(name, fallback) {
  const at = process.argv.indexOf(name);
  return at > 0 ? process.argv[at + 1] : fallback;
}

function residentMib(pid) {
  return Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;
}

/** Of the page, after its garbage was collected. */
async function pageMemory(page) {
  await page.send('HeapProfiler.collectGarbage');
  const { usedSize } = await page.send('Runtime.getHeapUsage');
  const { nodes } = await page.send('Memory.getDOMCounters');
  return { heap: usedSize / 2 ** 20, nodes };
}

async function serve(program, folder) {
  const child = spawn(program, ['serve', folder, '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  let said = '';
  const url = await new Promise((found, fail) => {
    child.once('exit', (code) => fail(new Error(`${program} serve ended with ${code}`)));
    child.stdout.setEncoding('utf8').on('data', (text) => {
      said += text;
      const address = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
      if (address) found(address[0]);
    });
  });
  return { child, url };
}

async function main() {
  const program = resolve(process.argv[2] ?? '');
  const [hours, speed, spindles] = [argument('--hours', '8'), argument('--speed', '50'), argument('--spindles', '1')].map(Number);
  const folder = mkdtempSync(join(tmpdir(), 'robomill-soak-'));
  writeFileSync(join(folder, 'monitor.toml'), settings);
  writeCut(join(folder, 'cut.wav'), Math.round(60 * hours));
  const { child, url } = await serve(program, folder);
  const browser = await launch(argument('--chromium', process.env['CHROMIUM'] ?? '/usr/bin/chromium'));
  const rows = [];
  try {
    const page = await openPage(browser, `${url}#/monitor`, { width: 1280, height: 800 });
    for (let i = 0; i < spindles; ++i) await startMonitor(page, 'monitor.toml', 'cut.wav', speed);
    console.log('| simulated, h | server, MiB | page, MiB | nodes of the page | alarms |\n|---|---|---|---|---|');
    for (let hour = 1; hour <= hours; ++hour) {
      for (;;) {
        const sessions = await (await fetch(`${url}api/monitors`)).json();
        const slowest = sessions.reduce((one, other) => ((other.frame?.time_s ?? 0) < (one.frame?.time_s ?? 0) ? other : one));
        if ((slowest.frame?.time_s ?? 0) >= 3600 * hour - 30 || sessions.every(({ status }) => status === 'done' || status === 'failed')) {
          const { heap, nodes } = await pageMemory(page);
          rows.push({ server: residentMib(child.pid), heap });
          console.log(`| ${hour} | ${rows[hour - 1].server.toFixed(1)} | ${heap.toFixed(1)} | ${nodes} | ${slowest.alarm_count} |`);
          break;
        }
        await new Promise((done) => setTimeout(done, 500));
      }
    }
    for (const error of page.errors) console.error(error);
    const [first, last] = [rows[0], rows[rows.length - 1]];
    return page.errors.length === 0 && last.server - first.server < most_grown_mib && last.heap - first.heap < most_grown_mib ? 0 : 1;
  } finally {
    await browser.close();
    child.kill('SIGTERM');
    rmSync(folder, { recursive: true, force: true });
  }
}

process.exitCode = await main().catch((error) => {
  console.error(error.message);
  return 1;
});
