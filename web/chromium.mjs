// Drives a headless Chromium over its debugging pipe: no package, no port.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const flags = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--disable-dev-shm-usage',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--hide-scrollbars',
  '--remote-debugging-pipe',
];

/** Starts a browser with a fresh profile and more flags. `send(method, params, sessionId)` resolves with the answer; `on(listener)` receives every event. */
export async function launch(executable, more = []) {
  const profile = mkdtempSync(join(tmpdir(), 'robomill-browser-'));
  const child = spawn(executable, [...flags, ...more, `--user-data-dir=${profile}`, 'about:blank'], {
    stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe'],
  });
  const [, , errors, input, output] = child.stdio;
  let complaint = '';
  let buffered = '';
  let last = 0;
  let dead = null;
  const waiting = new Map();
  const listeners = [];
  const gone = new Promise((resolve) => {
    child.once('error', (error) => resolve(`cannot start ${executable}: ${error.message}`));
    child.once('exit', (code) => resolve(`${executable} ended with ${code}: ${complaint.slice(-500)}`));
  });
  gone.then((reason) => {
    dead = reason;
    for (const { reject } of waiting.values()) reject(new Error(reason));
    waiting.clear();
  });
  errors.setEncoding('utf8').on('data', (text) => (complaint = (complaint + text).slice(-4000)));
  input.on('error', () => {});
  output.setEncoding('utf8').on('data', (text) => {
    const messages = (buffered + text).split('\0');
    buffered = messages.pop();
    for (const message of messages.map((part) => JSON.parse(part))) {
      if (message.id === undefined) {
        for (const listener of listeners) listener(message);
        continue;
      }
      const { resolve, reject } = waiting.get(message.id);
      waiting.delete(message.id);
      if (message.error) reject(new Error(message.error.message));
      else resolve(message.result);
    }
  });

  const send = (method, params = {}, sessionId = undefined) =>
    new Promise((resolve, reject) => {
      if (dead !== null) return reject(new Error(dead));
      const id = ++last;
      waiting.set(id, { resolve, reject });
      input.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
      return undefined;
    });
  const close = async () => {
    await send('Browser.close').catch(() => {});
    const timer = setTimeout(() => child.kill('SIGKILL'), 5000);
    await gone;
    clearTimeout(timer);
    rmSync(profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
  };
  return { send, on: (listener) => listeners.push(listener), close };
}

/** A page at a width and colour scheme; collects its errors and requests from before it loads. A hand (hand.mjs) works it. */
export async function openPage(browser, url, { width, height = 900, scheme = 'light' }) {
  const { targetId } = await browser.send('Target.createTarget', { url: 'about:blank' });
  const { sessionId } = await browser.send('Target.attachToTarget', { targetId, flatten: true });
  const send = (method, params) => browser.send(method, params, sessionId);
  const errors = [];
  const requests = [];
  let loaded;
  const load = new Promise((resolve) => (loaded = resolve));
  browser.on((event) => {
    if (event.sessionId !== sessionId) return;
    const { method, params } = event;
    if (method === 'Runtime.exceptionThrown') {
      const details = params.exceptionDetails;
      errors.push(`script error: ${details.exception?.description ?? details.text}`);
    } else if (method === 'Runtime.consoleAPICalled' && params.type === 'error') {
      errors.push(`console error: ${params.args.map((arg) => arg.value ?? arg.description).join(' ')}`);
    } else if (method === 'Log.entryAdded' && params.entry.level === 'error') {
      errors.push(`browser error: ${params.entry.text} ${params.entry.url ?? ''}`);
    } else if (method === 'Page.javascriptDialogOpening') {
      errors.push(`dialog: ${params.message}`);
      send('Page.handleJavaScriptDialog', { accept: true }).catch(() => {});
    } else if (method === 'Network.requestWillBeSent') {
      requests.push(params.request.url);
    } else if (method === 'Page.loadEventFired') {
      loaded();
    }
  });
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await send(`${domain}.enable`);
  await send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
  await send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: scheme }] });
  const { errorText } = await send('Page.navigate', { url });
  if (errorText) throw new Error(`${url}: ${errorText}`);
  await load;

  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  /** Polls until the expression is true. */
  const until = async (expression, what, seconds = 60) => {
    const end = Date.now() + 1000 * seconds;
    while (!(await evaluate(expression))) {
      if (Date.now() > end) throw new Error(`${what}: not within ${seconds} s; ${errors.join('; ')}`);
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  };
  const screenshot = async (clip) => {
    const { data } = await send('Page.captureScreenshot', { format: 'png', captureBeyondViewport: true, ...(clip ? { clip } : {}) });
    return Buffer.from(data, 'base64');
  };
  const close = () => browser.send('Target.closeTarget', { targetId });
  return { send, evaluate, until, screenshot, close, errors, requests };
}
