// What robomill writes into the page: shop units, null for "none".
import type { CellDocument } from './cell_document';
import type { Decision } from './decision';
import type { Monitor, MotionDocument } from './recorded';
import type {
  Assumption,
  ChartPoint,
  CoefficientsDocument,
  ComparisonDocument,
  ExplanationDocument,
  JointDocument,
  SimulationDocument,
  StiffnessDocument,
  SurfaceDocument,
  SweepDocument,
  ToolsDocument,
  VibrationDocument,
} from './verb_documents';

export * from './recorded';
export * from './verb_documents';
export type Num = number | null;

export interface Fact {
  label: string;
  value: string;
}

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
  feed_mm_per_min: Num;
  cutting_speed_m_per_min: Num;
  torque_n_m: Num;
  power_w: Num;
  surface_error_um: Num;
  peak_deflection_um: Num;
  limited_by: string;
  chatter_frequency_hz: Num;
  mode: Num;
  mode_of: Owner | null;
}

/** What a finishing cut permits. */
export interface Finishing {
  max_surface_error_um: Num;
  max_deflection_um: Num;
}

/** How well an FRF was measured. */
export interface FrfGrade {
  grade: 'good' | 'usable' | 'poor';
  excited_band_hz: [Num, Num];
  lowest_trustworthy_frequency_hz: Num;
  faults: string[];
  remedies: string[];
}

/** tip.json: FRFs by name over one axis; hits and grades where they were measured here. */
export interface FrfDocument {
  frequency_hz: number[];
  receptance_m_per_n: Record<string, { re: Num[]; im: Num[] }>; // SI, also of rotations and moments
  coherence: Record<string, Num[]>;
  hits?: { file: string; accepted: boolean; reasons: string[] }[];
  grades?: Record<string, FrfGrade>;
}

/** A complex number by degree of freedom. */
export type ModeVector = Record<string, [number, number]>;

/** modes.json; fit and what follows only of modes that were fitted. */
export interface ModesDocument {
  modes: {
    frequency_hz: number;
    damping_ratio: number;
    left: ModeVector;
    right: ModeVector;
    std: { frequency_hz: Num; damping_ratio: Num };
  }[];
  fit?: {
    relative_error: Num;
    mean_relative_error: Num;
    relative_error_by_frf: Record<string, Num>;
    converged: boolean;
    band_hz: [Num, Num];
  };
  convergence?: { best: Num[] };
  stabilisation?: Pole[];
}

/** A pole of one model order. */
export interface Pole {
  order: number;
  frequency_hz: number;
  stable: boolean; // frequency, damping and mode shape hardly moved since the order below
}

/** In the keys of assembly.toml. */
export interface SegmentDocument {
  length_mm: number;
  diameter_mm: number;
  inner_diameter_mm: number; // 0: none
  youngs_modulus_gpa: number;
  mass_kg?: number;
  density_kg_per_m3?: number;
  loss_factor: number;
  flutes?: number;
  flute_diameter_ratio?: number;
  beam: 'timoshenko' | 'euler-bernoulli';
}

/** A tool in its holder and what is predicted of its tip. */
export interface AssemblyDocument {
  tool: SegmentDocument[];
  joint:
    | null // rigid
    | {
        translational_stiffness_n_per_m: Num;
        translational_damping_n_s_per_m: Num;
        rotational_stiffness_n_m_per_rad: Num;
        rotational_damping_n_m_s_per_rad: Num;
        cross_stiffness_n_per_rad: Num;
        points: number;
        insertion_length_mm?: Num;
        shank?: SegmentDocument[]; // of a joint of several points
      };
  holder: { segments?: SegmentDocument[]; receptances?: string };
  peaks: TipPeak[];
  relative_error: Record<string, Num> | null; // of a prediction beside a measurement
  suspect_hz: number[]; // lines where the measured holder would create energy
  unreliable_hz: number[]; // lines where a small error of the measurement became a large one
  notes: string[];
}

export interface TipPeak {
  frf: string;
  frequency_hz: number;
  receptance_m_per_n: Num;
  measured_frequency_hz: Num; // of the measured peak nearest to it
}

/** A row of lobes.json: a point where a cut begins to be unstable. */
export interface BoundaryPoint {
  spindle_speed_rpm: number;
  axial_depth_mm: Num; // of a limit, null: none up to the deepest cut that was looked at
  chatter_frequency_hz?: Num;
  kind?: Kind;
  mode?: Num;
  mode_of?: Owner | null;
}

/** lobes.json */
export interface LobesDocument {
  spindle_speed_rpm: number[];
  axial_depth_mm: number[]; // of the map; its last is the deepest cut that was looked at
  spectral_radius?: Num[][]; // a row a depth
  boundary: BoundaryPoint[];
  limit: BoundaryPoint[];
  points?: ChartPoint[]; // that were asked for
  surface?: SurfaceDocument;
  uncertainty?: { samples: number; spindle_speed_rpm: number[]; limit_5_percent_mm: Num[]; limit_95_percent_mm: Num[] };
}

/** A number for each of x, y and z. */
export type Triple = [Num, Num, Num];

/** A ring of the cutter and where its teeth are in the material. */
export interface Ring {
  height_mm: number;
  position_deg: Num;
  arcs_deg: [number, number][]; // entry and exit
}

/** What the rotation about the spindle's axis does to the robot's deflection; null where it cannot stand. */
export interface SpindleRotation {
  rotation_deg: number[];
  deflection_um: Num[];
  condition_number: Num[];
  best_deg: Num;
  best_deflection_um: Num;
  used_deg: number;
}

/** What forces.json has of one revolution. */
export interface Revolution {
  mean_n: Triple;
  peak_n: Triple;
  rms_n: Triple;
  torque_n_m: Num; // mean
  peak_torque_n_m: Num;
  power_w: Num;
  chip_area_mm2: Num;
  removal_rate_mm3_per_s: Num;
  deflection_um: Triple | null; // by the mean force; null: rigid
  peak_deflection_um: Num;
  spindle_rotation: SpindleRotation | null;
  vibration: { verdict: 'stable' | 'chatter' | 'undecided'; chatter_frequency_hz: Num } | null;
  engagement: Ring[];
  rotation_deg: number[];
  fx_n: number[];
  fy_n: number[];
  fz_n: number[];
  torque_by_rotation_n_m: number[];
  vibrating_fx_n?: number[]; // from the time-domain simulation
  vibrating_fy_n?: number[];
  vibrating_fz_n?: number[];
}

/** A block of a program: position, length and time at its end. */
export interface Block {
  block: number;
  line: number;
  x_mm: number;
  y_mm: number;
  z_mm: number;
  peak_f_n: Num;
  revolution_torque_n_m: Num;
  peak_torque_n_m: Num;
  sustained_power_w: Num;
  peak_deflection_um: Num; // null: rigid
  cuts: boolean;
  path_mm: number;
  time_s: number;
}

export interface WorstBlock extends Block {
  axial_depth_mm: Num;
  radial_depth_mm: Num;
  mean_fx_n: Num;
  mean_fy_n: Num;
  mean_fz_n: Num;
}

/** The highest value along a program, and where. */
export interface Highest {
  value: number;
  block: number;
  line: number;
}

/** What forces.json has of a program. */
export interface Program {
  cutting_blocks: number;
  power_time_s: number;
  torque_limit_n_m: Num; // of the spindle
  power_limit_w: Num;
  highest: Record<'peak_f_n' | 'revolution_torque_n_m' | 'peak_torque_n_m' | 'sustained_power_w' | 'peak_deflection_um', Highest | null>;
  worst: WorstBlock[];
  blocks: Block[]; // of a long program a part, its first and last among them
}

/** What a document says in words. */
export interface Remarks {
  facts: Fact[];
  warnings: string[];
  notes: string[];
}

/** forces.json */
export interface Forces extends Remarks, Partial<Revolution>, Partial<Program> {
  force_on: 'tool' | 'workpiece';
}

export type Regime = 'regenerative' | 'mode-coupling' | 'low-frequency' | 'none';

/** Columns of blocks.json, a value a block, null in air; one that says nothing is left out. */
export interface BlockColumns {
  block: number[];
  line: number[];
  x_mm: Num[]; // where it ends
  y_mm: Num[];
  z_mm: Num[];
  axial_depth_mm?: Num[];
  radial_depth_mm?: Num[];
  spindle_speed_rpm?: Num[];
  feed_mm_per_min?: Num[];
  spectral_radius?: Num[];
  limit_depth_mm?: Num[]; // null: none up to the depth that was searched
  limit_5_percent_mm?: Num[];
  limit_95_percent_mm?: Num[];
  stability_margin?: Num[];
  gain_margin?: Num[];
  chatter_frequency_hz?: Num[];
  mode?: (string | null)[];
  regime?: (Regime | null)[];
  lower_bound?: (boolean | null)[];
  peak_f_n?: Num[];
  torque_n_m?: Num[];
  power_w?: Num[];
  deflection_um?: Num[];
  surface_error_um?: Num[];
  condition_number?: Num[];
  measured_nearby?: (boolean | null)[];
  note?: (string | null)[];
}

/** The limit over one coordinate of the tool's pose, around one block. */
export interface LimitOver {
  parameter: 'x_mm' | 'y_mm' | 'z_mm' | 'gamma_deg';
  value: Num[];
  limit_depth_mm: Num[];
  at_block: number;
}

/** blocks.json: stability of every block of a program */
export interface BlocksDocument {
  blocks: BlockColumns;
  summary: { blocks: number; cutting: number; unstable: number; engagement_lost?: number; evaluations: number; seconds: Num; notes: string[] };
  limit_over: LimitOver[];
}

/** The limit with some of the modes alone. */
export interface PartLimits {
  label: string;
  modes: number[];
  spindle_speed_rpm: number[];
  limit_depth_mm: Num[];
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
  limit_depth_mm: Num;
  agrees: boolean | null;
  note: string;
}

export interface Agreement {
  agree: number;
  disagree: number;
  not_compared: number;
}

/** The limit with the feed in one direction. */
export interface FeedDirection {
  feed_direction_deg: number;
  lowest_limit_mm: Num; // over all speeds; null: none up to the deepest cut that was looked at
  limit_at_speed_mm?: Num; // at the recommended speed
}

/** What plan.json says beside its stages' documents. */
export interface Plan {
  facts?: Fact[]; // of a cut that lobes were computed for
  agreement: Agreement;
  recommended: Recommendation | null;
  alternatives: Recommendation[];
  reason?: string; // why nothing is recommended
  finishing: Finishing;
  other_limits: DepthCurve[];
  pairs: PartLimits[];
  limit_share: { tool: Num[]; workpiece: Num[] }; // empty: no limit was found
  cuts: Cut[];
  hit_directions?: string[]; // of each hit: "x", "-y"
  feed_direction_deg?: Num;
  feed_directions?: FeedDirection[];
  decision?: Decision | null; // on a program
  warnings: string[];
  notes: string[];
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
  verdict: Verdict | null;
  reason: string;
  rotation_hz: number;
  tooth_passing_hz: number;
  teeth: number;
  amplitude_unit: string;
  frequency_hz: number[];
  amplitude: Num[];
  peaks: Peak[];
}

/** Where a trajectory came nearest to a limit, and how many samples violate it. */
export interface NearestToLimit {
  violations: number;
  at_s: Num;
  block: number; // from 1
}

/** A limit by its name: max_velocity_mm_per_s, limit_velocity_mm_per_s (null: none), and velocity. */
export type Limited<Name extends string, Suffix extends string = ''> = Record<`max_${Name}${Suffix}` | `limit_${Name}${Suffix}`, Num> & Record<Name, NearestToLimit>;

type LimitedTool<Unit extends string> = Limited<'error', `_${Unit}`> &
  Limited<'velocity', `_${Unit}_per_s`> &
  Limited<'acceleration', `_${Unit}_per_s2`> &
  Limited<'jerk', `_${Unit}_per_s3`>;

export interface SmoothedJoint extends Limited<'velocity'>, Limited<'acceleration'>, Limited<'jerk'> {
  unit: 'rad' | 'm';
  beyond_position: Num;
  position: NearestToLimit;
  max_tracking_error?: Num; // where its drive was modelled
}

/** One method's trajectory. */
export interface SmoothedBy extends Limited<'pose_error', '_mm'>, Limited<'dwell_error', '_s'> {
  method: string;
  duration_s: number;
  lower_bound_s: Num;
  max_tip_error_mm: Num;
  max_axis_error_deg: Num;
  violations: number;
  tip: LimitedTool<'mm'> & Limited<'share_of_feed'>;
  axis: LimitedTool<'deg'>;
  joints: SmoothedJoint[];
  faulty_samples: number;
  blocks: number;
  samples: number;
  plan_seconds: Num;
  sum_t2_s: Num;
}

/** smooth.json: the method asked for, and all of them where there are several. */
export interface SmoothDocument extends SmoothedBy {
  methods?: SmoothedBy[];
  written: boolean; // there is a trajectory
  program: string;
  cell: string;
  gamma_deg: [number, number] | null; // lowest and highest turn about the tool's axis
  skipped: { line: number; what: string }[];
  notes: string[];
  robot_program: { holds: boolean } | null;
}

/** One threshold. */
export interface RocPoint {
  threshold: Num;
  false_alarm_rate: number;
  detection_rate: number;
  median_delay_s: Num;
}

/** The recordings that set the threshold, or those that verify it. */
export interface CalibratedHalf {
  stable: number;
  chatter: number;
  chosen: RocPoint;
  roc: RocPoint[];
}

/** A recording at the chosen threshold. */
export interface CalibrationRecording {
  name: string;
  label: 'stable' | 'chatter';
  half: 'setting' | 'verifying';
  early: boolean; // an alarm before chatter began
  alarm_s: Num;
  onset_s: Num;
  lead_s: Num;
}

/** calibration.json; where its status is not "found", threshold and halves are the best of what was tried. */
export interface Calibration {
  status: 'found' | 'none-detects' | 'not-verified' | 'no-better-than-chance';
  reason: string; // why it is no calibration
  entropy: string;
  threshold: Num;
  alarm: 'above' | 'below';
  setting: CalibratedHalf;
  verifying: CalibratedHalf;
  median_lead_s: Num;
  recordings: CalibrationRecording[];
}

export interface StageFile {
  stage: string;
  file: string;
  description: string;
}

/** What robomill writes into the page. */
export interface Report {
  title: string;
  created: string;
  plan: Plan | null;
  frf: FrfDocument | null; // measured, or predicted where there is an assembly
  fitted: FrfDocument | null;
  measured: FrfDocument | null; // beside predicted ones
  assembly: AssemblyDocument | null;
  modes: ModesDocument | null;
  workpiece_modes: ModesDocument | null;
  lobes: LobesDocument | null;
  forces: Forces | null;
  blocks: BlocksDocument | null;
  smooth: SmoothDocument | null;
  motion: MotionDocument | null; // of the same program
  cell: CellDocument | null;
  monitor: Monitor | null;
  calibration: Calibration | null;
  recordings: Recording[] | null;
  joint: JointDocument | null; // found with the FRFs above
  tools: ToolsDocument | null;
  sweep: SweepDocument | null;
  comparison: ComparisonDocument | null;
  explanation: ExplanationDocument | null;
  simulation: SimulationDocument | null;
  vibration: VibrationDocument | null; // of the same cut
  coefficients: CoefficientsDocument | null;
  stiffness: StiffnessDocument | null;
  assumed: Assumption[];
  warnings: string[]; // that no document holds
  notes: string[];
  files: StageFile[];
}
