// How one gets a program to work on: a job of the folder is run.
import { useState } from 'preact/hooks';
import { useServe } from '../context';
import type { Job } from '../documents';
import { Panel, Select } from '../pieces';
import { href } from '../route';
import { RunForm } from '../jobs/run_form';
import { Course, isOver } from '../jobs/running';

function Started({ job }: { job: Job }) {
  return (
    <>
      <Course job={job} />
      {isOver(job) && job.report && (
        <p>
          <a href={href('jobs', String(job.id))}>Its report</a>
        </p>
      )}
    </>
  );
}

/** Runs one of the folder's jobs. `none`: no finished job has a program; `first`: the job to begin with. */
export function ProgramStart({ none, first = null }: { none: boolean; first?: string | null }) {
  const { folder } = useServe();
  const [path, setPath] = useState<string | null>(first);
  const [started, setStarted] = useState<number | null>(null);
  const files = (folder?.files ?? []).filter(({ kind }) => kind === 'job').map((file) => file.path);
  const chosen = path ?? files[0] ?? '';
  const job = folder?.jobs.find(({ id, state }) => id === started || state === 'running' || state === 'queued') ?? null;
  return (
    <Panel heading="Run a job with a program" name="program-start">
      <p>
        {none && 'No finished job has a program to show. '}A job has one where its job.toml names a <code>program</code> and the <code>cell</code> that cuts it; with <code>[decide]</code> it has a map over γ, too.
      </p>
      {files.length === 0 && (
        <p class="notice">
          The folder has no job.toml. <code>robomill init job -o job.toml</code> writes one to fill in, with <code>--example</code> one that runs.
        </p>
      )}
      {files.length > 1 && <Select label="Job" value={chosen} options={files} choose={setPath} />}
      {files.length > 0 && (!job || isOver(job)) && <RunForm key={chosen} kind="job" path={chosen} dirty={false} save={() => Promise.resolve(true)} started={setStarted} />}
      {job && <Started key={job.id} job={job} />}
    </Panel>
  );
}
