// What is recorded for the page alone: a smoothed program's motion, a simulated vibration, spectra of cuts.
import type { Band } from './bands';
import type { Num } from './parts_of_documents';

/** One point after another in the work frame. */
export interface Places {
  x_mm: number[];
  y_mm: number[];
  z_mm: number[];
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

/** What is recorded of a simulation for the page: curves by axis, those that do not vanish. */
export interface VibrationDocument {
  run_s: number;
  displacement_um: Record<string, Band>;
  force_n: Record<string, Band>;
  spectrum: { from_s: number; frequency_hz: number[]; x_um?: Num[]; y_um?: Num[]; z_um?: Num[] } | null;
}

export interface Peak {
  frequency_hz: number;
  amplitude: number;
  kind: 'rotation' | 'tooth passing' | 'chatter' | 'cut or chatter' | 'unexplained';
  text: string;
}

export interface Recording {
  file: string;
  spindle_speed_rpm: number;
  axial_depth_mm: Num;
  verdict: 'stable' | 'borderline' | 'chatter' | null;
  reason: string;
  rotation_hz: number;
  tooth_passing_hz: number;
  teeth: number;
  amplitude_unit: string;
  frequency_hz: number[];
  amplitude: Num[];
  peaks: Peak[];
}
