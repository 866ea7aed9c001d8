// Stages of a job in words, and where their next steps lead.
import type { FolderState, Job } from '../documents';
import { timeText } from '../pieces';
import { href, type View } from '../route';
import type { NextStep, Overview, Stage, StageName, StageState } from './documents';

export const stageNames: Record<StageName, string> = {
  hits: 'Hits',
  frfs: 'FRFs',
  modes: 'Modes',
  cut: 'Cut',
  lobes: 'Lobes',
  robot: 'Robot',
  program: 'Program',
  decision: 'Decision',
  monitor: 'Monitor',
};

/** The word of a state, and the class of its colour. */
export const stateWords: Record<StageState, { word: string; grade: '' | 'good' | 'usable' | 'poor' | 'unknown' }> = {
  given: { word: 'given', grade: 'good' },
  guessed: { word: 'guessed', grade: 'usable' },
  missing: { word: 'missing', grade: 'poor' },
  wrong: { word: 'wrong', grade: 'poor' },
  ready: { word: 'to run', grade: '' },
  waiting: { word: 'waiting', grade: 'unknown' },
  done: { word: 'done', grade: 'good' },
  unreached: { word: 'no answer', grade: 'usable' },
  outdated: { word: 'outdated', grade: 'usable' },
  unused: { word: 'not used', grade: 'unknown' },
};

export function stageOf(overview: Overview, name: StageName): Stage | undefined {
  return overview.stages.find(({ stage }) => stage === name);
}

/** The jobs of a folder, those of upper folders first. */
export function jobFiles(folder: FolderState | null): string[] {
  const depth = (path: string) => path.split('/').length;
  return (folder?.files ?? [])
    .filter(({ kind }) => kind === 'job')
    .map(({ path }) => path)
    .sort((a, b) => depth(a) - depth(b) || a.localeCompare(b));
}

/** The newest run of a job's plan whose report is kept. */
export function reportedRun(jobs: Job[], file: string): Job | undefined {
  return jobs.filter(({ verb, input, state, report }) => verb === 'plan' && input === file && state === 'done' && report).at(-1);
}

/** The file that a view shows of a job; empty: the view chooses. */
export function pathIn(view: View, overview: Overview | null, others: Overview[] = []): string {
  if (overview === null) return '';
  const file = (name: StageName) => {
    const stage = stageOf(overview, name);
    return stage && stage.state !== 'missing' ? (stage.file ?? '') : '';
  };
  switch (view) {
    case 'lobes': {
      const cut = file('cut');
      if (cut === '' || stageOf(overview, 'lobes')?.state === 'unused') return '';
      // A cut that several jobs share has the structure of none of them.
      const shared = others.some((other) => other.file !== overview.file && stageOf(other, 'cut')?.file === cut);
      return shared ? overview.file : cut;
    }
    case 'tap':
      return file('hits');
    case 'program':
      return overview.file;
    case 'monitor':
      return file('monitor');
    default:
      return '';
  }
}

/** "Fill in tool.teeth, line 12 of job.toml". */
function editText({ error, guesses }: Stage, { file, line }: NextStep): string {
  const place = `${line === null ? '' : `line ${line} of `}${file ?? ''}`;
  if (error?.field && error.rule?.startsWith('is missing')) return `Fill in ${error.field}, ${place}`;
  if (error) return `Correct ${place}`;
  return guesses > 0 ? `Check ${place}` : `Open ${place}`;
}

/** A step as a link: its text and address. Null: it is no link, but runs or adds something. */
export function stepLink(stage: Stage, overview: Overview, jobs: Job[], others: Overview[] = []): { text: string; address: string } | null {
  const { next } = stage;
  if (next === null) return null;
  const run = reportedRun(jobs, overview.file);
  switch (next.does) {
    case 'edit':
      return { text: editText(stage, next), address: href('job', next.file ?? overview.file) };
    case 'tap':
      return { text: 'Tap test', address: href('tap', pathIn('tap', overview)) };
    case 'lobes':
      return { text: 'Lobes', address: href('lobes', pathIn('lobes', overview, others)) };
    case 'program':
      return { text: 'Program', address: href('program', overview.file) };
    case 'monitor':
      return { text: 'Monitor', address: href('monitor', pathIn('monitor', overview)) };
    case 'report':
      return run ? { text: 'Report', address: href('jobs', String(run.id)) } : null;
    default:
      return null;
  }
}

/** What a row says beside its number. */
export function remarksOf({ newer, guesses, state }: Stage): string[] {
  const remarks: string[] = [];
  if (newer) remarks.push(`since ${timeText(newer.since)}: ${newer.file} changed`);
  if (guesses > 0) remarks.push(guesses === 1 ? 'one value is a sample or a guess' : `${guesses} values are samples or guesses`);
  if (state === 'unreached') remarks.push('the report has the reason');
  return remarks;
}

/** The stage that a job goes on with, in words. */
export function nextText(overview: Overview): string {
  if (overview.error) return `${overview.file} cannot be read`;
  const stage = overview.next === null ? undefined : stageOf(overview, overview.next);
  return stage ? `${stageNames[stage.stage]}: ${stateWords[stage.state].word}` : 'Nothing is left to do';
}
