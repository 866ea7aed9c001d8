// The job that all views are of, and what is known of every job.
import { createContext, type ComponentChildren } from 'preact';
import { useContext, useEffect, useState } from 'preact/hooks';
import { ApiError, asApiError, type Api } from '../api';
import type { FolderState } from '../documents';
import type { Route } from '../route';
import type { Overview } from './documents';
import { jobFiles } from './stages';

export const most_jobs = 50; // that are looked at
const key = 'robomill-job';

export type Overviews = ReadonlyMap<string, Overview | ApiError>;

/** Overviews of the folder's jobs, asked for anew when its files change and when a run ends; what is known stays until then. */
export function useOverviews(api: Api, folder: FolderState | null): Overviews {
  const [known, setKnown] = useState<Overviews>(new Map());
  const ended = (folder?.jobs ?? []).filter(({ verb, state }) => verb === 'plan' && state === 'done').map(({ id }) => id);
  useEffect(() => {
    const { signal, abort } = abortable();
    const ask = async () => {
      for (const path of jobFiles(folder).slice(0, most_jobs)) {
        const answer = await api.overview(path, signal).catch(asApiError);
        if (signal.aborted) return;
        setKnown((before) => new Map(before).set(path, answer));
      }
    };
    void ask();
    return abort;
  }, [api, folder?.files, ended.join()]);
  return known;
}

function abortable(): { signal: AbortSignal; abort: () => void } {
  const controller = new AbortController();
  return { signal: controller.signal, abort: () => controller.abort() };
}

/** The job of the address, else the one before, else the only one. */
export function chosenJob(route: Route, kept: string | null, jobs: string[]): string | null {
  if (route.view === 'overview' && route.path !== '') return route.path;
  if (kept !== null && jobs.includes(kept)) return kept;
  return jobs.length === 1 ? jobs[0]! : null;
}

export function useChosen(route: Route, folder: FolderState | null): string | null {
  const [kept, keep] = useState<string | null>(() => sessionStorage.getItem(key));
  const chosen = chosenJob(route, kept, jobFiles(folder));
  useEffect(() => {
    if (chosen === null || chosen === kept) return;
    keep(chosen);
    sessionStorage.setItem(key, chosen);
  }, [chosen]);
  return chosen;
}

const Context = createContext<Overviews>(new Map());

export function OverviewsContext({ value, children }: { value: Overviews; children: ComponentChildren }) {
  return <Context.Provider value={value}>{children}</Context.Provider>;
}

export function useKnown(): Overviews {
  return useContext(Context);
}

/** Those that could be read. */
export function readable(overviews: Overviews): Overview[] {
  return [...overviews.values()].filter((one): one is Overview => !(one instanceof ApiError));
}
