// Answers and events come over two connections: what was said later may arrive earlier.
import type { FolderState, Job, Tap } from './documents';

const order: Record<Job['state'], number> = { queued: 0, running: 1, done: 2, failed: 2, cancelled: 2 };

function laterJob(known: Job | undefined, got: Job): Job {
  if (!known || known.id !== got.id) return got;
  const ahead = order[known.state] - order[got.state] || known.fraction - got.fraction;
  return ahead > 0 ? known : got;
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

/** An answer about the tap test. */
export function laterTap(known: Tap | null, got: Tap | null): Tap | null {
  const ahead = known && got && known.hits === got.hits && known.taken.length > got.taken.length;
  return ahead ? known : got;
}
