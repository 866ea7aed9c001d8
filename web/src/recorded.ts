// What is written for the page alone: a smoothed program, a monitored recording.
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

export interface JointMotion {
  unit: '°' | 'mm';
  velocity: number[];
  acceleration: number[];
  jerk: number[];
  tracking_error: number[] | null;
  max_velocity: Num;
  max_acceleration: Num;
  max_jerk: Num;
}

export interface Motion {
  time_s: number[];
  tip_speed_mm_per_s: number[];
  axis_speed_deg_per_s: number[];
  joints: JointMotion[];
  track: Places & { speed_mm_per_s: number[] };
}

/** One limit and how near a method came to it. */
export interface LimitUse {
  what: string;
  unit: string;
  max: Num;
  limit: Num;
  share: Num;
  violations: number;
  at_s: Num;
  block: Num;
}

export interface SmoothMethod {
  name: string;
  duration_s: number;
  lower_bound_s: Num;
  violations: number;
  tip_error_um: Num;
  axis_error_deg: Num;
  joint_share: Num;
  tracking_error_deg: Num;
  tracking_error_um: Num;
  sum_t2_s: Num;
  plan_s: Num;
  samples: number;
  uses: LimitUse[];
  motion: Motion;
}

export interface Corner {
  block: number;
  line: number;
  turn_deg: number;
  radius_mm: number;
  program: { x_mm: number[]; y_mm: number[] };
  corner_paths: { x_mm: number[]; y_mm: number[] }[]; // one a method
}

export interface Smooth extends Remarks {
  skipped: string[];
  blocks: number;
  tip_tolerance_mm: number;
  max_tip_speed_mm_per_s: Num;
  max_axis_speed_deg_per_s: Num;
  program: Places;
  methods: SmoothMethod[];
  corners: Corner[];
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

/** A curve over runs of equal length: the lowest and the highest value of each. */
export interface Band {
  low: number[];
  high: number[];
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
