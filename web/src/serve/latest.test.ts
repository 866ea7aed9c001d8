import { beforeEach, expect, it } from 'vitest';
import { Latest } from './latest';

interface Sent {
  question: string;
  sequence: number;
  signal: AbortSignal;
  answer: (text: string) => void;
  fail: (error: Error) => void;
}

let sent: Sent[];
let got: string[];
let latest: Latest<string, string>;
const settled = () => new Promise<void>((resolve) => setTimeout(resolve, 0));

beforeEach(() => {
  sent = [];
  got = [];
  latest = new Latest<string, string>({
    ask: (question, sequence, signal) => new Promise((answer, fail) => void sent.push({ question, sequence, signal, answer, fail })),
    interruptible: (question) => question.startsWith('slow'),
    answered: (answer, question) => void got.push(`${question}: ${answer}`),
    failed: (error, question) => void got.push(`${question} failed: ${(error as Error).message}`),
    drawn: async () => {},
  });
});

const questions = () => sent.map(({ question }) => question);

it('has one question under way and keeps the newest of those that wait', async () => {
  for (const question of ['a', 'b', 'c', 'd']) latest.put(question);
  expect(questions()).toEqual(['a']);
  sent[0]!.answer('1');
  await settled();
  expect(questions()).toEqual(['a', 'd']);
  sent[1]!.answer('2');
  await settled();
  expect(got).toEqual(['a: 1', 'd: 2']);
  expect(questions()).toEqual(['a', 'd']);
});

it('counts upwards', async () => {
  latest.put('a');
  sent[0]!.answer('1');
  await settled();
  latest.put('slow b');
  latest.put('c');
  expect(sent.map(({ sequence }) => sequence)).toEqual([1, 2, 3]);
});

it('sends what waits after the answer is drawn, the newest then', async () => {
  let draw = () => {};
  latest = new Latest<string, string>({
    ask: (question, sequence, signal) => new Promise((answer, fail) => void sent.push({ question, sequence, signal, answer, fail })),
    interruptible: (question) => question.startsWith('slow'),
    answered: (answer) => void got.push(answer),
    failed: () => {},
    drawn: () => new Promise((resolve) => void (draw = resolve)),
  });
  latest.put('a');
  latest.put('b');
  sent[0]!.answer('1');
  await settled();
  expect(got).toEqual(['1']);
  latest.put('slow c');
  expect(questions()).toEqual(['a']);
  draw();
  await settled();
  expect(questions()).toEqual(['a', 'slow c']);
  sent[1]!.answer('2');
  await settled();
  latest.put('d'); // does not wait for the drawing of what it interrupts
  expect(questions()).toEqual(['a', 'slow c', 'd']);
  draw();
  await settled();
  expect(questions()).toEqual(['a', 'slow c', 'd']);
});

it('gives a slow question up for a newer one, whose answer alone counts', async () => {
  latest.put('slow');
  latest.put('a');
  expect(questions()).toEqual(['slow', 'a']);
  expect(sent[0]!.signal.aborted).toBe(true);
  sent[1]!.answer('new');
  sent[0]!.answer('stale');
  await settled();
  expect(got).toEqual(['a: new']);
});

it('drops what fails late, too', async () => {
  latest.put('slow');
  latest.put('a');
  sent[0]!.fail(new Error('superseded'));
  await settled();
  expect(got).toEqual([]);
  expect(questions()).toEqual(['slow', 'a']);
});

it('goes on after a failure', async () => {
  latest.put('a');
  latest.put('b');
  sent[0]!.fail(new Error('bad input'));
  await settled();
  sent[1]!.answer('2');
  await settled();
  expect(got).toEqual(['a failed: bad input', 'b: 2']);
});

it('stops', async () => {
  latest.put('a');
  latest.put('b');
  latest.stop();
  expect(sent[0]!.signal.aborted).toBe(true);
  sent[0]!.answer('1');
  await settled();
  expect(got).toEqual([]);
  expect(questions()).toEqual(['a']);
});
