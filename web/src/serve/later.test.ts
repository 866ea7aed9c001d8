import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ApiError, faultOf } from './api';
import { newest } from './later';
import { troubleOf } from './server';

describe('what is asked anew', () => {
  let sent: { signal: AbortSignal; answer: (text: string) => void; fail: (error: unknown) => void }[];
  let got: string[];
  const settle = () => vi.advanceTimersByTimeAsync(0);
  const asker = () =>
    newest<string>(
      (signal) => new Promise((answer, fail) => void sent.push({ signal, answer, fail })),
      (answer) => void got.push(answer),
      (error) => void got.push(`failed: ${(error as Error).message}`),
    );
  beforeEach(() => {
    sent = [];
    got = [];
    vi.useFakeTimers();
  });
  afterEach(() => void vi.useRealTimers());

  it('gives up what was asked before', async () => {
    const one = asker();
    one.ask();
    one.ask();
    expect(sent.map(({ signal }) => signal.aborted)).toEqual([true, false]);
    sent[1]!.answer('new');
    sent[0]!.answer('old'); // comes all the same
    await settle();
    expect(got).toEqual(['new']);
  });
  it('is asked again after a failure, unless it was stopped', async () => {
    const one = asker();
    one.ask();
    sent[0]!.fail(new Error('503'));
    await settle();
    expect(got).toEqual(['failed: 503']);
    await vi.advanceTimersByTimeAsync(10_000);
    expect(sent).toHaveLength(2);
    sent[1]!.answer('yes');
    await vi.advanceTimersByTimeAsync(60_000);
    expect(got).toEqual(['failed: 503', 'yes']);
    one.ask();
    sent[2]!.fail(new Error('500'));
    await settle();
    one.stop();
    await vi.advanceTimersByTimeAsync(60_000);
    expect(sent).toHaveLength(3);
  });
  it('says nothing of what was given up', async () => {
    const one = asker();
    one.ask();
    one.stop();
    sent[0]!.fail(new DOMException('', 'AbortError'));
    await vi.advanceTimersByTimeAsync(60_000);
    expect([got, sent.length]).toEqual([[], 1]);
  });
});

it('says that a server does not answer only where it does not', () => {
  const [silent, broken] = [new ApiError(0, faultOf('silent')), new ApiError(500, faultOf('The server answered 500.'))];
  expect(troubleOf({})).toBeNull();
  expect(troubleOf({ state: null, verbs: broken })).toBe(broken);
  expect(troubleOf({ verbs: broken, events: silent })).toBe(silent);
  expect(troubleOf({ verbs: null, events: null })).toBeNull();
});
