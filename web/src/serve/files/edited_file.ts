// A file while it is edited: its text, what is typed into its form, and what the server reads in it.
import { ApiError, asApiError, faultOf, isAborted, type Api } from '../api';
import type { CheckAnswer, Field, Value } from '../documents';
import type { Draft, Drafts } from './drafts';
import { labelOf, parseValue, valueText } from './fields';

const typing_ms = 300; // a text is checked once nobody has typed for so long

/** What a control of the form shows in place of the value that was last read. */
export interface Entry {
  typed: string;
  wrong: string | null; // why it did not go into the text
  version: number | null; // of the text that has it first; null: none has
}

export class EditedFile {
  conflict = false; // the file changed since it was opened
  check: CheckAnswer | null = null; // of the text, or of one shortly before
  fields: Field[] = []; // of the last text that could be read
  readonly entries = new Map<string, Entry>(); // by key
  private document: Draft | null = null; // not there yet
  private version = 0; // counts texts
  private failure: ApiError | null = null;
  private check_failure: ApiError | null = null;
  private readonly pending: string[] = []; // keys of edits that are under way
  private edits: Promise<void> = Promise.resolve();
  private writes: Promise<boolean> = Promise.resolve(true);
  private checking: AbortController | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private readonly view = new AbortController();

  constructor(
    private readonly api: Pick<Api, 'file' | 'write' | 'check' | 'edit'>,
    private readonly path: string,
    private readonly drafts: Drafts,
    private readonly redraw: () => void,
  ) {}

  get text(): string | null {
    return this.document?.text ?? null;
  }

  /** Something is not saved. */
  get dirty(): boolean {
    return this.pending.length > 0 || this.document?.text !== this.document?.saved || [...this.entries.values()].some(({ version }) => version === null);
  }

  /** Of the server, not of the text. */
  get error(): ApiError | null {
    return this.failure ?? this.check_failure;
  }

  /** Goes on with a draft; the file may have changed since. */
  async open(): Promise<void> {
    const draft = this.drafts.get(this.path);
    if (draft) {
      this.put(draft);
      this.changed();
    }
    try {
      const { text, etag } = await this.api.file(this.path, this.view.signal);
      if (!draft) this.put({ text, saved: text, etag });
      else if (this.document?.etag === draft.etag && etag !== draft.etag) this.conflict = true;
    } catch (thrown) {
      if (isAborted(thrown)) return;
      this.failure = asApiError(thrown);
    }
    this.changed();
  }

  /** The view is gone. Edits that are under way still go into the draft. */
  close(): void {
    this.view.abort();
    this.checking?.abort();
    clearTimeout(this.timer);
    this.entries.clear();
    this.changed();
  }

  /** Into the text itself. */
  type(text: string): void {
    this.document = { ...this.document!, text };
    ++this.version;
    this.failure = null;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.checkNow(), typing_ms);
    this.changed();
  }

  /** Into the control of a key. */
  enter(key: string, typed: string): void {
    this.entries.set(key, { typed, wrong: null, version: null });
    this.changed();
  }

  /** A control loses the focus; a browser says nothing of one whose text is again what it was. */
  leave({ key, value }: Field): void {
    if (this.pending.includes(key) || this.entries.get(key)?.typed !== valueText(value)) return;
    this.entries.delete(key);
    this.changed();
  }

  /** What was typed goes into the text: one key at a time, each into the text of its moment. */
  commit({ key, value }: Field, typed: string): void {
    const parsed = parseValue(typed, value);
    this.entries.set(key, { typed, wrong: 'wrong' in parsed ? parsed.wrong : null, version: null });
    if ('value' in parsed) {
      this.pending.push(key);
      this.failure = null;
      this.edits = this.edits.then(() => this.apply(key, typed, parsed.value));
    }
    this.changed();
  }

  /** Whether the file has what is shown. One write at a time: each is over the state that the one before left. */
  save(): Promise<boolean> {
    return this.alone(async () => (await this.settled()) && (this.document!.text === this.document!.saved || this.write(this.document!.etag)));
  }

  /** Writes over what others wrote. */
  overwrite(): Promise<boolean> {
    return this.alone(async () => (await this.settled()) && this.write((await this.api.file(this.path)).etag));
  }

  /** Drops what was typed. */
  async reload(): Promise<void> {
    await this.alone(async () => {
      await this.edited();
      const { text, etag } = await this.api.file(this.path, this.view.signal);
      this.entries.clear();
      this.conflict = false;
      this.put({ text, saved: text, etag });
      return true;
    });
  }

  private changed(): void {
    if (this.document) this.drafts.put(this.path, this.dirty ? this.document : null);
    this.redraw();
  }

  private put(next: Draft): void {
    this.document = next;
    ++this.version;
    void this.checkNow();
  }

  private async apply(key: string, typed: string, value: Value): Promise<void> {
    const mark = (wrong: string | null, version: number | null) => {
      if (this.entries.get(key)?.typed === typed) this.entries.set(key, { typed, wrong, version }); // else more was typed since
    };
    try {
      const text = await this.edit(key, value);
      this.put({ ...this.document!, text });
      mark(null, this.version);
    } catch (thrown) {
      this.failure = asApiError(thrown);
      mark(this.failure.fault.text, null);
    }
    this.pending.splice(this.pending.indexOf(key), 1);
    this.changed();
  }

  /** The text of this moment with another value. */
  private async edit(key: string, value: Value): Promise<string> {
    const before = this.text!;
    const { text } = await this.api.edit(before, key, value);
    return this.text === before ? text : this.edit(key, value); // typed into meanwhile
  }

  private async edited(): Promise<void> {
    while (this.pending.length > 0) await this.edits;
  }

  /** Whether all that was typed is in the text; what failed is tried again. */
  private async settled(): Promise<boolean> {
    await this.edited();
    for (const field of this.fields) {
      const entry = this.entries.get(field.key);
      if (entry?.version === null) this.commit(field, entry.typed);
    }
    await this.edited();
    const left = [...this.entries].find(([, { wrong }]) => wrong !== null);
    if (left) this.failure ??= new ApiError(0, faultOf(`${labelOf(left[0])}: ${left[1].wrong}`));
    return !left;
  }

  private alone(write: () => Promise<boolean>): Promise<boolean> {
    const begin = () => {
      this.failure = null;
      return write();
    };
    const fail = (thrown: unknown) => {
      if (!isAborted(thrown)) this.failure = asApiError(thrown);
      return false;
    };
    this.writes = this.writes.then(begin).catch(fail);
    return this.writes.finally(() => this.changed());
  }

  private async write(etag: string): Promise<boolean> {
    const { text } = this.document!;
    try {
      const written = await this.api.write(this.path, text, etag);
      this.document = { ...this.document!, saved: text, etag: written.etag };
      this.conflict = false;
      return true;
    } catch (thrown) {
      const failure = asApiError(thrown);
      if (failure.status !== 409) throw failure;
      this.conflict = true;
      return false;
    }
  }

  /** Checks the text; a newer one takes its place. */
  private async checkNow(): Promise<void> {
    clearTimeout(this.timer);
    this.checking?.abort();
    if (this.view.signal.aborted) return;
    const { version } = this;
    const controller = new AbortController();
    this.checking = controller;
    try {
      const answer = await this.api.check(this.path, this.text!, controller.signal);
      if (controller.signal.aborted) return;
      this.check_failure = null;
      this.check = answer;
      if (answer.fields.length > 0 || answer.error === null) this.read(answer.fields, version);
    } catch (error) {
      if (controller.signal.aborted) return;
      this.check_failure = asApiError(error);
    }
    this.changed();
  }

  /** Entries that these fields have, or whose key is gone, have done their work. */
  private read(fields: Field[], version: number): void {
    this.fields = fields;
    const keys = new Set(fields.map(({ key }) => key));
    for (const [key, entry] of this.entries) if (!keys.has(key) || (entry.version !== null && entry.version <= version)) this.entries.delete(key);
  }
}
