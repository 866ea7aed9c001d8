// Monitors a made-up cut that chatters, as a person would, by input events alone.
import { closeSync, openSync, writeFileSync, writeSync } from 'node:fs';
import { join } from 'node:path';
import { choose, click, fill } from './hand.mjs';

const rate_hz = 5120;
const chatter_hz = 683;

export const settings = `[signal]
sample_rate_hz = ${rate_hz}
anti_alias_filter = true
channels = ["ax_m_per_s2"]
scale = 100
[process]
spindle_speed_rpm = 3000
teeth = 2
`;

/** A minute of a cut at 3000 rpm with two teeth and noise, that chatters from one second to another. Of full scale 100. */
function minute([begins_s, ends_s]) {
  let seed = 1;
  const noise = () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return seed / 2 ** 31 - 1;
  };
  return Int16Array.from({ length: 60 * rate_hz }, (_, i) => {
    const t = i / rate_hz;
    let x = 0.5 * noise();
    for (let k = 1; k <= 6; ++k) x += (4 / k) * Math.sin(2 * Math.PI * 50 * k * t + k);
    if (t > begins_s && t < ends_s) x += Math.min(20, 0.02 * Math.exp((t - begins_s) / 0.05)) * Math.sin(2 * Math.PI * chatter_hz * t);
    return Math.round((32768 * x) / 100);
  });
}

/** That minute, so many times, as WAV of 16 bits. */
export function writeCut(path, minutes, chatters_s = [20, 25]) {
  const samples = Buffer.from(minute(chatters_s).buffer);
  const head = Buffer.alloc(44);
  const bytes = minutes * samples.length;
  head.write('RIFF', 0);
  head.writeUInt32LE(36 + bytes, 4);
  head.write('WAVEfmt ', 8);
  for (const [value, size, at] of [[16, 4, 16], [1, 2, 20], [1, 2, 22], [rate_hz, 4, 24], [2 * rate_hz, 4, 28], [2, 2, 32], [16, 2, 34]]) head.writeUIntLE(value, at, size);
  head.write('data', 36);
  head.writeUInt32LE(bytes, 40);
  const file = openSync(path, 'w');
  writeSync(file, head);
  for (let i = 0; i < minutes; ++i) writeSync(file, samples);
  closeSync(file);
}

const panel = '[data-panel="monitor-start"]';

/** Starts to monitor a recording in the open view. */
export async function startMonitor(page, config, recording, speed) {
  const offered = (name) => `[...document.querySelectorAll('${panel} option')].some(({ value }) => value === ${JSON.stringify(name)})`;
  await page.until(`${offered(config)} && ${offered(recording)}`, 'the form to begin', 20);
  await choose(page, 'Settings', config, panel);
  await choose(page, 'Samples from', recording, panel);
  await page.until(`document.querySelector('${panel} input[type=number]') !== null`, 'the speed', 5);
  const before = await page.evaluate(`window.location.hash`);
  await fill(page, `${panel} input[type=number]`, String(speed)); // ends with Enter, which starts
  await page.until(`window.location.hash !== ${JSON.stringify(before)} && document.querySelector('[data-panel="monitor-now"]') !== null`, 'the spindle is shown', 20);
}

/** How many different colours there are in a picture. */
const colours = (which) => `(() => {
  const canvas = document.querySelectorAll('[data-plot="monitor-live"] canvas')[${which}];
  const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  return new Set(pixels).size;
})()`;

/** The chatter of a recording is found while it is played: state, frequency, picture, history; then it is stopped. */
export async function monitorSpindle({ page, folder, problems, figures, open, shot }) {
  writeFileSync(join(folder, 'made-up-monitor.toml'), settings);
  writeCut(join(folder, 'made-up-cut.wav'), 2, [20, 50]); // at 10 × the chatter is seen for 3 s
  await open('#/monitor');
  const begun = performance.now();
  await startMonitor(page, 'made-up-monitor.toml', 'made-up-cut.wav', 10);
  await page.until(`document.querySelector('[data-panel="monitor-now"] .state-badge.chatter') !== null`, 'chatter is shown', 20);
  figures.push(`monitor: chatter at 20 s of the recording shown ${((performance.now() - begun) / 1000).toFixed(1)} s after the start at 10 ×`);
  await page.until(`/683\\.\\d/.test(document.querySelector('[data-panel="monitor-now"]').textContent)`, 'its frequency is shown', 5);
  await page.until(`document.querySelectorAll('[aria-label="History"] tbody tr.chatter').length >= 1`, 'the alarm stands in the history', 10);
  await shot('monitor-chatter');
  for (const [which, least] of [[0, 30], [1, 4]]) {
    const found = await page.evaluate(colours(which));
    if (found < least) problems.push(`picture ${which + 1} of the monitor has ${found} colours`);
  }
  if (!(await page.evaluate(`[...document.querySelectorAll('[role=status]')].some((one) => /: (chatter|stable)/.test(one.textContent))`))) problems.push('the change of state is not told');
  await click(page, '[aria-label="Spindles"] tbody button');
  if (await page.evaluate(`document.querySelector('[data-panel="confirm"]') !== null`)) await click(page, '[data-panel="confirm"] button.main');
  await page.until(`document.querySelector('[data-panel="monitor-now"]') === null`, 'the spindle is gone', 10);
  if (await page.evaluate(`document.querySelector('[role=alert] .error') !== null`)) problems.push('the monitor ended with an error');
}
