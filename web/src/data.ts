/** What robomill writes into the page: shop units, null for "none". */
export type Num = number | null;
export type Verdict = 'stable' | 'borderline' | 'chatter';
export type Kind = 'hopf' | 'flip' | 'fold';
/** The structure that a mode belongs to. */
export type Owner = 'tool' | 'workpiece';

export interface Recommendation {
  spindle_speed_rpm: number;
  axial_depth_mm: number;
  feed_per_tooth_mm: Num;
  margin: Num;
  removal_rate_mm3_per_s: Num;
  limited_by: string;
  chatter_frequency_hz: Num;
  mode: Num;
  mode_of: Owner | null;
}

export interface Curve {
  magnitude: Num[];
  phase_deg: Num[];
}

export interface Frf {
  name: string;
  unit: string;
  frequency_hz: number[];
  measured_frequency_hz: number[] | null; // where measured has an axis of its own
  measured: Curve | null;
  predicted: Curve | null;
  fitted: Curve | null;
  coherence: Num[] | null;
  trusted_from_hz: Num;
  trusted_to_hz: Num;
  suspect_bands_hz: [number, number][];
  unreliable_bands_hz: [number, number][];
}

export interface Mode {
  mode: number;
  mode_of: Owner;
  frequency_hz: number;
}

export interface Fit {
  convergence: Num[];
  stabilisation: { order: number[]; frequency_hz: number[]; stable: boolean[] } | null;
}

export interface Lobes {
  label: string;
  modes: number[];
  spindle_speed_rpm: number[];
  limit_mm: Num[];
  searched_depth_mm: Num;
  band: { label: string; spindle_speed_rpm: number[]; low_mm: Num[]; high_mm: Num[] } | null;
  boundary: {
    spindle_speed_rpm: number[];
    axial_depth_mm: number[];
    chatter_frequency_hz: Num[];
    kind: Kind[];
    mode: Num[];
    mode_of: (Owner | null)[];
  };
  map: { spindle_speed_rpm: number[]; axial_depth_mm: number[]; spectral_radius: Num[][] } | null;
}

export interface DepthCurve {
  label: string;
  spindle_speed_rpm: number[];
  axial_depth_mm: Num[];
}

export interface Cut {
  spindle_speed_rpm: number;
  axial_depth_mm: number;
  result: Verdict | null;
  predicted: Verdict | null;
  limit_mm: Num;
  agrees: boolean | null;
  note: string;
}

export interface FeedDirections {
  direction_deg: number[];
  lowest_limit_mm: Num[];
  limit_at_speed_mm: Num[] | null;
  spindle_speed_rpm: Num;
  used_direction_deg: Num;
  searched_depth_mm: Num;
}

export interface Peak {
  frequency_hz: number;
  amplitude: number;
  kind: 'rotation' | 'tooth_passing' | 'chatter' | 'cut_or_chatter' | 'other';
  text: string;
}

export interface Recording {
  file: string;
  rotation_hz: number;
  tooth_passing_hz: number;
  teeth: number;
  amplitude_unit: string;
  frequency_hz: number[];
  amplitude: Num[];
  peaks: Peak[];
}

export interface Ring {
  height_mm: number;
  position_deg: Num;
  arcs: { entry_deg: number; exit_deg: number }[];
}

export interface Revolution {
  on: 'tool' | 'workpiece';
  rotation_deg: number[];
  fx_n: number[];
  fy_n: number[];
  fz_n: number[];
  torque_n_m: number[];
  engagement: Ring[];
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

export interface Program {
  torque_limit_n_m: Num;
  power_limit_w: Num;
  power_time_s: number;
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

export interface Forces {
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

export interface SmoothMethod {
  name: string;
  duration_s: number;
  motion: Motion;
}

export interface Corner {
  block: number;
  line: number;
  turn_deg: number;
  radius_mm: number;
  program: { x_mm: number[]; y_mm: number[] };
  ways: { x_mm: number[]; y_mm: number[] }[]; // one a method
}

export interface Smooth {
  tip_tolerance_mm: number;
  max_tip_speed_mm_per_s: Num;
  max_axis_speed_deg_per_s: Num;
  program: Places;
  methods: SmoothMethod[];
  corners: Corner[];
}

export type MonitorState = 'stable' | 'transition' | 'chatter';

export interface Monitor {
  unit: string;
  entropy_unit: string;
  wave_time_s: number[];
  channels: { name: string; wave: number[] }[];
  spectrogram: { channel: string; begin_s: number; step_s: number; frequency_hz: number[]; level_db: number[][] } | null; // a row a frequency
  decisions: { time_s: number[]; score: number[]; threshold: number[]; energy_entropy: number[] | null; spindle_speed_rpm: number[] | null };
  stays: { state: MonitorState; from_s: number; to_s: number }[];
  events: { time_s: number; state: MonitorState; chatter_frequency_hz: Num }[];
}

export interface Calibration {
  false_alarm_rate: Num;
  detection_rate: Num;
  curves: { label: string; false_alarm_rate: number[]; detection_rate: number[]; threshold: Num[] }[];
}

export interface Report {
  recommendation: Recommendation | null;
  alternatives: Recommendation[];
  frfs: Frf[];
  modes: Mode[];
  fit: Fit | null;
  lobes: Lobes[];
  other_limits: DepthCurve[];
  cuts: Cut[];
  feed_directions: FeedDirections | null;
  forces: Forces | null;
  smooth: Smooth | null;
  recordings: Recording[];
  monitor: Monitor | null;
  calibration: Calibration | null;
}
