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

const answer_ms = 60000; // no command takes as long, also where the machine is busy

/**
 * Starts a browser with a fresh profile and more flags. `send(method, params, sessionId)` resolves with the answer, and fails where none comes, the browser ends or
 * the session's page has crashed; `on(listener)` receives every event. When node is interrupted the browser is ended, so that whoever waits for it fails and closes all.
 */
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
  const lost = new Map(); // sessions whose page is gone, and why
  const listeners = [];
  const gone = new Promise((resolve) => {
    child.once('error', (error) => resolve(`cannot start ${executable}: ${error.message}`));
    child.once('exit', (code, signal) => resolve(`${executable} ended with ${signal ?? code}: ${complaint.slice(-500)}`));
  });
  const interrupted = () => child.kill('SIGKILL');
  for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, interrupted);
  const fail = (reason, concerned) => {
    for (const { sessionId, reject } of [...waiting.values()]) if (concerned(sessionId)) reject(new Error(reason));
  };
  gone.then((reason) => {
    dead = reason;
    for (const signal of ['SIGINT', 'SIGTERM']) process.off(signal, interrupted);
    fail(reason, () => true);
  });
  const lose = (session, reason) => {
    lost.set(session, reason);
    fail(reason, (one) => one === session);
  };
  errors.setEncoding('utf8').on('data', (text) => (complaint = (complaint + text).slice(-4000)));
  input.on('error', () => {});
  output.setEncoding('utf8').on('data', (text) => {
    const messages = (buffered + text).split('\0');
    buffered = messages.pop();
    for (const message of messages.map((part) => JSON.parse(part))) {
      if (message.id === undefined) {
        if (message.method === 'Inspector.targetCrashed') lose(message.sessionId, 'the page has crashed');
        if (message.method === 'Target.detachedFromTarget') lose(message.params.sessionId, 'the page was closed');
        for (const listener of listeners) listener(message);
        continue;
      }
      const asked = waiting.get(message.id); // nobody, where it was given up
      if (message.error) asked?.reject(new Error(message.error.message));
      else asked?.resolve(message.result);
    }
  });

  const send = (method, params = {}, sessionId = undefined) =>
    new Promise((resolve, reject) => {
      const reason = dead ?? lost.get(sessionId);
      if (reason !== undefined) return reject(new Error(reason));
      const id = ++last;
      const timer = setTimeout(() => waiting.get(id).reject(new Error(`${method}: no answer within ${answer_ms / 1000} s`)), answer_ms);
      const ends = (act) => (value) => {
        clearTimeout(timer);
        waiting.delete(id);
        act(value);
      };
      waiting.set(id, { sessionId, resolve: ends(resolve), reject: ends(reject) });
      input.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
      return undefined;
    });
  const close = async () => {
    const timer = setTimeout(() => child.kill('SIGKILL'), 5000);
    await send('Browser.close').catch(() => {});
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
  let isLoaded = false;
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
      isLoaded = true;
    }
  });
  for (const domain of ['Inspector', 'Page', 'Runtime', 'Log', 'Network']) await send(`${domain}.enable`);
  await send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
  await send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: scheme }] });
  const { errorText } = await send('Page.navigate', { url });
  if (errorText) throw new Error(`${url}: ${errorText}`);

  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  const poll = async (isTrue, what, seconds) => {
    const end = Date.now() + 1000 * seconds;
    while (!(await isTrue())) {
      if (Date.now() > end) throw new Error(`${what}: not within ${seconds} s; ${errors.join('; ')}`);
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  };
  /** Polls until the expression is true. */
  const until = (expression, what, seconds = 60) => poll(() => evaluate(expression), what, seconds);
  const screenshot = async (clip) => {
    const { data } = await send('Page.captureScreenshot', { format: 'png', captureBeyondViewport: true, ...(clip ? { clip } : {}) });
    return Buffer.from(data, 'base64');
  };
  const close = () => browser.send('Target.closeTarget', { targetId });
  await poll(() => isLoaded, `${url} is loaded`, 60);
  return { send, evaluate, until, screenshot, close, errors, requests };
}
