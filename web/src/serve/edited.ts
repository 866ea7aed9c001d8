// The text of a file while it is edited, and what the server reads in it.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { asApiError, isAborted, type Api, type ApiError } from './api';
import type { CheckAnswer, Field, Value } from './documents';

const typing_ms = 300; // a text is checked once nobody has typed for so long

/** Texts that were not saved when another view was opened. */
const drafts = new Map<string, { text: string; saved: string; etag: string }>();

export interface Edited {
  text: string | null; // not there yet
  dirty: boolean; // not saved
  check: CheckAnswer | null; // of the text, or of one shortly before
  fields: Field[]; // of the last text that could be read
  error: ApiError | null; // of the server, not of the text
  conflict: boolean; // the file changed since it was opened
  type: (text: string) => void;
  change: (key: string, value: Value) => Promise<void>;
  save: () => Promise<boolean>;
  overwrite: () => Promise<boolean>; // the state that others wrote
  reload: () => Promise<void>; // drops what was typed
}

interface Document {
  text: string;
  saved: string;
  etag: string;
}

/** Checks a text; a newer one takes its place. */
function useCheck(api: Api, path: string, failed: (error: ApiError) => void) {
  const [check, setCheck] = useState<CheckAnswer | null>(null);
  const [fields, setFields] = useState<Field[]>([]);
  const under_way = useRef<AbortController | null>(null);
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  const now = async (text: string) => {
    clearTimeout(timer.current);
    under_way.current?.abort();
    const controller = new AbortController();
    under_way.current = controller;
    try {
      const answer = await api.check(path, text, controller.signal);
      if (controller.signal.aborted) return;
      setCheck(answer);
      if (answer.fields.length > 0 || answer.error === null) setFields(answer.fields);
    } catch (error) {
      if (!isAborted(error)) failed(asApiError(error));
    }
  };
  const later = (text: string) => {
    clearTimeout(timer.current);
    timer.current = setTimeout(() => void now(text), typing_ms);
  };
  const stop = () => {
    clearTimeout(timer.current);
    under_way.current?.abort();
  };
  return { check, fields, now, later, stop };
}

export function useEdited(api: Api, path: string): Edited {
  const [document, setDocument] = useState<Document | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  const [conflict, setConflict] = useState(false);
  const current = useRef<Document | null>(null);
  const checked = useCheck(api, path, setError);

  const put = (next: Document) => {
    current.current = next;
    setDocument(next);
    if (next.text === next.saved) drafts.delete(path);
    else drafts.set(path, next);
  };
  const load = async (signal?: AbortSignal) => {
    const { text, etag } = await api.file(path, signal);
    put({ text, saved: text, etag });
    setConflict(false);
    setError(null);
    await checked.now(text);
  };
  useEffect(() => {
    const controller = new AbortController();
    const draft = drafts.get(path);
    if (draft) {
      put(draft);
      void checked.now(draft.text);
    } else {
      load(controller.signal).catch((thrown: unknown) => !isAborted(thrown) && setError(asApiError(thrown)));
    }
    return () => {
      controller.abort();
      checked.stop();
    };
  }, [path]);

  const write = async (etag: string): Promise<boolean> => {
    const { text } = current.current!;
    setError(null);
    try {
      const written = await api.write(path, text, etag);
      put({ ...current.current!, saved: text, etag: written.etag });
      setConflict(false);
      return true;
    } catch (thrown) {
      const failure = asApiError(thrown);
      if (failure.status === 409) setConflict(true);
      else setError(failure);
      return false;
    }
  };
  /** One key at a time, each into the text of its moment. */
  const queue = useMemo(() => ({ last: Promise.resolve() }), [path]);
  const change = (key: string, value: Value): Promise<void> => {
    const apply = async () => {
      const before = current.current!.text;
      setError(null);
      try {
        const { text } = await api.edit(before, key, value);
        if (current.current!.text !== before) return await apply(); // typed into meanwhile
        put({ ...current.current!, text });
        await checked.now(text);
      } catch (thrown) {
        setError(asApiError(thrown));
      }
    };
    queue.last = queue.last.then(apply);
    return queue.last;
  };
  return {
    text: document?.text ?? null,
    dirty: document !== null && document.text !== document.saved,
    check: checked.check,
    fields: checked.fields,
    error,
    conflict,
    type: (text) => {
      put({ ...current.current!, text });
      checked.later(text);
    },
    change,
    save: () => write(current.current!.etag),
    overwrite: async () => write((await api.file(path)).etag),
    reload: () => load().catch((thrown: unknown) => setError(asApiError(thrown))),
  };
}
