// node serve_soak.mjs PROGRAM [--minutes N] [--speed X] [--spindles N] [--chromium PATH]
// Monitors a recording of N minutes (480) at X times its speed (50) in the application, by so many spindles (1), and says how memory of server and page goes. Exit 1
// where either grows by more than 10 MB between the second tenth of the run and its last, or where a spindle does not come to the end of the recording with an alarm.
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { chromiumPath, numberArgument, run } from './arguments.mjs';
import { launch, openPage } from './chromium.mjs';
import { settings, startMonitor, writeCut } from './serve_monitor.mjs';
import { serve } from './serve_start.mjs';

const config = 'soak-monitor.toml';
const recording = 'soak-cut.wav';
const growth_mb = 10;
const lines = 24; // that are printed

/** Resident memory of a process and those that it started, without what they map of files (MB). */
function resident(pid) {
  const own = Number(/RssAnon:\s+(\d+) kB/.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;
  const started = readdirSync(`/proc/${pid}/task`).flatMap((thread) => readFileSync(`/proc/${pid}/task/${thread}/children`, 'utf8').split(' ').filter(Boolean));
  return started.reduce((sum, child) => sum + resident(child), own);
}

/** What the page's script holds after a collection, and its count of elements. */
async function held(page) {
  await page.send('HeapProfiler.collectGarbage');
  const { usedSize } = await page.send('Runtime.getHeapUsage');
  const { nodes } = await page.send('Memory.getDOMCounters');
  return { page_mb: usedSize / 2 ** 20, nodes };
}

/** Where the spindles stand: how far the one is that is furthest behind (s), and the fewest alarms. */
async function spindles({ url }) {
  const answer = await fetch(`${url}api/monitors`, { signal: AbortSignal.timeout(10000) });
  const sessions = await answer.json();
  const failed = sessions.find(({ status }) => status === 'failed');
  if (failed) throw new Error(`spindle ${failed.id} failed: ${JSON.stringify(failed.error)}`);
  return {
    time_s: Math.min(...sessions.map(({ frame }) => frame?.time_s ?? 0)),
    alarms: Math.min(...sessions.map(({ alarm_count }) => alarm_count)),
    over: sessions.every(({ status }) => status === 'done'),
  };
}

/** Until every spindle is done; one that takes twice as long as it should does not advance. */
async function watch(page, server, minutes, speed) {
  const begun = performance.now();
  const length_s = (60 * minutes) / speed;
  const pause_ms = Math.min(5000, Math.max(200, (1000 * length_s) / 100));
  const rows = [];
  console.log('| of the recording, min | server, MB | page, MB | nodes of the page | alarms |\n|---|---|---|---|---|');
  for (let printed = 0; ; ) {
    await new Promise((done) => setTimeout(done, pause_ms));
    const { time_s, alarms, over } = await spindles(server);
    const row = { server_mb: resident(server.pid), ...(await held(page)) };
    if (!over) rows.push(row);
    if (over || time_s / 60 >= ((printed + 1) * minutes) / lines) {
      console.log(`| ${(time_s / 60).toFixed(1)} | ${row.server_mb.toFixed(1)} | ${row.page_mb.toFixed(1)} | ${row.nodes} | ${alarms} |`);
      printed = Math.floor((time_s / 60 / minutes) * lines);
    }
    if (over) return { rows, time_s, alarms };
    if (performance.now() - begun > 1000 * (2 * length_s + 60)) throw new Error(`after ${(2 * length_s + 60).toFixed(0)} s the recording is at ${(time_s / 60).toFixed(1)} of ${minutes} minutes`);
  }
}

const mean = (rows, key) => rows.reduce((sum, row) => sum + row[key], 0) / rows.length;

/** How much each grew from the second tenth of the run to its last. */
function grown(rows) {
  const tenth = Math.floor(rows.length / 10);
  if (tenth < 1) throw new Error(`memory was looked at ${rows.length} times only: give more minutes, or less speed`);
  const [early, late] = [rows.slice(tenth, 2 * tenth), rows.slice(-tenth)];
  return { server_mb: mean(late, 'server_mb') - mean(early, 'server_mb'), page_mb: mean(late, 'page_mb') - mean(early, 'page_mb') };
}

/** What is wrong after the run. */
async function soak(page, server, { minutes, speed, count }) {
  const idle_mb = resident(server.pid);
  for (let i = 0; i < count; ++i) await startMonitor(page, config, recording, speed);
  const { rows, time_s, alarms } = await watch(page, server, minutes, speed);
  const { server_mb, page_mb } = grown(rows);
  console.log(`server idle ${idle_mb.toFixed(1)} MB; growth of the server ${server_mb.toFixed(1)} MB, of the page ${page_mb.toFixed(1)} MB`);
  const problems = [...page.errors];
  if (!(server_mb <= growth_mb)) problems.push(`the server has grown by ${server_mb.toFixed(1)} MB`);
  if (!(page_mb <= growth_mb)) problems.push(`the page has grown by ${page_mb.toFixed(1)} MB`);
  if (time_s < 60 * minutes - 5) problems.push(`the recording ended at ${time_s.toFixed(0)} s of ${60 * minutes} s`);
  if (alarms < 1) problems.push('there was no alarm');
  const shown = await page.evaluate(`document.querySelectorAll('[aria-label="History"] tbody tr.chatter').length`);
  if (shown < 1) problems.push('the page shows no alarm');
  return problems;
}

async function main() {
  const program = process.argv[2];
  if (!program || program.startsWith('--') || !existsSync(program)) {
    console.error('usage: node serve_soak.mjs PROGRAM [--minutes N] [--speed X] [--spindles N] [--chromium PATH]');
    return 1;
  }
  const [minutes, speed, count] = [Math.ceil(numberArgument('--minutes', 480)), numberArgument('--speed', 50), Math.ceil(numberArgument('--spindles', 1))];
  const folder = mkdtempSync(join(tmpdir(), 'robomill-soak-'));
  let browser;
  let server;
  try {
    writeFileSync(join(folder, config), settings);
    writeCut(join(folder, recording), minutes);
    browser = await launch(chromiumPath());
    server = await serve(resolve(program), folder);
    const page = await openPage(browser, `${server.url}#/monitor`, { width: 1280, height: 800 });
    const problems = await soak(page, server, { minutes, speed, count });
    for (const problem of problems) console.error(problem);
    return problems.length === 0 ? 0 : 1;
  } finally {
    await Promise.allSettled([browser?.close(), server?.close()]);
    rmSync(folder, { recursive: true, force: true });
  }
}

await run(main);
