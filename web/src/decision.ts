// What plan.json says of the decision on a program: "decision".
import type { Num } from './parts_of_documents';

/** A limit that a program violates, in the block where it is worst. */
export interface Violation {
  limit: string; // "stability", "spindle_power"
  block: Num; // from 1
  line: Num;
  value: Num;
  allowed: Num;
  unit: string;
}

/** What a program comes to; null: not known. */
export interface Outcome {
  cutting_time_s: Num; // of what cuts, at its feed throughout
  robot_time_s?: Num; // of the whole program along its smoothed trajectory
  total_time_s: Num; // at feed, without rapids
  lowest_spindle_speed_rpm: Num;
  highest_spindle_speed_rpm: Num;
  unstable_blocks: Num;
  uncertain_blocks?: Num; // stable by the mean prediction, not by its 5 % quantile
  least_stability_margin: Num;
  peak_force_n: Num;
  revolution_torque_n_m: Num; // highest mean over a revolution
  sustained_power_w: Num;
  peak_deflection_um: Num;
  worst_surface_error_um: Num;
  peak_vibration_um?: Num; // of the tip about its mean; at most the feed per tooth is allowed
  violations: Violation[];
}

/** A spindle speed that was not chosen. */
export interface OtherSpeed {
  spindle_speed_rpm: Num;
  stretch?: Num; // from 1
  cutting_time_s: Num; // of the stretch; null: not known
  stopped_by: string; // "slower": it is permitted
  limit: string | null;
  block: Num;
  line: Num;
}

/** Blocks that follow each other at one spindle speed. */
export interface Stretch {
  first_block: number;
  last_block: number;
  first_line: Num;
  last_line: Num;
  spindle_speed_rpm: Num;
  lead_deg?: Num; // from where the program has the tool's axis
  tilt_deg?: Num;
  lowest_feed_mm_per_min: Num;
  highest_feed_mm_per_min: Num;
  cutting_time_s: Num;
  limited_by: string;
}

/** Stability margin over the place along the path and the turn γ of the flange about the tool's axis. */
export interface GammaMap {
  block: number[];
  path_mm: number[];
  gamma_deg: number[];
  margin: Num[][]; // a row a γ; null: the robot cannot stand there
  chosen_deg: Num[];
  programmed_deg: Num[];
  least_margin: Num; // what is asked for
}

export interface Decision {
  status: 'found' | 'infeasible';
  reason: string; // of infeasible: which limit, where, by how much
  goal: 'time' | 'removal_rate';
  free: string[]; // "spindle_speed", "feed", "gamma"
  collisions_checked: boolean;
  evaluations: Num;
  exact_runs: Num;
  seconds: Num;
  as_programmed: Outcome;
  decided: Outcome | null;
  alternatives: OtherSpeed[];
  stretches: Stretch[];
  changes: { lines: Num; speeds: Num; feeds: Num } | null;
  notes: string[];
  gamma_map: GammaMap | null;
}
