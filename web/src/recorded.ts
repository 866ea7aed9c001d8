// What is written for the page alone: a monitored recording.
import type { Band } from './bands';
import type { Fact, Num, Owner } from './documents';

/** What a document says in words. */
export interface Remarks {
  facts: Fact[];
  warnings: string[];
  notes: string[];
}

/** One point after another in the work frame. */
export interface Places {
  x_mm: number[];
  y_mm: number[];
  z_mm: number[];
}

export type MonitorState = 'stable' | 'transition' | 'chatter';

export interface MonitorStay {
  state: MonitorState;
  from_s: number;
  to_s: number;
}

/** A line of events.jsonl. */
export interface MonitorEvent {
  time_s: number;
  event: 'state' | 'window' | 'fault' | 'stream' | 'recording';
  state: MonitorState;
  score: Num;
  threshold: Num;
  chatter_frequency_hz: Num;
  chatter_frequency_std_hz: Num;
  suggested_spindle_speed_rpm: Num;
  hidden: string | null;
  mode: Num;
  mode_of: Owner | null;
  faults: string[];
  what?: string | null; // of a stream
  file?: string | null; // of a recording
  message?: string;
}

/** A monitored recording. */
export interface Monitor extends Remarks {
  unit: string;
  wave_run_s: number;
  channels: { name: string; wave: Band }[];
  spectrogram: { channel: string; begin_s: number; step_s: number; frequency_hz: number[]; level_db: number[][] } | null; // a row a frequency
  decisions: { run_s: number; score: Band; threshold: Band; energy_entropy: Band; spindle_speed_rpm: Band };
  decision_count: number;
  compute_mean_us: Num; // of one decision
  compute_max_us: Num;
  stays: MonitorStay[];
  events: MonitorEvent[];
}
