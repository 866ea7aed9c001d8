// The jobs of the folder: the stages of one, or all side by side.
import { useState } from 'preact/hooks';
import { Bullets, Table } from '../../parts';
import { ApiError } from '../api';
import { useAction, useServe } from '../context';
import type { Job } from '../documents';
import { Arrivals, useReceived } from '../files/arrivals';
import { FileInput } from '../files/files';
import { Course, isOver } from '../jobs/running';
import { Button, ErrorBox, FaultText, Panel, View } from '../pieces';
import { href } from '../route';
import { proposedOutput } from '../verbs';
import { most_jobs, readable, useKnown } from './chosen';
import type { Overview, Stage } from './documents';
import { jobFiles, nextText, remarksOf, reportedRun, stageNames, stageOf, stateWords, stepLink } from './stages';

export function StateWord({ state }: Pick<Stage, 'state'>) {
  const { word, grade } = stateWords[state];
  return <span class={`grade ${grade}`}>{word}</span>;
}

/** A run of the job that goes on or was started here. */
interface RunPlan {
  job: Job | null;
  busy: boolean;
  error: ApiError | null;
  run: () => void;
}

function useRun({ file, results }: Pick<Overview, 'file' | 'results'>): RunPlan {
  const { api, folder, verbs, refresh } = useServe();
  const { busy, error, act } = useAction();
  const [started, setStarted] = useState<number | null>(null);
  const jobs = (folder?.jobs ?? []).filter(({ verb, input }) => verb === 'plan' && input === file);
  const job = jobs.filter((one) => one.id === started || !isOver(one)).at(-1) ?? null;
  const start = async () => {
    const plan = verbs.find(({ verb }) => verb === 'plan');
    const output = results ?? (plan ? proposedOutput(plan, file) : '');
    const { id } = await api.run({ verb: 'plan', input: file, output, options: {} });
    setStarted(id);
    refresh();
  };
  return { job, busy: busy || (job !== null && !isOver(job)), error, run: () => void act(start) };
}

interface StepProps {
  stage: Stage;
  overview: Overview;
  plan: RunPlan;
  main?: boolean;
}

/** A button that runs the plan, or a link to where the stage is worked on. */
export function Step({ stage, overview, plan, main }: StepProps) {
  const { folder } = useServe();
  const others = readable(useKnown());
  const { next } = stage;
  const name = stageNames[stage.stage];
  if (next === null) return null;
  if (next.does === 'run') {
    return (
      <Button act={plan.run} main={main ?? false} disabled={plan.busy} label={`Run the plan: ${name}`}>
        Run the plan
      </Button>
    );
  }
  if (next.does === 'add') return <span>Drop {next.file ?? 'it'} on this page</span>;
  const link = stepLink(stage, overview, folder?.jobs ?? [], others);
  if (link === null) return null;
  return (
    <a class={main ? 'step main' : 'step'} href={link.address} aria-label={`${name}: ${link.text}`}>
      {link.text}
    </a>
  );
}

function Says({ stage }: { stage: Stage }) {
  return (
    <>
      {stage.says !== '' && <span>{stage.says}</span>}
      {stage.error && (
        <span class="error">
          <FaultText fault={{ ...stage.error, file: null }} />
        </span>
      )}
      {remarksOf(stage).map((remark) => (
        <small>{remark}</small>
      ))}
    </>
  );
}

export function StagesTable({ overview, plan }: { overview: Overview; plan: RunPlan }) {
  return (
    <Table
      caption="Stages"
      quiet
      rows={overview.stages}
      rowKey={({ stage }) => stage}
      rowClass={({ stage }) => (stage === overview.next ? 'selected' : '')}
      columns={[
        { heading: 'Stage', cell: ({ stage }) => <strong>{stageNames[stage]}</strong> },
        { heading: 'State', cell: ({ state }) => <StateWord state={state} /> },
        { heading: 'What it says', cell: (stage) => <div class="says"><Says stage={stage} /></div> },
        { heading: 'Next', cell: (stage) => <Step stage={stage} overview={overview} plan={plan} /> },
      ]}
    />
  );
}

/** What was started: how far it is, how it ended. */
function Run({ plan: { job, error } }: { plan: RunPlan }) {
  const { folder } = useServe();
  if (!job) return <ErrorBox error={error} />;
  const reported = isOver(job) ? reportedRun(folder?.jobs ?? [], job.input) : undefined;
  return (
    <Panel heading={isOver(job) ? 'Result' : 'Progress'} name="run">
      <Course job={job} />
      {reported && (
        <p>
          <a href={href('jobs', String(reported.id))}>Its report</a>
        </p>
      )}
      <ErrorBox error={error} />
    </Panel>
  );
}

/** What to go on with, as a button. */
function Next({ overview, plan }: { overview: Overview; plan: RunPlan }) {
  const stage = overview.next === null ? undefined : stageOf(overview, overview.next);
  if (overview.error) {
    return (
      <div class="warnings" role="alert">
        <p>
          <FaultText fault={{ ...overview.error, file: null }} />
        </p>
        <a class="step main" href={href('job', overview.error.file ?? overview.file)}>
          Correct {overview.error.line === null ? '' : `line ${overview.error.line} of `}
          {overview.error.file ?? overview.file}
        </a>
      </div>
    );
  }
  if (!stage) return null;
  return (
    <p class="buttons">
      <span>
        Next: {stageNames[stage.stage].toLowerCase() === 'frfs' ? 'FRFs' : stageNames[stage.stage].toLowerCase()}, {stateWords[stage.state].word}
      </span>
      <Step stage={stage} overview={overview} plan={plan} main />
    </p>
  );
}

/** Files dropped here, and what became of them. */
function Dropped() {
  const { folder } = useServe();
  const { describe: _, ...received } = useReceived();
  return (
    <>
      <Arrivals {...received} taken={(folder?.files ?? []).map(({ path }) => path)} />
      <section aria-label="More files">
        <FileInput />
      </section>
    </>
  );
}

export function OneJob({ overview }: { overview: Overview }) {
  const plan = useRun(overview);
  const several = jobFiles(useServe().folder).length > 1;
  return (
    <View heading={overview.title === '' ? overview.file : overview.title} lead="">
      <p class="actions">
        <a href={href('job', overview.file)}>Edit {overview.file}</a>
        {overview.results !== null && (
          <span class="muted">
            Results in <code>{overview.results}</code>
          </span>
        )}
        {several && <a href={href('overview')}>All jobs</a>}
        <a href={href('files')}>All files</a>
      </p>
      <Next overview={overview} plan={plan} />
      <Run plan={plan} />
      <Panel heading="Stages">
        <StagesTable overview={overview} plan={plan} />
      </Panel>
      <Dropped />
    </View>
  );
}

/** The jobs with their main numbers. */
export function JobList({ jobs }: { jobs: string[] }) {
  const known = useKnown();
  const of = (path: string) => {
    const one = known.get(path);
    return one === undefined || one instanceof ApiError ? null : one;
  };
  const says = (name: 'hits' | 'modes' | 'lobes' | 'decision') => (path: string) => {
    const overview = of(path);
    const stage = overview && stageOf(overview, name);
    if (!stage || stage.state === 'unused') return '';
    return (
      <div class="says">
        <StateWord state={stage.state} />
        <span>{stage.says}</span>
      </div>
    );
  };
  return (
    <View heading="Jobs of this folder" lead="What each job came to, and what is next.">
      <section aria-label="Jobs">
        <h2>Side by side</h2>
        <Table
          caption="Jobs"
          quiet
          rows={jobs.slice(0, most_jobs)}
          rowKey={(path) => path}
          columns={[
            {
              heading: 'Job',
              cell: (path) => (
                <div class="says">
                  <a href={href('overview', path)}>{path}</a>
                  <small>{of(path)?.title}</small>
                </div>
              ),
            },
            { heading: 'Hits', optional: true, cell: says('hits') },
            { heading: 'Modes', optional: true, cell: says('modes') },
            { heading: 'Lobes', optional: true, cell: says('lobes') },
            { heading: 'Decision', optional: true, cell: says('decision') },
            {
              heading: 'Next',
              cell: (path) => {
                const one = known.get(path);
                if (one === undefined) return <span class="muted">loading</span>;
                return one instanceof ApiError ? <span class="error">{one.fault.text}</span> : nextText(one);
              },
            },
          ]}
        />
        {jobs.length > most_jobs && <p class="notice">{jobs.length - most_jobs} more jobs are among the files.</p>}
      </section>
      <Dropped />
    </View>
  );
}

function NoJob() {
  return (
    <View heading="No job yet" lead="A job goes from hammer hits and a cut to a speed and a depth without chatter.">
      <Panel heading="How to begin">
        <Bullets
          texts={[
            'Put the records of your hammer hits into the folder, or drop them here.',
            'robomill init job -o job.toml writes the job and hits.toml, to be filled in; with --example a job that runs as it is.',
            'Or drop a job.toml here.',
          ]}
        />
        <p>
          <a href={href('files')}>All files</a>
        </p>
      </Panel>
      <Dropped />
    </View>
  );
}

/** `path`: of a job, or empty: the only one, or all. */
export function OverviewView({ path }: { path: string }) {
  const { folder } = useServe();
  const known = useKnown();
  const jobs = jobFiles(folder);
  const waits = (
    <View heading={path === '' ? 'Job' : path} lead="">
      <p class="notice">The job is loading.</p>
    </View>
  );
  if (folder === null) return waits;
  if (path === '' && jobs.length === 0) return <NoJob />;
  if (path === '' && jobs.length > 1) return <JobList jobs={jobs} />;
  const file = path === '' ? jobs[0]! : path;
  const one = known.get(file);
  if (one === undefined && jobs.includes(file)) return waits;
  if (one === undefined || one instanceof ApiError) {
    return (
      <View heading={file} lead="">
        {one ? <ErrorBox error={one} /> : <p class="notice">There is no such job in the folder.</p>}
        <p>
          <a href={href('files')}>All files</a>
        </p>
      </View>
    );
  }
  return <OneJob key={file} overview={one} />;
}
