// What page and server say to each other of spindles that are monitored.
import type { Assumption, MonitorAlarm, MonitorState, MonitorWhy, Num } from '../../documents';
import type { Fault } from '../documents';

type Chatter = Pick<MonitorAlarm, 'chatter_frequency_hz' | 'chatter_frequency_std_hz' | 'mode' | 'mode_of' | 'suggested_spindle_speed_rpm' | 'no_speed'>;

/** A moment; of several what was gravest. */
export interface MonitorFrame extends Chatter {
  clock_s: number; // since the session began
  time_s: number; // of the stream
  state: MonitorState;
  reason: string | null; // why the state is undetermined
  score: Num;
  threshold: Num;
  spindle_speed_rpm: Num;
  faults: string[];
  compute_us: Num;
  pace: Num; // seconds of the stream a second
  peak_db: Num;
  spectrum: string | null; // a letter a band
}

/** A stay in chatter, one whose state is undetermined, or a notice about the samples. */
export interface MonitorRow extends Chatter, Pick<MonitorAlarm, 'low_frequency_hz' | 'high_frequency_hz' | 'channel' | 'hidden' | 'line_frequencies_hz' | 'why'> {
  number: number; // from 1
  kind: 'chatter' | 'blind' | 'notice';
  clock_s: number;
  from_s: number;
  to_s: Num; // null: it lasts
  reason: string | null;
  score: Num;
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
  why: MonitorWhy | null; // the frame's state is what it is
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
  why: MonitorWhy | null;
  alarms: MonitorRow[]; // those that changed, newest first
}
