// What the server says of its own accord.
import { wholeFault, wholeTap } from './api';
import type { Job, Tap, TapStreamMessage } from './documents';
import type { MonitorMessage } from './monitor/documents';

export interface Listener {
  files: () => void; // the folder changed
  job: (job: Job) => void;
  tap: (tap: Tap | null) => void;
  tapStream: (message: TapStreamMessage) => void;
  monitor: (message: MonitorMessage) => void;
  monitors: () => void; // one begins, runs, has ended or is gone
  connected: (up: boolean) => void; // what was said while down is lost: ask anew
}

/** What this page uses of an EventSource. */
export interface Source {
  readyState: number;
  addEventListener(type: string, listener: (event: MessageEvent<string>) => void): void;
  close(): void;
}

const closed = 2;
const longest_ms = 15_000;

/** Listens until the function that it gives is called. A browser connects anew by itself unless the server answered with an error: then this does, later each time. */
export function listen(listener: Listener, open: (path: string) => Source = (path) => new EventSource(path)): () => void {
  let source: Source;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let wait_ms = 1000;
  const connect = () => {
    source = open('/api/events');
    const read = <T>(type: string, taken: (data: T) => void) => source.addEventListener(type, ({ data }) => taken(JSON.parse(data) as T));
    source.addEventListener('open', () => {
      wait_ms = 1000;
      listener.connected(true);
    });
    source.addEventListener('error', () => {
      listener.connected(false);
      if (source.readyState !== closed) return;
      source.close();
      timer = setTimeout(connect, wait_ms);
      wait_ms = Math.min(2 * wait_ms, longest_ms);
    });
    read('files', listener.files);
    read('job', (job: Job) => listener.job(wholeFault(job)));
    read('tap', (tap: Tap | null) => listener.tap(wholeTap(tap)));
    read('tap-stream', (message: TapStreamMessage) => listener.tapStream({ ...message, stream: wholeFault(message.stream) }));
    read('monitor', listener.monitor);
    read('monitors', listener.monitors);
  };
  connect();
  return () => {
    clearTimeout(timer);
    source.close();
  };
}
