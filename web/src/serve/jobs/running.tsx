// A job that runs, and what came of it.
import { useEffect, useMemo, useState } from 'preact/hooks';
import type { Num, Report } from '../../documents';
import { Page } from '../../page';
import { dash } from '../../text';
import { useAction, useAnswer, useServe } from '../context';
import type { Job } from '../documents';
import { Button, ErrorBox, FaultLine, Panel } from '../pieces';
import { href } from '../route';

export function isOver({ state }: Job): boolean {
  return state === 'done' || state === 'failed' || state === 'cancelled';
}

/** "2 min 5 s". */
export function durationText(seconds: Num): string {
  if (seconds === null) return dash;
  const whole = Math.round(seconds);
  if (whole < 60) return `${seconds < 10 ? Math.round(10 * seconds) / 10 : whole} s`;
  const [minutes, rest] = [Math.floor(whole / 60), whole % 60];
  return rest === 0 || minutes >= 60 ? `${minutes} min` : `${minutes} min ${rest} s`;
}

/** What is left of a job if it goes on as until now; empty where too little is done to say. */
export function leftText({ seconds, fraction }: Pick<Job, 'seconds' | 'fraction'>): string {
  if (seconds === null || fraction < 0.02 || fraction >= 1) return '';
  return `about ${durationText((seconds / fraction) * (1 - fraction))} left`;
}

const states: Record<Job['state'], string> = { queued: 'waiting', running: 'running', done: 'done', failed: 'failed', cancelled: 'cancelled' };

export function stateText(job: Job): string {
  return job.state === 'done' && job.exit === 3 ? 'done, but the answer was not reached' : states[job.state];
}

function Progress({ job }: { job: Job }) {
  const { api } = useServe();
  const { error, act } = useAction();
  const percent = Math.round(100 * job.fraction);
  return (
    <div class="progress">
      <label>
        <span>{job.state === 'queued' ? 'Waits for the job before it' : job.task || 'Starts'}</span>
        <progress max={1} {...(job.state === 'queued' ? {} : { value: job.fraction })} />
      </label>
      <span class="numbers">
        {percent} % · {durationText(job.seconds)}
        {leftText(job) !== '' && ` · ${leftText(job)}`}
      </span>
      <Button act={() => void act(() => api.cancel(job.id))}>Cancel</Button>
      <ErrorBox error={error} />
    </div>
  );
}

const loaded = new Map<string, Promise<void>>();

/** The script that draws a path, once. */
function script(address: string): Promise<void> {
  const before = loaded.get(address);
  if (before) return before;
  const load = new Promise<void>((resolve) => {
    const element = document.createElement('script');
    element.src = address;
    element.onload = () => resolve();
    element.onerror = () => resolve(); // the report says that it has none
    document.head.append(element);
  });
  loaded.set(address, load);
  return load;
}

/** A report with what draws its path. */
export async function withPathScript(report: Report): Promise<Report> {
  if (report.blocks) await script('/page-path.js');
  return report;
}

function Result({ id }: { id: number }) {
  const { api } = useServe();
  const { answer, error } = useAnswer((signal) => api.report(id, signal).then(withPathScript), [id]);
  // Each time it is rendered its plots are drawn anew, without the zoom that they have.
  const page = useMemo(() => answer && <Page report={answer} within />, [answer]);
  if (error) return <ErrorBox error={error} />;
  return page ?? <p class="notice">The report is loading.</p>;
}

/** How a job ended. */
export function Outcome({ job }: { job: Job }) {
  return (
    <>
      <p>
        <strong>{job.verb}</strong> of <a href={href('job', job.input)}>{job.input}</a>
        {(job.inputs?.length ?? 1) > 1 && ` and ${job.inputs!.length - 1} more`}: {stateText(job)} after {durationText(job.seconds)}
        {job.output === null ? '; nothing was written' : <>; results in <code>{job.output}</code></>}.
      </p>
      {job.shortfall && (
        <p class="warnings" role="status">
          The answer was not reached: {job.shortfall}.
        </p>
      )}
      {job.error && <FaultLine fault={job.error} alert />}
      {job.summary !== null && job.summary !== '' && (job.report ? <details><summary>Summary</summary><pre>{job.summary}</pre></details> : <pre>{job.summary}</pre>)}
    </>
  );
}

/** How far it is, or how it ended. */
export function Course({ job }: { job: Job }) {
  return isOver(job) ? <Outcome job={job} /> : <Progress job={job} />;
}

/** Progress, then the result. */
export function Running({ job }: { job: Job }) {
  const { announce } = useServe();
  const [said, setSaid] = useState(job.state);
  useEffect(() => {
    if (said !== job.state) announce(`${job.verb} of ${job.input}: ${stateText(job)}`);
    setSaid(job.state);
  }, [job.state]);
  return (
    <>
      <Panel heading={isOver(job) ? 'Result' : 'Progress'} name="run">
        <Course job={job} />
      </Panel>
      {job.report && isOver(job) && <Result key={job.id} id={job.id} />}
    </>
  );
}
