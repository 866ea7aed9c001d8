// What every view of the application has.
import { createContext, type ComponentChildren } from 'preact';
import { useContext, useEffect, useState } from 'preact/hooks';
import { asApiError, isAborted, type Api, type ApiError } from './api';
import type { FolderState, Tap, Verb } from './documents';

export interface Serve {
  api: Api;
  folder: FolderState | null; // not known yet
  verbs: Verb[]; // that can be run; none before the server has said them
  tap: Tap | null;
  tookTap: (tap: Tap | null) => void; // from an answer
  announce: (text: string) => void; // to someone who cannot see it
  refresh: () => void; // asks for the folder anew
  take: (files: File[]) => void; // into the folder
}

const Context = createContext<Serve | null>(null);

export function ServeContext({ value, children }: { value: Serve; children: ComponentChildren }) {
  return <Context.Provider value={value}>{children}</Context.Provider>;
}

export function useServe(): Serve {
  const serve = useContext(Context);
  if (!serve) throw new Error('outside of ServeContext');
  return serve;
}

export interface Answer<T> {
  answer: T | null;
  error: ApiError | null;
}

/** Asks now and when an input changes; an older answer that comes late is dropped. */
export function useAnswer<T>(ask: (signal: AbortSignal) => Promise<T>, inputs: unknown[]): Answer<T> {
  const [got, setGot] = useState<Answer<T>>({ answer: null, error: null });
  useEffect(() => {
    const controller = new AbortController();
    setGot({ answer: null, error: null });
    ask(controller.signal).then(
      (answer) => !controller.signal.aborted && setGot({ answer, error: null }),
      (error: unknown) => !isAborted(error) && !controller.signal.aborted && setGot({ answer: null, error: asApiError(error) }),
    );
    return () => controller.abort();
  }, inputs);
  return got;
}

/** Does something for a button: what went wrong stands beside it. */
export function useAction(): { busy: boolean; error: ApiError | null; act: (what: () => Promise<unknown>) => Promise<void>; clear: () => void } {
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<ApiError | null>(null);
  const act = async (what: () => Promise<unknown>) => {
    setBusy(true);
    setError(null);
    try {
      await what();
    } catch (thrown) {
      setError(asApiError(thrown));
    } finally {
      setBusy(false);
    }
  };
  return { busy, error, act, clear: () => setError(null) };
}
