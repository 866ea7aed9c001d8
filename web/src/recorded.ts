// What is written for the page alone: forces, a monitored recording.
import type { Fact, Num, Owner } from './documents';

export interface Ring {
  height_mm: number;
  position_deg: Num;
  arcs: { entry_deg: number; exit_deg: number }[];
}

/** A number for each of x, y and z. */
export type Triple = [Num, Num, Num];

export interface Revolution {
  on: 'tool' | 'workpiece';
  rotation_deg: number[];
  fx_n: number[];
  fy_n: number[];
  fz_n: number[];
  torque_n_m: number[];
  mean_n: Triple;
  peak_n: Triple;
  rms_n: Triple;
  mean_torque_n_m: Num;
  peak_torque_n_m: Num;
  power_w: Num;
  chip_area_mm2: Num;
  removal_rate_mm3_per_s: Num;
  engagement: Ring[];
  deflection_um: Triple; // by the mean force
  peak_deflection_um: Num;
  vibrating: boolean; // from the time-domain simulation
  verdict: string;
  chatter_frequency_hz: Num;
}

export interface ForceCurves {
  path_mm: number[];
  block: number[];
  line: number[];
  peak_force_n: Num[];
  torque_n_m: Num[];
  peak_torque_n_m: Num[];
  power_w: Num[];
  deflection_um: Num[] | null;
}

export interface Track extends Places {
  block: number[];
  line: number[];
  peak_force_n: Num[];
  cuts: boolean[];
}

/** The highest value along a program, and where. */
export interface Highest {
  value: number;
  block: number;
  line: number;
}

export interface WorstBlock {
  block: number;
  line: number;
  tip_mm: Triple;
  axial_depth_mm: Num;
  radial_depth_mm: Num;
  peak_force_n: Num;
  mean_force_n: Triple;
  torque_n_m: Num;
  power_w: Num;
  deflection_um: Num;
}

export interface Program {
  blocks: number;
  cutting_blocks: number;
  length_mm: Num;
  time_s: Num;
  torque_limit_n_m: Num;
  power_limit_w: Num;
  power_time_s: number;
  highest: Record<'peak_force_n' | 'torque_n_m' | 'peak_torque_n_m' | 'power_w' | 'deflection_um', Highest | null>;
  worst: WorstBlock[];
  troubles: string[];
  curves: ForceCurves;
  track: Track;
}

export interface SpindleRotation {
  rotation_deg: number[];
  deflection_um: Num[];
  condition_number: Num[] | null;
  best_deg: Num;
  best_um: Num;
  used_deg: Num;
  used_um: Num;
}

/** What a document says in words. */
export interface Remarks {
  facts: Fact[];
  warnings: string[];
  notes: string[];
}

export interface Forces extends Remarks {
  revolution: Revolution | null;
  program: Program | null;
  spindle_rotation: SpindleRotation | null;
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

export interface Monitor extends Remarks {
  unit: string;
  entropy_unit: string;
  wave_time_s: number[];
  channels: { name: string; wave: number[] }[];
  spectrogram: { channel: string; begin_s: number; step_s: number; frequency_hz: number[]; level_db: number[][] } | null; // a row a frequency
  decisions: { time_s: number[]; score: number[]; threshold: number[]; energy_entropy: number[] | null; spindle_speed_rpm: number[] | null };
  decision_count: number;
  compute_mean_us: Num; // of one decision
  compute_max_us: Num;
  stays: MonitorStay[];
  events: MonitorEvent[];
}
