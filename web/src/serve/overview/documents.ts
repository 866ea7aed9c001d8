// What the server says of a job: GET /api/overview.
import type { Fault } from '../documents';

export type StageName = 'hits' | 'frfs' | 'modes' | 'cut' | 'lobes' | 'robot' | 'program' | 'decision' | 'monitor';
export type StageState = 'given' | 'guessed' | 'missing' | 'wrong' | 'ready' | 'waiting' | 'done' | 'unreached' | 'outdated' | 'unused';
export type StageStep = 'edit' | 'add' | 'run' | 'tap' | 'lobes' | 'program' | 'report' | 'monitor';

/** What to do next about a stage. */
export interface NextStep {
  does: StageStep;
  file: string | null; // that it is about
  line: number | null; // in it, from 1
}

export interface Stage {
  stage: StageName;
  state: StageState;
  says: string; // its number, or what it waits for; empty: nothing
  file: string | null; // the document that gives it
  guesses: number; // values that are samples or guesses
  error: Fault | null;
  newer: { file: string; since: string } | null; // an input that changed after it was computed
  next: NextStep | null;
}

export interface Overview {
  file: string; // the job's
  title: string;
  error: Fault | null; // of its document as a whole
  results: string | null; // the folder of its plan
  names: string[]; // keys of [job]
  stages: Stage[]; // in the order of the data
  next: StageName | null; // the stage to go on with
}
