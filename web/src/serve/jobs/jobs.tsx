// The jobs of this server, and one of them.
import { Table } from '../../parts';
import { useServe } from '../context';
import type { Job } from '../documents';
import { View } from '../pieces';
import { href } from '../route';
import { durationText, Running, stateText } from './running';

export function JobsTable({ jobs }: { jobs: Job[] }) {
  return (
    <Table
      caption="Jobs"
      quiet
      rows={[...jobs].reverse()}
      rowClass={({ state }) => (state === 'failed' ? 'rejected' : '')}
      columns={[
        { heading: 'Job', cell: (job) => <a href={href('jobs', String(job.id))}>{`${job.id}: ${job.verb}`}</a> },
        { heading: 'Input', cell: (job) => <a href={href('job', job.input)}>{job.input}</a> },
        { heading: 'Results in', cell: ({ output }) => output !== null && <code>{output}</code> },
        { heading: 'State', cell: (job) => (job.state === 'running' ? `${Math.round(100 * job.fraction)} %` : stateText(job)) },
        { heading: 'Time', number: true, cell: ({ seconds }) => durationText(seconds) },
      ]}
    />
  );
}

export function JobsView({ path }: { path: string }) {
  const jobs = useServe().folder?.jobs ?? [];
  const job = jobs.find(({ id }) => String(id) === path);
  return (
    <View heading={job ? `Job ${job.id}: ${job.verb} of ${job.input}` : 'Jobs'} lead="">
      {job && <Running key={job.id} job={job} />}
      {path !== '' && !job && <p class="notice">There is no job {path}.</p>}
      <section aria-label="All jobs">
        <h2>{job ? 'All jobs' : 'Since the server started'}</h2>
        {jobs.length === 0 ? <p>None yet. Open a job among the <a href={href('files')}>files</a> and run it.</p> : <JobsTable jobs={jobs} />}
      </section>
    </View>
  );
}
