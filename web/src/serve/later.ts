// Answers and events come over two connections: what was said later may arrive earlier.
import type { FolderState, Job, Tap, TapStreamMessage } from './documents';

const order: Record<Job['state'], number> = { queued: 0, running: 1, done: 2, failed: 2, cancelled: 2 };

function laterJob(known: Job | undefined, got: Job): Job {
  if (!known || known.id !== got.id) return got;
  const ahead = order[known.state] - order[got.state] || known.fraction - got.fraction;
  return ahead > 0 ? known : got;
}

const again_ms = 5000; // after a failure

export interface Asked {
  ask: () => void;
  stop: () => void;
}

/** Asks as often as it is told to, and again after a failure. What was asked before is given up: an older answer never follows a newer one. */
export function newest<T>(request: (signal: AbortSignal) => Promise<T>, took: (answer: T) => void, failed: (error: unknown) => void): Asked {
  let controller: AbortController | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const stop = () => {
    clearTimeout(timer);
    controller?.abort();
  };
  const ask = () => {
    stop();
    const { signal } = (controller = new AbortController());
    request(signal).then(
      (answer) => !signal.aborted && took(answer),
      (error: unknown) => {
        if (signal.aborted) return;
        timer = setTimeout(ask, again_ms);
        failed(error);
      },
    );
  };
  return { ask, stop };
}

/** A job that changed, among the others. */
export function withJob(folder: FolderState | null, job: Job): FolderState | null {
  if (!folder) return null;
  const known = folder.jobs.some(({ id }) => id === job.id);
  return { ...folder, jobs: known ? folder.jobs.map((one) => (one.id === job.id ? job : one)) : [...folder.jobs, job] };
}

/** An answer with all jobs; none goes back to what it was before. */
export function withFolder(known: FolderState | null, got: FolderState): FolderState {
  return { ...got, jobs: got.jobs.map((job) => laterJob(known?.jobs.find(({ id }) => id === job.id), job)) };
}

/** An answer about the tap test; one that was begun later has a higher id. */
export function laterTap(known: Tap | null, got: Tap | null): Tap | null {
  if (!known || !got) return got;
  const ahead = known.id - got.id || known.revision - got.revision;
  return ahead > 0 ? known : got;
}

/** What is said of the stream of the tap test that is shown. */
export function withStream(known: Tap | null, { id, stream }: TapStreamMessage): Tap | null {
  return known?.id === id ? { ...known, stream } : known;
}
