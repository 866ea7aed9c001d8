// What page and server say to each other.
import type { BoundaryPoint, FrfDocument, Kind, LobesDocument, Num, Owner } from '../documents';

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
  rule: string | null;
  hint: string | null;
}

export const fileKinds = ['job', 'hits', 'lobes', 'forces', 'cell', 'assembly', 'monitor', 'recordings', 'study', 'modes', 'frf', 'record', 'program', 'report', 'other'] as const;
export type FileKind = (typeof fileKinds)[number];

/** A file below the folder. */
export interface FileEntry {
  path: string;
  kind: FileKind;
  bytes: number;
  modified: string;
}

export type JobState = 'queued' | 'running' | 'done' | 'failed' | 'cancelled';

export interface Job {
  id: number;
  verb: string;
  input: string;
  output: string | null; // null: nothing is written
  state: JobState;
  exit: Num; // 3: finished, but the answer was not reached
  task: string;
  fraction: number;
  seconds: Num; // null: not begun
  error: Fault | null;
  summary: string | null;
  report: boolean; // there is one to show
}

export interface FolderState {
  version: string;
  folder: string;
  files: FileEntry[];
  files_left_out: number;
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

/** A point that was evaluated. */
export interface EvaluatedPoint {
  spindle_speed_rpm: number;
  axial_depth_mm: number;
  spectral_radius: Num;
  stable: boolean;
  chatter_frequency_hz?: Num;
  kind?: Kind;
  mode?: Num;
  mode_of?: Owner | null;
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
  lobes: Omit<LobesDocument, 'boundary'> & { boundary?: BoundaryPoint[]; points?: EvaluatedPoint[] };
  modes: ListedMode[];
  fields: Record<string, Movable>;
  notes: string[];
  milliseconds: number;
}

export interface TapHit {
  file: string;
  accepted: boolean;
  reasons: string[];
  force_direction: string;
}

export interface TapPeak {
  frequency_hz: number;
  name: string; // of the FRF
  receptance_m_per_n: Num;
  coherence: Num;
}

/** A guided tap test. */
export interface Tap {
  hits: string; // the file of its settings
  running: boolean;
  good: number;
  wanted: number;
  taken: TapHit[];
  frf: FrfDocument | null;
  peaks: TapPeak[];
}
