// The program of a finished job: which one, and how to get one.
import { useEffect, useRef, useState } from 'preact/hooks';
import { asApiError, isAborted, type Api, type ApiError } from '../api';
import { useServe } from '../context';
import type { Job } from '../documents';
import { ErrorBox, View } from '../pieces';
import { href } from '../route';
import { withPathScript } from '../jobs/running';
import { ProgramStart } from './start';
import { ProgramWork } from './work';
import { candidates, programOf, stillKnown, type LoadedProgram } from './views';

type Known = LoadedProgram | ApiError | null; // null: it has no program

/** The programs of jobs, each asked for once; `loading` while one is not known yet. `shown` stays when its job is no longer kept. */
function usePrograms(api: Api, jobs: Job[], shown: number | null): { programs: LoadedProgram[]; error: ApiError | null; loading: boolean } {
  const [known, setKnown] = useState<ReadonlyMap<number, Known>>(new Map());
  const asked = useRef(new Set<number>());
  const controller = useRef<AbortController | null>(null);
  useEffect(() => {
    const { signal } = (controller.current ??= new AbortController());
    const learn = (id: number, one: Known) => !signal.aborted && setKnown((before) => new Map(before).set(id, one));
    const gone = [...asked.current].filter((id) => !jobs.some((job) => job.id === id));
    for (const id of gone) asked.current.delete(id);
    setKnown((before) => stillKnown(before, jobs, shown));
    for (const job of jobs.filter(({ id }) => !asked.current.has(id))) {
      asked.current.add(job.id);
      api.report(job.id, signal).then(withPathScript).then(
        (report) => learn(job.id, programOf(job, report)),
        (error: unknown) => !isAborted(error) && learn(job.id, asApiError(error)),
      );
    }
  }, [jobs.map(({ id }) => id).join(), shown]);
  useEffect(() => () => controller.current?.abort(), []);
  const all = [...known.values()];
  return {
    programs: all.filter((one): one is LoadedProgram => one !== null && !(one instanceof Error)).sort((a, b) => b.id - a.id),
    error: all.find((one): one is ApiError => one instanceof Error) ?? null,
    loading: jobs.some(({ id }) => !known.has(id)),
  };
}

function Others({ programs, shown }: { programs: LoadedProgram[]; shown: LoadedProgram }) {
  return (
    <p class="actions">
      {programs.map(({ id, input }) =>
        id === shown.id ? (
          <strong>{`Job ${id}: ${input}`}</strong>
        ) : (
          <a href={href('program', String(id))}>{`Job ${id}: ${input}`}</a>
        ),
      )}
      <a href={href('jobs', String(shown.id))}>Its whole report</a>
      <a href={href('job', shown.input)}>Edit {shown.input}</a>
    </p>
  );
}

/** `path`: the number of a run, a job whose newest run it is, or empty: the newest of all. What is shown stays while newer ones come. */
export function ProgramView({ path }: { path: string }) {
  const { api, folder } = useServe();
  const ofJob = /^\d*$/.test(path) ? null : path;
  const jobs = candidates(folder?.jobs ?? []).filter(({ input }) => ofJob === null || input === ofJob);
  const kept = useRef<number | null>(null);
  const { programs, error, loading } = usePrograms(api, jobs, kept.current);
  const wanted = path === '' || ofJob !== null ? kept.current : Number(path);
  const shown = wanted === null ? (loading ? undefined : programs[0]) : programs.find(({ id }) => id === wanted);
  if (shown) kept.current = shown.id;
  return (
    <View heading={shown ? `Program of ${shown.input}` : 'Program'} lead={shown ? '' : 'How far every block of a program is from chatter, and what the turn γ about the tool\'s axis does to that.'}>
      {shown && <Others programs={programs} shown={shown} />}
      {shown && <ProgramWork key={shown.id} program={shown} />}
      {!shown && (loading || folder === null) && <p class="notice">The jobs' programs are loading.</p>}
      {!shown && !loading && folder !== null && (
        <>
          {path !== '' && ofJob === null && <p class="notice">Job {path} has no program to show, or its data is not kept any longer: of the last two jobs it is.</p>}
          {programs.length > 0 && (
            <p>
              <a href={href('program', String(programs[0]!.id))}>{`Job ${programs[0]!.id}: ${programs[0]!.input}`}</a> has one.
            </p>
          )}
          <ErrorBox error={error} />
          <ProgramStart none={programs.length === 0} first={ofJob} />
        </>
      )}
    </View>
  );
}
