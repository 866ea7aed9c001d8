// What can be done with a file.
import type { FileEntry, FileKind, Verb, VerbOption } from './documents';

/** A way to run a file: as what a verb reads, or as an option of one, whose input is then chosen. */
export interface Run {
  verb: Verb;
  as: VerbOption | null; // null: as its input
}

/** All ways to run a file of this kind: first those that read it, then those that need it. */
export function runsOf(verbs: Verb[], kind: FileKind): Run[] {
  const first = (verb: Verb) => (verb.inputs[0] === kind ? 0 : 1); // others take the kind too: lobes of a job
  const reads = verbs.filter(({ inputs }) => inputs.includes(kind)).sort((a, b) => first(a) - first(b)).map((verb) => ({ verb, as: null }));
  const needs = verbs.flatMap((verb) => {
    if (verb.inputs.includes(kind)) return [];
    return verb.options.filter(({ required, kinds }) => required && kinds?.includes(kind)).map((as) => ({ verb, as }));
  });
  return [...reads, ...needs];
}

const standard = ['job', 'hits', 'lobes', 'forces', 'cell', 'assembly', 'modes', 'tip', 'slots', 'loads'];

/** Where the results go unless another place is asked for: beside the input, named after it where it has a name of its own. */
export function proposedOutput({ output }: Verb, input: string): string {
  const folder = input.slice(0, input.lastIndexOf('/') + 1);
  const name = input.slice(folder.length);
  const stem = name.includes('.') ? name.slice(0, name.lastIndexOf('.')) : name;
  return folder + (stem === '' || standard.includes(stem) ? output : `${stem}-${output}`);
}

/** The files of some kinds, in the order of these. */
export function filesOf(files: FileEntry[], kinds: readonly FileKind[]): FileEntry[] {
  return kinds.flatMap((kind) => files.filter((file) => file.kind === kind).sort((a, b) => a.path.localeCompare(b.path)));
}

export const kindNames: Record<FileKind, string> = {
  job: 'Jobs',
  hits: 'Hammer hits',
  lobes: 'Lobes',
  forces: 'Forces',
  cell: 'Cells',
  assembly: 'Tools in their holders',
  tools: 'Lists of tools',
  monitor: 'Monitors',
  recordings: 'Recorded cuts',
  study: 'Studies',
  fit: 'Settings of a fit',
  modes: 'Modes',
  frf: 'FRFs',
  slots: 'Forces of slots',
  loads: 'Loads on a robot',
  record: 'Recordings',
  program: 'Programs',
  result: 'Results',
  report: 'Reports',
  other: 'Other files',
};

const documentNames: Record<string, string> = {
  plan: 'a plan',
  lobes: 'lobes',
  postures: 'limits by posture',
  blocks: 'stability of each block',
  forces: 'cutting forces',
  trajectory: 'a trajectory',
  vibration: 'vibration of a simulated cut',
  simulation: 'a simulated cut',
  explain: 'peaks explained',
  modes: 'a table of modes',
  joint: 'a joint',
  coefficients: 'cutting force coefficients',
  signal_coefficients: 'coefficients of a force record',
  stiffness: 'joint stiffness',
  tools: 'tools compared',
  check: 'check of a cell',
  smooth: 'a smoothed program',
  calibration: 'a calibrated detector',
};

/** What a result holds; empty of other files. */
export function documentText({ document }: Pick<FileEntry, 'document'>): string {
  return document ? (documentNames[document] ?? document) : '';
}

/** Samples over time: recordings, and the vibration of a simulated cut. */
export function isRecording({ kind, document }: Pick<FileEntry, 'kind' | 'document'>): boolean {
  return kind === 'record' || document === 'vibration';
}

/** The TOML files that the editor shows as a form. */
export function isEditable(path: string): boolean {
  return path.toLowerCase().endsWith('.toml');
}
