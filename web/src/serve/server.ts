// What the server says, kept up to date: the folder with its jobs, the verbs, the tap test.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { asApiError, faultOf, ApiError, type Api } from './api';
import type { FolderState, Tap, Verb } from './documents';
import { listen } from './events';
import { laterTap, newest, withFolder, withJob, withStream } from './later';
import { monitorFeed } from './monitor/feed';

/** What is wrong, by what was asked; null: nothing any longer. */
export type Faults = Partial<Record<'state' | 'tap' | 'verbs' | 'events', ApiError | null>>;

/** What to say of them: above all that there is no answer (status 0). */
export function troubleOf(faults: Faults): ApiError | null {
  const all = Object.values(faults).filter((fault) => fault !== null);
  return all.find(({ status }) => status === 0) ?? all[0] ?? null;
}

export interface Server {
  folder: FolderState | null;
  verbs: Verb[];
  tap: Tap | null;
  tookTap: (tap: Tap | null) => void;
  trouble: ApiError | null;
  refresh: () => void;
}

export function useServer(api: Api): Server {
  const [folder, setFolder] = useState<FolderState | null>(null);
  const [tap, setTap] = useState<Tap | null>(null);
  const [verbs, setVerbs] = useState<Verb[]>([]);
  const [faults, setFaults] = useState<Faults>({});
  const anew = useRef(false); // ids of the tap test may have begun anew
  const fault = (of: keyof Faults, error: ApiError | null) => setFaults((known) => ((known[of] ?? null) === error ? known : { ...known, [of]: error }));
  const told = (got: Tap | null) => {
    const isAnew = anew.current;
    anew.current = false;
    setTap((known) => (isAnew ? got : laterTap(known, got)));
  };
  const asked = useMemo(() => {
    const of = <T>(which: keyof Faults, request: (signal: AbortSignal) => Promise<T>, took: (answer: T) => void) =>
      newest(
        request,
        (answer) => {
          fault(which, null);
          took(answer);
        },
        (error) => fault(which, asApiError(error)),
      );
    return {
      state: of('state', api.state, (state) => setFolder((known) => withFolder(known, state))),
      tap: of('tap', api.tap, told),
      verbs: of('verbs', api.verbs, setVerbs),
    };
  }, [api]);
  /** Newer than what is still asked for. */
  const tookTap = (got: Tap | null) => {
    asked.tap.stop();
    fault('tap', null);
    told(got);
  };
  useEffect(() => {
    const all = Object.values(asked);
    for (const one of all) one.ask();
    let first = true;
    const end = listen({
      files: asked.state.ask,
      job: (job) => setFolder((known) => withJob(known, job)),
      tap: tookTap,
      tapStream: (message) => setTap((known) => withStream(known, message)),
      monitor: monitorFeed.messages.say,
      monitors: () => monitorFeed.changes.say(),
      connected: (now) => {
        if (now && !first) {
          anew.current = true; // perhaps another server
          for (const one of all) one.ask();
          monitorFeed.reconnected.say();
        }
        first = false;
        fault('events', now ? null : new ApiError(0, faultOf('The events of the server have ended.')));
      },
    });
    return () => {
      end();
      for (const one of all) one.stop();
    };
  }, [asked]);
  return { folder, verbs, tap, tookTap, trouble: troubleOf(faults), refresh: asked.state.ask };
}
