import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ApiError, faultOf } from '../api';
import type { CheckAnswer, Field } from '../documents';
import { Drafts, type Draft } from './drafts';
import { EditedFile } from './edited_file';

type Question = 'file' | 'write' | 'check' | 'edit';

interface Asked {
  what: Question;
  text: string; // that is sent
  answer: () => void;
  fail: (error: unknown) => void;
}

/** A server that answers when a test says so; of the file it has "a = 1, b = 2" as lines. */
let disk: { text: string; etag: string };
let asked: Asked[];
let stored: string;
let warned: boolean;
let drafts: Drafts;
let file: EditedFile;

const settled = () => new Promise<void>((resolve) => setTimeout(resolve, 0));
const fieldsOf = (text: string): Field[] => [...text.matchAll(/^(\w+) = (\d+)$/gm)].map(([, key, value], i) => ({ key: key!, value: Number(value), line: i + 1, comment: null }));
const checkOf = (text: string): CheckAnswer => ({ kind: 'lobes', error: null, fields: fieldsOf(text) });

function ask<T>(what: Question, text: string, answer: () => T, signal?: AbortSignal): Promise<T> {
  return new Promise((resolve, fail) => {
    const given = () => {
      asked.splice(asked.indexOf(one), 1);
      try {
        resolve(answer());
      } catch (error) {
        fail(error);
      }
    };
    const one = { what, text, answer: given, fail: (error: unknown) => (asked.splice(asked.indexOf(one), 1), fail(error)) };
    asked.push(one);
    signal?.addEventListener('abort', () => asked.includes(one) && one.fail(new DOMException('aborted', 'AbortError')));
  });
}

const api: ConstructorParameters<typeof EditedFile>[0] = {
  file: (_path, signal) => ask('file', '', () => ({ ...disk }), signal),
  write: (_path, body, etag) =>
    ask('write', body as string, () => {
      if (etag !== disk.etag) throw new ApiError(409, faultOf('another state'));
      disk = { text: body as string, etag: `${disk.etag}'` };
      return { etag: disk.etag };
    }),
  check: (_path, text, signal) => ask('check', text, () => checkOf(text), signal),
  edit: (text, key, value) => ask('edit', text, () => ({ text: text.replace(new RegExp(`^${key} = .*$`, 'm'), `${key} = ${String(value)}`) })),
};

/** The oldest question of a kind is answered, or fails; then what follows from it has happened. */
async function answer(what: Question, error?: unknown): Promise<void> {
  const one = asked.find((question) => question.what === what);
  if (!one) throw new Error(`nobody asks for ${what}, but for ${asked.map((question) => question.what).join(', ')}`);
  if (error === undefined) one.answer();
  else one.fail(error);
  await settled();
}

const questions = () => asked.map(({ what }) => what);
const field = (key: string) => file.fields.find((one) => one.key === key)!;
/** What the control of a key shows. */
const shown = (key: string) => file.entries.get(key)?.typed ?? String(field(key).value);
const newDrafts = () =>
  new Drafts({ getItem: () => stored, setItem: (_item, text) => void (stored = text) }, (some) => void (warned = some));

async function open(): Promise<void> {
  file = new EditedFile(api, 'lobes.toml', drafts, () => {});
  void file.open();
  await settled();
}

beforeEach(async () => {
  vi.useRealTimers();
  disk = { text: 'a = 1\nb = 2\n', etag: 'A' };
  asked = [];
  stored = '[]';
  drafts = newDrafts();
  await open();
  await answer('file');
  await answer('check');
});
// A check that waits for the next key would be asked of the next test's server.
afterEach(() => file.close());

it('shows the file', () => {
  expect([file.text, file.dirty, file.error, file.fields.length, warned]).toEqual([disk.text, false, null, 2, false]);
  expect(asked).toEqual([]);
});

describe('a save', () => {
  it('has what was typed into a field the moment before', async () => {
    file.enter('a', '7');
    expect(file.dirty).toBe(true);
    file.commit(field('a'), '7');
    const saved = file.save();
    await settled();
    expect(questions()).toEqual(['edit']); // nothing is written before
    await answer('edit');
    expect(asked.find(({ what }) => what === 'write')!.text).toBe('a = 7\nb = 2\n');
    await answer('write');
    expect(await saved).toBe(true);
    expect([disk.text, file.dirty]).toEqual(['a = 7\nb = 2\n', false]);
  });
  it('writes nothing where nothing changed', async () => {
    expect(await file.save()).toBe(true);
    expect(asked).toEqual([]);
  });
  it('is not begun while a field is wrong, and says which', async () => {
    file.commit(field('a'), 'seven');
    expect(file.entries.get('a')!.wrong).toBe('A number is needed.');
    expect(await file.save()).toBe(false);
    expect(file.error!.fault.text).toBe('A: A number is needed.');
    expect(asked).toEqual([]);
  });
  it('tries an edit again that failed', async () => {
    file.commit(field('a'), '7');
    await settled();
    await answer('edit', new ApiError(0, faultOf('no answer')));
    expect([shown('a'), file.entries.get('a')!.wrong, file.error!.fault.text, file.dirty]).toEqual(['7', 'no answer', 'no answer', true]);
    const saved = file.save();
    await settled();
    await answer('edit');
    await answer('write');
    expect([await saved, disk.text, file.error]).toEqual([true, 'a = 7\nb = 2\n', null]);
  });
  it('waits for the one before, whose state it is over', async () => {
    file.type('a = 3\n');
    const both = Promise.all([file.save(), file.save()]);
    await settled();
    expect(questions()).toEqual(['write']);
    await answer('write');
    expect(await both).toEqual([true, true]);
    expect([asked.length, file.conflict]).toEqual([0, false]);
  });
  it('over what others wrote is asked about', async () => {
    file.type('a = 3\n');
    disk = { text: 'theirs', etag: 'B' };
    const saved = file.save();
    await settled();
    await answer('write');
    expect([await saved, file.conflict, file.error, disk.text]).toEqual([false, true, null, 'theirs']);
    const failed = file.overwrite();
    await settled();
    await answer('file', new ApiError(404, faultOf('no such file')));
    expect([await failed, file.error!.fault.text]).toEqual([false, 'no such file']);
    const written = file.overwrite();
    await settled();
    await answer('file');
    await answer('write');
    expect([await written, file.conflict, file.error, disk.text]).toEqual([true, false, null, 'a = 3\n']);
  });
});

describe('a field', () => {
  it('keeps what is typed while an edit is under way', async () => {
    file.enter('a', '1');
    file.commit(field('a'), '5');
    file.enter('a', '52');
    await settled();
    await answer('edit');
    await answer('check');
    expect([file.text, shown('a')]).toEqual(['a = 5\nb = 2\n', '52']);
    file.commit(field('a'), '52');
    await settled();
    await answer('edit');
    expect([shown('a'), field('a').value]).toEqual(['52', 5]); // until it was read
    await answer('check');
    expect([shown('a'), field('a').value, file.entries.size]).toEqual(['52', 52, 0]);
  });
  it('does not wait for the check of another', async () => {
    file.commit(field('a'), '5');
    file.commit(field('b'), '6');
    await settled();
    await answer('edit');
    expect(questions().sort()).toEqual(['check', 'edit']);
    await answer('edit');
    expect(questions()).toEqual(['check']); // of the newer text; the one before was given up
    expect([shown('a'), shown('b')]).toEqual(['5', '6']);
    await answer('check');
    expect([file.text, file.entries.size]).toEqual(['a = 5\nb = 6\n', 0]);
  });
  it('goes into the text of its moment', async () => {
    file.commit(field('a'), '5');
    await settled();
    file.type('# typed meanwhile\na = 1\nb = 2\n');
    await answer('edit');
    expect(file.text).toBe('# typed meanwhile\na = 1\nb = 2\n');
    await answer('edit');
    expect(file.text).toBe('# typed meanwhile\na = 5\nb = 2\n');
  });
  it('is as it was once a digit is typed and deleted', () => {
    file.enter('a', '12');
    file.enter('a', '1');
    expect(file.dirty).toBe(true);
    file.leave(field('a'));
    expect([file.dirty, file.entries.size]).toEqual([false, 0]);
    file.enter('a', '12');
    file.leave(field('a')); // a browser commits it at the same time
    expect(shown('a')).toBe('12');
  });
  it('whose key is gone from the text is forgotten', async () => {
    file.commit(field('b'), 'two');
    vi.useFakeTimers();
    file.type('a = 1\n');
    vi.runAllTimers();
    vi.useRealTimers();
    await answer('check');
    expect(file.entries.size).toBe(0);
  });
  it('is dropped with the text', async () => {
    file.commit(field('a'), 'seven');
    const loaded = file.reload();
    await settled();
    await answer('file');
    await loaded;
    expect([file.entries.size, file.dirty, file.text]).toEqual([0, false, disk.text]);
  });
});

it('forgets that a check failed once one succeeds', async () => {
  vi.useFakeTimers();
  file.type('a = 3\n');
  vi.runAllTimers();
  vi.useRealTimers();
  await answer('check', new ApiError(0, faultOf('no answer')));
  expect(file.error!.fault.text).toBe('no answer');
  file.commit(field('a'), '4');
  await settled();
  await answer('edit');
  await answer('check');
  expect(file.error).toBeNull();
});

describe('a draft', () => {
  const reopen = async () => {
    file.close();
    drafts = newDrafts(); // as after a reload
    await open();
  };
  it('outlives a reload and warns before one', async () => {
    file.type('a = 3\n');
    expect(warned).toBe(true);
    await reopen();
    expect([file.text, file.dirty, warned]).toEqual(['a = 3\n', true, true]);
    await answer('file');
    expect([file.text, file.conflict]).toEqual(['a = 3\n', false]);
    const saved = file.save();
    await settled();
    await answer('write');
    expect([await saved, stored, warned]).toEqual([true, '[]', false]);
  });
  it('of a file that changed since is said to be one', async () => {
    file.type('a = 3\n');
    disk = { text: 'theirs', etag: 'B' };
    await reopen();
    await answer('file');
    expect([file.text, file.conflict]).toEqual(['a = 3\n', true]);
  });
  it('has an edit that was under way when the view was left', async () => {
    file.commit(field('a'), '7');
    await settled();
    file.close();
    expect(warned).toBe(true);
    await answer('edit');
    expect(drafts.get('lobes.toml')!.text).toBe('a = 7\nb = 2\n');
    expect(asked).toEqual([]); // nobody reads a check
  });
  it('is none of what was only typed into a field', () => {
    file.enter('a', '12');
    expect(warned).toBe(true);
    file.close();
    expect([warned, drafts.get('lobes.toml')]).toEqual([false, null]);
  });
});

it('goes without a storage, or with a full or strange one', () => {
  const draft: Draft = { text: 'x', saved: '', etag: '' };
  const full = { getItem: () => 'no JSON', setItem: () => { throw new DOMException('full', 'QuotaExceededError'); } };
  for (const store of [null, full]) {
    const some = new Drafts(store, () => {});
    some.put('a', draft);
    expect([some.get('a'), some.stored]).toEqual([draft, false]);
  }
});
