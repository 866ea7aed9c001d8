// Files that were dropped on the page: sent, looked at, asked about.
import { createContext, type ComponentChildren } from 'preact';
import { useContext, useRef, useState } from 'preact/hooks';
import { Bullets } from '../../parts';
import { ApiError, asApiError, most_bytes, type Api } from '../api';
import type { Serve } from '../context';
import type { Inspection } from '../documents';
import type { Belongs } from '../overview/belongs';
import { bytesText, Button, FaultText, Panel } from '../pieces';
import { href } from '../route';
import { isEditable, kindNames } from '../verbs';
import { freeName, HitsForm, type HitsAnswers } from './hits_form';
import { asWhole, columnsOf, filesOf, sameColumns } from './hits_text';

export interface Arrival {
  name: string; // it came with
  path: string; // in the folder
  inspection: Inspection | null; // not known yet
  error: ApiError | null;
  note?: string | null; // what was done with it
}

async function send(api: Api, file: File, path: string): Promise<void> {
  if (file.size > most_bytes) {
    const text = `${file.name} has ${bytesText(file.size)}; at most ${bytesText(most_bytes)} can be sent. Copy it into the folder.`;
    throw asApiError(new Error(text));
  }
  await api.write(path, file, null);
}

/** What came of files that were sent, in words. */
export function receivedText(received: number, failed: number): string {
  const files = (count: number) => `${count} ${count === 1 ? 'file' : 'files'}`;
  if (failed === 0) return `${files(received)} received`;
  return received === 0 ? `${files(failed)} not received` : `${files(received)} received, ${failed} not`;
}

/** A file that arrives, or is looked at again: what is known of it stays until the answer comes. */
export function withArrival(arrivals: Arrival[], name: string, path: string): Arrival[] {
  const known = arrivals.some((one) => one.path === path);
  if (known) return arrivals.map((one) => (one.path === path ? { ...one, error: null } : one));
  return [...arrivals, { name, path, inspection: null, error: null }];
}

/** Names that files may have in the folder: free there, and given to no other that arrived. */
export class FreeNames {
  private readonly given = new Set<string>(); // that the folder does not list yet
  give(name: string, folder: string[]): string {
    for (const path of folder) this.given.delete(path);
    const path = freeName(name, [...folder, ...this.given]);
    this.given.add(path);
    return path;
  }
  /** It was not written. */
  back(path: string): void {
    this.given.delete(path);
  }
}

export interface Received {
  arrivals: Arrival[];
  describe: (path: string) => void; // of a file of the folder
  clear: () => void;
  forms: Map<string, HitsAnswers>; // by columnsOf the recordings; they outlast the view
}

type Needs = Pick<Serve, 'api' | 'folder' | 'refresh' | 'announce'>;

/** Files sent one after the other, so that a hundred do not stand in each other's way; they stay known whatever view is shown. */
export function useArrivals({ api, folder, refresh, announce }: Needs): Received & { take: (files: File[], belongs?: Belongs) => void } {
  const [arrivals, setArrivals] = useState<Arrival[]>([]);
  const [forms] = useState(() => new Map<string, HitsAnswers>());
  const names = useRef(new FreeNames());
  const last = useRef<Promise<unknown>>(Promise.resolve());
  const listed = useRef<string[]>([]);
  listed.current = (folder?.files ?? []).map((file) => file.path);
  const set = (path: string, change: Partial<Arrival>) => setArrivals((all) => all.map((one) => (one.path === path ? { ...one, ...change } : one)));
  /** Sends a file, unless it lies there already, and asks what it is; whether it lies there then. */
  const add = async (file: File | null, path: string, belongs?: Belongs): Promise<boolean> => {
    setArrivals((all) => withArrival(all, file?.name ?? path, path));
    let there = file === null;
    try {
      if (file) await send(api, file, path);
      there = true;
      const inspection = await api.inspect(path);
      set(path, { inspection });
      if (belongs) set(path, { note: await belongs.settle(path, inspection.kind) });
    } catch (error) {
      set(path, { error: asApiError(error) });
    }
    return there;
  };
  const addAll = async (files: File[], belongs?: Belongs) => {
    let received = 0;
    for (const file of files) {
      const path = names.current.give(`${belongs?.folder(file.name) ?? ''}${file.name}`, listed.current);
      if (await add(file, path, belongs)) ++received;
      else names.current.back(path);
    }
    refresh();
    announce(receivedText(received, files.length - received));
  };
  return {
    arrivals,
    describe: (path) => void add(null, path),
    clear: () => {
      setArrivals([]);
      forms.clear();
    },
    forms,
    take: (files, belongs) => void (last.current = last.current.then(() => addAll(files, belongs))),
  };
}

const Context = createContext<Received>({ arrivals: [], describe: () => {}, clear: () => {}, forms: new Map() });

export function ArrivalsContext({ value, children }: { value: Received; children: ComponentChildren }) {
  return <Context.Provider value={value}>{children}</Context.Provider>;
}

export function useReceived(): Received {
  return useContext(Context);
}

/** Where it is, unless it is at the top under the name that it came with. */
function placeText({ name, path }: Pick<Arrival, 'name' | 'path'>): string {
  if (name === path) return '';
  if (path.endsWith(`/${name}`)) return `, as ${path}`;
  return `, as ${path} since there is a ${name} already`;
}

function describe({ name, path, inspection, error, note }: Arrival) {
  if (error) return <FaultText fault={error.fault} />;
  if (!inspection) return 'on its way';
  const others = filesOf({ path, inspection }).filter((file) => file !== path);
  return (
    <>
      {kindNames[inspection.kind].toLowerCase()}
      {placeText({ name, path })}
      {others.length > 0 && `; one hit with ${others.join(', ')}`}
      {note && `; ${note}`}
      {isEditable(path) && (
        <>
          ; <a href={href('job', path)}>open it</a>
        </>
      )}
      {inspection.kind !== 'record' && <Bullets texts={inspection.questions} />}
    </>
  );
}

export function Arrivals({ arrivals, clear, forms, taken }: Omit<Received, 'describe'> & { taken: string[] }) {
  if (arrivals.length === 0) return null;
  const recordings = arrivals.flatMap(({ path, inspection }) => (inspection?.kind === 'record' ? [{ path, inspection }] : []));
  return (
    <>
      <Panel heading="Received" name="received">
        <ul>
          {arrivals.map((arrival) => (
            <li key={arrival.path} class={arrival.error ? 'error' : undefined}>
              <strong>{arrival.name}</strong>: {describe(arrival)}
            </li>
          ))}
        </ul>
        <Button act={clear}>Clear the list</Button>
      </Panel>
      {sameColumns(asWhole(recordings)).map((group) => (
        <HitsForm key={columnsOf(group[0]!)} recordings={group} forms={forms} taken={taken} />
      ))}
    </>
  );
}
