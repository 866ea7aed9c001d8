import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { faultOf } from './api';
import { listen, type Source } from './events';

class Fake implements Source {
  readyState = 0;
  closed = false;
  private listeners = new Map<string, ((event: MessageEvent<string>) => void)[]>();
  addEventListener(type: string, listener: (event: MessageEvent<string>) => void): void {
    this.listeners.set(type, [...(this.listeners.get(type) ?? []), listener]);
  }
  close(): void {
    this.closed = true;
  }
  say(type: string, data: unknown = {}): void {
    for (const listener of this.listeners.get(type) ?? []) listener({ data: JSON.stringify(data) } as MessageEvent<string>);
  }
}

let sources: Fake[];
let heard: string[];
const listener = {
  files: () => void heard.push('files'),
  job: ({ id }: { id: number }) => void heard.push(`job ${id}`),
  tap: (tap: { good: number } | null) => void heard.push(`tap ${tap?.good ?? 'over'}`),
  tapStream: ({ id }: { id: number }) => void heard.push(`tap stream ${id}`),
  monitor: ({ id }: { id: number }) => void heard.push(`monitor ${id}`),
  monitors: () => void heard.push('monitors'),
  connected: (up: boolean) => void heard.push(up ? 'up' : 'down'),
};
const start = () =>
  listen(listener, (path) => {
    expect(path).toBe('/api/events');
    sources.push(new Fake());
    return sources[sources.length - 1]!;
  });

beforeEach(() => {
  sources = [];
  heard = [];
  vi.useFakeTimers();
});
afterEach(() => void vi.useRealTimers());

it('passes on what is said', () => {
  start();
  sources[0]!.say('open');
  sources[0]!.say('files');
  sources[0]!.say('job', { id: 4 });
  sources[0]!.say('tap', { good: 2 });
  sources[0]!.say('tap', null);
  sources[0]!.say('tap-stream', { id: 5, stream: {} });
  sources[0]!.say('monitor', { id: 3 });
  sources[0]!.say('monitors');
  expect(heard).toEqual(['up', 'files', 'job 4', 'tap 2', 'tap over', 'tap stream 5', 'monitor 3', 'monitors']);
});

it('leaves it to the browser to connect anew while that tries', () => {
  start();
  sources[0]!.say('error');
  vi.advanceTimersByTime(60_000);
  expect(sources).toHaveLength(1);
  expect(heard).toEqual(['down']);
});

it('connects anew where the browser gave up, later each time', () => {
  start();
  for (const wait of [1000, 2000, 4000, 8000, 15_000, 15_000]) {
    const last = sources[sources.length - 1]!;
    last.readyState = 2;
    last.say('error');
    vi.advanceTimersByTime(wait - 1);
    expect(sources[sources.length - 1]).toBe(last);
    vi.advanceTimersByTime(1);
    expect(sources[sources.length - 1]).not.toBe(last);
    expect(last.closed).toBe(true);
  }
});

it('ends', () => {
  const end = start();
  sources[0]!.readyState = 2;
  sources[0]!.say('error');
  end();
  vi.advanceTimersByTime(60_000);
  expect(sources).toHaveLength(1);
  expect(sources[0]!.closed).toBe(true);
});

it('fills in what an error has not', () => {
  const got: unknown[] = [];
  const source = new Fake();
  listen({ ...listener, job: ({ error }) => void got.push(error), tapStream: ({ stream }) => void got.push(stream.error) }, () => source);
  source.say('job', { id: 1, error: { text: 'not enough memory for this input' } });
  source.say('job', { id: 2, error: null });
  source.say('tap-stream', { id: 1, stream: { error: { text: 'no broker', hint: 'Start it.' } } });
  expect(got).toEqual([faultOf('not enough memory for this input'), null, { ...faultOf('no broker'), hint: 'Start it.' }]);
});
