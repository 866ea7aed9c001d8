// What single verbs find, as robomill writes it into the page: shop units, null for "none".
import type { Band } from './bands';
import type { Num, Owner } from './parts_of_documents';

/** What was taken because nobody said it; key and file are null where nothing can be set. */
export interface Assumption {
  what: string;
  taken: string;
  key: string | null;
  file: string | null;
}

export type PeakKind = 'tooth passing' | 'rotation' | 'chatter' | 'cut or chatter' | 'unexplained';

/** One way to read a peak. */
export interface Reading {
  kind: PeakKind;
  rotations: number; // n of f = |f_k + n f_rotation|
  mirrored: boolean; // f_k + n f_rotation is negative
  of_tooth_passing: boolean;
  mode: Num;
  mode_of: Owner | null;
  mode_frequency_hz?: number;
  expected_hz: Num;
  difference_hz: Num;
  tolerance_hz: Num;
  likelihood_per_hz: Num;
}

/** A peak; the reading of one that is not named is its kind alone. */
export interface ExplainedPeak extends Partial<Omit<Reading, 'kind'>> {
  frequency_hz: number;
  state: 'named' | 'ambiguous' | 'unexplained';
  kind: PeakKind;
  chatter_frequency_hz: Num;
  others: Reading[];
}

/** explain.json */
export interface ExplanationDocument {
  spindle_speed_rpm: number;
  speed_from_peaks: boolean;
  peaks: ExplainedPeak[];
  state: 'named' | 'ambiguous' | 'no chatter';
  mode: Num;
  mode_of: Owner | null;
  chatter_frequency_hz: Num;
  chatter: {
    kind: 'stable' | 'regenerative' | 'mode coupling';
    spectral_radius: Num;
    spectral_radius_without_delay: Num;
    chatter_frequency_hz: Num;
    mode: Num;
    mode_of: Owner | null;
  } | null;
}

/** simulation.json */
export interface SimulationDocument {
  spindle_speed_rpm: number;
  axial_depth_mm: number;
  verdict: 'stable' | 'chatter' | 'undecided';
  chatter_frequency_hz: Num;
  chatter_amplitude_um: Num;
  period_s: Num;
  small_vibration: { spectral_radius: Num; error_estimate: Num; period_s: Num } | null;
  missed_share: Num;
  walls: {
    angle_deg: number;
    location_error_um: Num;
    least_location_error_um: Num;
    greatest_location_error_um: Num;
    ra_um: Num;
    rz_um: Num;
  }[];
  vibrating_peak_n: Num[]; // x, y, z
  vibrating_peak_force_n: Num;
  mean_force_n: Num[];
  samples: number;
  sample_rate_hz: number;
  steps_per_revolution: number;
  error_estimate: Num;
  resolved: boolean;
  diverged: boolean;
}

/** What is recorded of a simulation for the page: curves by axis, those that do not vanish. */
export interface VibrationDocument {
  run_s: number;
  displacement_um: Record<string, Band>;
  force_n: Record<string, Band>;
  spectrum: { from_s: number; frequency_hz: number[]; x_um?: Num[]; y_um?: Num[]; z_um?: Num[] } | null;
}

type Coefficients = Record<string, Num>;

/** coefficients.json */
export interface CoefficientsDocument {
  coefficients: Coefficients; // tangential_n_per_mm2, tangential_edge_n_per_mm, …
  identification: {
    status: 'identified' | 'edge unknown';
    rows: number;
    std: Coefficients;
    r_squared: Record<string, Num>; // tangential, radial, axial
    noise_n: Record<string, Num>;
    depends_on_speed: boolean;
    speed_probability: Num;
    notes: string[];
    residuals: Slot[];
    by_speed: { spindle_speed_rpm: number; rows: number; coefficients: Coefficients; std: Coefficients }[];
  };
}

/** A slot, its mean force and what the fit leaves of it. */
export interface Slot {
  line: number;
  feed_per_tooth_mm: number;
  axial_depth_mm: number;
  spindle_speed_rpm: Num;
  force_n: [number, number, number];
  residual_n: [number, number, number];
}

/** stiffness.json: lists of one a joint, and of one a load. */
export interface StiffnessDocument {
  joint_stiffness_n_m_per_rad: Num[];
  unit: string[];
  std: Num[];
  identifiable: boolean[];
  reason: (string | null)[];
  line: number[];
  displacement_mm: [number, number, number][];
  residual_mm: [number, number, number][];
  rms_mm: Num;
  r_squared: Num;
  condition_number: Num;
  convergence: { status: 'converged' | 'not converged'; iterations: number };
}

export type JointParameter =
  | 'translational_stiffness_n_per_m'
  | 'translational_damping_n_s_per_m'
  | 'rotational_stiffness_n_m_per_rad'
  | 'rotational_damping_n_m_s_per_rad';

/** joint.json */
export interface JointDocument {
  joint: Record<JointParameter, Num>;
  objective: Num;
  relative_error: Num;
  std: Record<JointParameter, Num>;
  identifiable: Record<JointParameter, boolean>;
  visible_up_to: Partial<Record<JointParameter, Num>>;
  convergence: { status: 'converged' | 'not converged'; iterations: number; best: Num[] };
  suspect_hz: number[];
  notes: string[];
}

/** What one tool of a list comes to in the holder. */
export interface ToolRow {
  tool: string;
  teeth: Num;
  diameter_mm: number;
  overhang_mm: number;
  failure: string | null; // why what follows is not there
  peak_hz: Num;
  peak_um_per_n: Num;
  modes: { frequency_hz: number; damping_ratio: number }[];
  fit_relative_error: Num;
  suspect_lines: number;
  lowest_limit_mm: Num; // null: no cut was given, or stable at every depth searched
  recommended: {
    spindle_speed_rpm: number;
    axial_depth_mm: number;
    window_limit_mm: Num;
    removal_rate_mm3_per_s: Num;
    limited_by: string;
  } | null;
  reason: string | null;
  notes: string[];
}

export interface ToolsDocument {
  tools: ToolRow[];
  holder: { unreliable_hz: number[]; notes: string[] } | null;
}
