// What robomill writes into the page: shop units, null for "none". Types of documents with a schema come from it.
import type { ComparisonDocument } from '#schema/comparison';
import type { LobesDocument } from '#schema/lobes';
import type { SweepDocument } from '#schema/sweep';
import type { CellDocument } from './cell_document';
import type { Decision } from './decision';
import type { Fact, Num, Owner, Remarks } from './parts_of_documents';
import type { BlocksDocument, Program, SmoothDocument } from './program_documents';
import type { Monitor, MotionDocument } from './recorded';
import type {
  Assumption,
  CoefficientsDocument,
  ExplanationDocument,
  JointDocument,
  SimulationDocument,
  StiffnessDocument,
  ToolsDocument,
  VibrationDocument,
} from './verb_documents';

export * from './parts_of_documents';
export * from './program_documents';
export * from './recorded';
export * from './verb_documents';
export type { ComparisonDocument, LobesDocument, SweepDocument };

export type Verdict = 'stable' | 'borderline' | 'chatter';
/** The limit at one speed. */
export type LimitRow = LobesDocument['limit'][number];
export type LobesPoint = LobesDocument['points'][number];
/** A point that was asked for; in a sweep the parameter's value is there in place of the depth. */
export type ChartPoint = SweepDocument['points'][number] & Partial<Pick<LobesPoint, 'axial_depth_mm'>>;
/** Of the tip about its mean position. */
export interface ForcedVibration {
  amplitude_um: Num;
  harmonic: number;
  of: 'tooth passing' | 'rotation';
  frequency_hz: Num;
  harmonic_um: Num;
  mode: Num;
  mode_of: Owner | null;
}

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
  forced_vibration: ForcedVibration | null; // null: not computed
  limited_by: string;
  window_chatter_frequency_hz: Num;
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
    modal_stiffness_n_per_um?: Num; // in the direction in which the mode moves most
    modal_mass_kg?: Num;
    weak?: boolean; // the FRFs hardly show it
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

/** forces.json */
export interface Forces extends Remarks, Partial<Revolution>, Partial<Program> {
  force_on: 'tool' | 'workpiece';
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
