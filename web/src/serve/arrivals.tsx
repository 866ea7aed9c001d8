// Files that were dropped on the page: sent, looked at, asked about.
import { useEffect, useState } from 'preact/hooks';
import { Bullets } from '../parts';
import { ApiError, asApiError, most_bytes, type Api } from './api';
import { useServe } from './context';
import type { Inspection } from './documents';
import { freeName, HitsForm } from './hits_form';
import { sameColumns } from './hits_text';
import { bytesText, Button, FaultText, Panel } from './pieces';
import { href } from './route';
import { isEditable, kindNames } from './verbs';

export interface Arrival {
  name: string; // it came with
  path: string; // in the folder
  inspection: Inspection | null; // not known yet
  error: ApiError | null;
}

/** Sends a file, unless it lies there already, and asks what it is. */
async function receive(api: Api, file: File | null, path: string): Promise<Inspection> {
  if (file && file.size > most_bytes) {
    const text = `${file.name} has ${bytesText(file.size)}; at most ${bytesText(most_bytes)} can be sent. Copy it into the folder.`;
    throw asApiError(new Error(text));
  }
  if (file) await api.write(path, file, null);
  return api.inspect(path);
}

/** Files sent one after the other, so that a hundred do not stand in each other's way. */
export function useArrivals() {
  const { api, dropped, take, folder, refresh, announce } = useServe();
  const [arrivals, setArrivals] = useState<Arrival[]>([]);
  const set = (path: string, change: Partial<Arrival>) => setArrivals((all) => all.map((one) => (one.path === path ? { ...one, ...change } : one)));
  const add = async (file: File | null, path: string) => {
    setArrivals((all) => [...all.filter((one) => one.path !== path), { name: file?.name ?? path, path, inspection: null, error: null }]);
    try {
      set(path, { inspection: await receive(api, file, path) });
    } catch (error) {
      set(path, { error: asApiError(error) });
    }
  };
  const addAll = async (files: File[]) => {
    const taken = (folder?.files ?? []).map((file) => file.path);
    for (const file of files) {
      const path = freeName(file.name, taken);
      taken.push(path);
      await add(file, path);
    }
    refresh();
    announce(`${files.length} ${files.length === 1 ? 'file' : 'files'} received`);
  };
  useEffect(() => {
    if (dropped.length === 0) return;
    take([]);
    void addAll(dropped);
  }, [dropped]);
  return { arrivals, describe: (path: string) => void add(null, path), clear: () => setArrivals([]) };
}

function describe({ name, path, inspection, error }: Arrival) {
  if (error) return <FaultText fault={error.fault} />;
  if (!inspection) return 'on its way';
  const renamed = name === path ? '' : `, as ${path} since there is a ${name} already`;
  return (
    <>
      {kindNames[inspection.kind].toLowerCase()}
      {renamed}
      {isEditable(path) && (
        <>
          ; <a href={href('job', path)}>open it</a>
        </>
      )}
      {inspection.kind !== 'record' && <Bullets texts={inspection.questions} />}
    </>
  );
}

export function Arrivals({ arrivals, clear, taken }: { arrivals: Arrival[]; clear: () => void; taken: string[] }) {
  if (arrivals.length === 0) return null;
  const recordings = arrivals.flatMap(({ path, inspection }) => (inspection?.kind === 'record' ? [{ path, inspection }] : []));
  const waiting = arrivals.some(({ inspection, error }) => !inspection && !error);
  return (
    <>
      <Panel heading="Received" name="received">
        <ul>
          {arrivals.map((arrival) => (
            <li class={arrival.error ? 'error' : undefined}>
              <strong>{arrival.name}</strong>: {describe(arrival)}
            </li>
          ))}
        </ul>
        <Button act={clear}>Clear the list</Button>
      </Panel>
      {!waiting && sameColumns(recordings).map((group) => <HitsForm key={group.map(({ path }) => path).join()} recordings={group} taken={taken} />)}
    </>
  );
}
