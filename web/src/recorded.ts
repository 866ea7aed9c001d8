// What is recorded for the page alone: a monitored recording, a smoothed program's motion.
import type { Band } from './bands';
import type { Num, Owner, Remarks } from './documents';

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

/** Joints' bands in their unit by time. */
export interface JointMotion {
  unit: 'deg' | 'mm';
  velocity: Band;
  acceleration: Band;
  jerk: Band;
  tracking_error: Band | null;
}

/** A method's trajectory over time: bands over runs of run_s each. */
export interface Motion {
  run_s: number;
  tip_speed_mm_per_s: Band;
  axis_speed_deg_per_s: Band;
  joints: JointMotion[];
  tip: Places & { speed_mm_per_s: number[] };
  corner_paths: FlatPlaces[]; // one a corner
}

/** In the plane of a corner: x along the way, y to the inside. */
export interface FlatPlaces {
  x_mm: number[];
  y_mm: number[];
}

export interface Corner {
  line: number;
  turn_deg: number;
  radius_mm: number;
  program: FlatPlaces;
}

/** What is recorded of a smoothed program for the page alone. */
export interface MotionDocument {
  program: Places;
  corners: Corner[];
  motions: Motion[]; // one a method, in the order of smooth.json
}
