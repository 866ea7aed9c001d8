// What page and server say to each other of spindles that are monitored.
import type { Assumption, Num, Owner } from '../../documents';
import type { MonitorState, NoSpeed } from '../../recorded';
import type { Fault } from '../documents';

/** A moment; of several what was gravest. */
export interface MonitorFrame {
  clock_s: number; // since the session began
  time_s: number; // of the stream
  state: MonitorState;
  reason: string | null; // why the state is undetermined
  score: Num;
  threshold: Num;
  spindle_speed_rpm: Num;
  chatter_frequency_hz: Num;
  chatter_frequency_std_hz: Num;
  mode: Num;
  mode_of: Owner | null;
  suggested_spindle_speed_rpm: Num;
  no_speed: NoSpeed | null;
  faults: string[];
  compute_us: Num;
  pace: Num; // seconds of the stream a second
  peak_db: Num;
  spectrum: string | null; // a letter a band
}

/** A stay in chatter, one whose state is undetermined, or a notice about the samples. */
export interface MonitorRow {
  number: number; // from 1
  kind: 'chatter' | 'blind' | 'notice';
  clock_s: number;
  from_s: number;
  to_s: Num; // null: it lasts
  reason: string | null;
  score: Num;
  low_frequency_hz: Num;
  high_frequency_hz: Num;
  chatter_frequency_hz: Num;
  chatter_frequency_std_hz: Num;
  channel: string | null;
  hidden: 'locked' | 'period-doubling' | null;
  mode: Num;
  mode_of: Owner | null;
  suggested_spindle_speed_rpm: Num;
  line_frequencies_hz: number[];
  no_speed: NoSpeed | null;
  what: string | null;
  count: number;
  message: string | null;
}

export interface MonitorCounts {
  alarm_count: number;
  decision_count: number;
  dropped_hops: number;
  lost_blocks: number;
  blind_s: Record<string, number>; // by reason
}

export interface MonitorSummary extends MonitorCounts {
  id: number;
  config: string;
  input: string;
  speed: Num; // null: a stream
  status: 'starting' | 'running' | 'done' | 'failed';
  error: Fault | null;
  started: string;
  clock_s: number;
  channels: string[];
  sample_rate_hz: number;
  teeth: Num;
  frame: MonitorFrame | null;
}

export interface MonitorSession extends MonitorSummary {
  edges_hz: number[]; // of the bands
  assumed: Assumption[];
  warnings: string[]; // on what its files say
  alarms: MonitorRow[]; // newest first
  frames: MonitorFrame[]; // of ten minutes, one a second
}

/** An event. */
export interface MonitorMessage extends MonitorCounts {
  id: number;
  frame: MonitorFrame;
  alarms: MonitorRow[]; // those that changed, newest first
}
