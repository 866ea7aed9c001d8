// What can be done with a file.
import type { FileKind } from './documents';

export interface Run {
  verb: string;
  does: string; // on a button
  output: string; // unless another is asked for
}

/** The verb of a kind of file, and where its results go: beside the input. */
export function runOf(kind: FileKind, path: string): Run | null {
  return kind === 'job' ? { verb: 'plan', does: 'Run the job', output: path.slice(0, path.lastIndexOf('/') + 1) + 'out' } : null;
}

export const kindNames: Record<FileKind, string> = {
  job: 'Jobs',
  hits: 'Hammer hits',
  lobes: 'Lobes',
  forces: 'Forces',
  cell: 'Cells',
  assembly: 'Tools in their holders',
  monitor: 'Monitors',
  recordings: 'Recorded cuts',
  study: 'Studies',
  modes: 'Modes',
  frf: 'FRFs',
  record: 'Recordings',
  program: 'Programs',
  report: 'Reports',
  other: 'Other files',
};

/** The TOML files that the editor shows as a form. */
export function isEditable(path: string): boolean {
  return path.toLowerCase().endsWith('.toml');
}
