// What page and server say to each other.
import type { FrfDocument, LobesDocument, Num, SweepDocument } from '../documents';

/** Stands in the page. */
export interface ServeConfig {
  token: string; // of everything that writes
  version: string;
  folder: string; // its name
}

/** What was wrong with an input. */
export interface Fault {
  text: string; // the whole message
  file: string | null;
  line: number | null; // from 1
  field: string | null; // a key, "hits[0].file"
  value: string | number | null;
  unit: string | null; // of the value
  rule: string | null;
  hint: string | null;
}

export const fileKinds = [
  'job', 'hits', 'lobes', 'forces', 'cell', 'assembly', 'tools', 'monitor', 'recordings', 'study', 'fit', 'modes', 'frf', 'slots', 'loads', 'record', 'program', 'result', 'report', 'other',
] as const;
export type FileKind = (typeof fileKinds)[number];

/** A file below the folder. */
export interface FileEntry {
  path: string;
  kind: FileKind;
  document?: string | null; // of a result which: "plan", "lobes", "vibration", …
  bytes: number;
  modified: string;
}

export type JobState = 'queued' | 'running' | 'done' | 'failed' | 'cancelled';

export interface Job {
  id: number;
  verb: string;
  input: string; // the first
  inputs?: string[];
  options?: Record<string, unknown>;
  output: string | null; // null: nothing is written
  state: JobState;
  exit: Num; // 3: finished, but the answer was not reached
  task: string;
  fraction: number;
  seconds: Num; // null: not begun
  error: Fault | null;
  shortfall?: string | null; // why the answer was not reached
  summary: string | null;
  report: boolean; // there is one to show
}

export type Takes = 'flag' | 'whole' | 'number' | 'numbers' | 'texts' | 'word' | 'file' | 'files' | 'new_file' | 'new_folder' | 'point' | 'points';

/** An option of a verb. */
export interface VerbOption {
  name: string; // "band_hz"
  does: string; // its label, with the unit
  takes: Takes;
  required: boolean;
  words?: string[]; // of a word
  kinds?: FileKind[]; // of a file
  count?: number; // of numbers
}

/** What can be run on files of some kinds. */
export interface Verb {
  verb: string; // "cell check"
  does: string; // on a button
  inputs: FileKind[];
  several: boolean; // of them
  output: string; // a name for it
  options: VerbOption[];
}

export interface JobRequest {
  verb: string;
  input: string | string[];
  output: string; // empty: nothing is written
  options: Record<string, unknown>;
}

export interface FolderState {
  version: string;
  folder: string;
  files: FileEntry[];
  files_left_out: number;
  record_endings: string[]; // ".csv", in lower case
  jobs: Job[];
}

export type Value = number | string | boolean | (number | string | boolean)[];

/** A key of a TOML file. */
export interface Field {
  key: string; // "tool.teeth", "hits[0].file"
  value: Value;
  line: number;
  comment: string | null;
}

export interface CheckAnswer {
  kind: FileKind;
  error: Fault | null;
  fields: Field[];
}

export type ColumnGuess = 'time' | 'force' | 'response' | null;

/** What a file looks like; all but the kind of a recording alone. */
export interface Inspection {
  kind: FileKind;
  columns: { name: string; unit: string | null; guess: ColumnGuess; direction?: string | null }[];
  rows: Num;
  sample_rate_hz: Num;
  direction_guess: string | null;
  questions: string[];
  files: string[]; // beside it, of one hit: the force's first; empty: it is a record by itself
  time: string | null; // of several files the column of time, where it has to be given
}

export interface LobesRequest {
  file: string;
  set: Record<string, Value>; // in the place of the file's keys
  answer: 'limit' | 'chart'; // the limit curve alone, or also the boundary and the band
  at: [number, number][]; // rpm, mm
  client: string;
  channel: string;
  sequence: number;
}

/** A key that a slider may move, in the file's unit. */
export interface Movable {
  value: number;
  min: number;
  max: number;
  step: number;
}

export interface ListedMode {
  number: number;
  frequency_hz: number;
  damping_ratio: number;
  kept: boolean;
}

export interface LobesAnswer {
  sequence: number;
  lobes: LobesDocument | SweepDocument;
  modes: ListedMode[];
  fields: Record<string, Movable>;
  notes: string[];
  milliseconds: number;
}

export interface TapHit {
  number: number; // from 1
  file: string; // or "hit 3"
  accepted: boolean;
  excluded: boolean; // by hand
  reasons: string[];
  force_direction: string;
  peak_force_n: Num;
}

/** Over the time from the force's peak. */
export interface TapCurve {
  time_s: number[];
  values: Num[];
}

/** What is drawn of one hit. One that could not be read has no curves, one that was rejected by itself no FRF. */
export interface TapHitCurves extends TapHit {
  force?: TapCurve; // N
  responses?: Record<string, TapCurve>; // in the SI unit of the sensor, by direction
  frf?: { frequency_hz: number[]; magnitude_m_per_n: Record<string, Num[]> } | null;
}

export interface TapPeak {
  frequency_hz: number;
  name: string; // of the FRF
  receptance_m_per_n: Num;
  coherence: Num;
}

/** The stream that hits come from. */
export interface TapStream {
  address: string;
  status: 'connecting' | 'receiving' | 'silent' | 'failed';
  error: Fault | null;
  sample_rate_hz: number;
  record_s: number;
  level_n: Num; // a force beyond it begins a record
  recording: boolean;
  triggered: number;
  discarded: { reason: string; count: number }[];
  notices: { what: string; count: number; message: string }[];
}

/** A guided tap test. */
export interface Tap {
  id: number;
  revision: number; // rises with each change
  hits: string; // the file of its settings
  stream: TapStream | null; // null: files of a folder
  force_direction: string | null; // of the stream's hits that come now
  running: boolean;
  good: number;
  wanted: number;
  waiting?: string[]; // files whose record has another one, that has not appeared yet
  taken: TapHit[];
  frf: FrfDocument | null;
  peaks: TapPeak[];
}

/** What a tap test begins with. */
export interface TapRequest {
  hits: string;
  wanted: number; // good hits; 0: five a direction
  watch?: string; // empty: the folder of the settings
  stream?: string; // mqtt://HOST[:PORT]/TOPIC
  force_direction?: string;
  trigger_level_n?: number; // 0: by itself
  record_s?: number; // 0: as the settings say
}

export interface TapStreamMessage {
  id: number;
  stream: TapStream;
}
