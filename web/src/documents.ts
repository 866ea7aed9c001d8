// What robomill writes into the page: documents, whose types come from their schemas.
import type { Documents } from '#schema/documents';

export type * from './parts_of_documents';

/** The parts of a report that are documents, and which. */
export const members = {
  plan: 'plan', // without the documents of its stages
  frf: 'frf', // measured, or predicted where there is an assembly
  fitted: 'frf',
  measured: 'frf', // beside predicted ones
  assembly: 'assembly',
  modes: 'modes',
  workpiece_modes: 'modes',
  lobes: 'lobes',
  recordings: 'recordings',
  forces: 'forces',
  blocks: 'blocks',
  smooth: 'smooth',
  motion: 'motion', // of the smoothed program
  cell: 'check',
  monitor: 'monitor',
  calibration: 'calibration',
  joint: 'joint', // found with the FRFs above
  tools: 'tools',
  sweep: 'sweep',
  comparison: 'comparison',
  postures: 'postures',
  statistics: 'statistics', // of a study
  study_points: 'study_points',
  explanation: 'explain',
  simulation: 'simulation',
  vibration: 'vibration', // of the simulated cut
  coefficients: 'coefficients',
  stiffness: 'stiffness',
} as const;

/** What was taken because nobody said it; key and file are null where nothing can be set. */
export type Assumption = Documents['forces']['assumed'][number];

// Lobes and the plan
export type LobesDocument = Documents['lobes'];
export type SweepDocument = Documents['sweep'];
export type ComparisonDocument = Documents['comparison'];
export type PosturesDocument = Documents['postures'];
/** The limit at one speed. */
export type LimitRow = LobesDocument['limit'][number];
export type LobesPoint = LobesDocument['points'][number];
/** A point that was asked for; in a sweep the parameter's value is there in place of the depth. */
export type ChartPoint = SweepDocument['points'][number] & Partial<Pick<LobesPoint, 'axial_depth_mm'>>;
export type Plan = Documents['plan'];
export type Recommendation = NonNullable<Plan['recommended']>;
export type Finishing = Plan['finishing'];
export type Agreement = Plan['agreement'];
export type PartLimits = Plan['pairs'][number];
export type DepthCurve = Plan['other_limits'][number];
export type Cut = Plan['cuts'][number];
export type Verdict = NonNullable<Cut['result']>;

// The decision on a program
export type Decision = NonNullable<Plan['decision']>;
export type Outcome = Decision['as_programmed'];
/** A limit that a program violates, in the block where it is worst. */
export type Violation = Outcome['violations'][number];
/** A spindle speed that was not chosen. */
export type OtherSpeed = Decision['alternatives'][number];
/** Blocks that follow each other at one spindle speed. */
export type Stretch = Decision['stretches'][number];
/** Stability margin over the place along the path and the turn γ: a row a γ; null: the robot cannot stand there. */
export type GammaMap = NonNullable<Decision['gamma_map']>;

// A study
export type StudyPoints = Documents['study_points'];
/** A key or a value at each of these points. */
export type StudyColumn = StudyPoints['keys'][number];
type Statistics = Documents['statistics'];
export type BoundaryResult = NonNullable<Statistics['boundary']>;
export type SensitivityRow = NonNullable<Statistics['sensitivity']>[number];
export type ProbabilityResult = NonNullable<Statistics['probability']>;
export type ProbabilityRow = ProbabilityResult['rows'][number];
/** Keys and what they are set to, as TOML writes it. */
export type Settled = ProbabilityRow['at'];

// The structure
export type FrfDocument = Shown['frf'];
export type ModesDocument = Documents['modes'];
/** A complex number by degree of freedom. */
export type ModeVector = ModesDocument['modes'][number]['left'];
/** A pole of one model order. */
export type Pole = NonNullable<ModesDocument['stabilisation']>[number];
export type AssemblyDocument = Documents['assembly'];
export type SegmentDocument = AssemblyDocument['tool'][number];
export type TipPeak = AssemblyDocument['peaks'][number];
export type JointDocument = Documents['joint'];
export type ToolsDocument = Documents['tools'];
export type ToolRow = ToolsDocument['tools'][number];
export type StiffnessDocument = Documents['stiffness'];

// One cut
export type ExplanationDocument = Documents['explain'];
/** A peak; the reading of one that is not named is its kind alone. */
export type ExplainedPeak = ExplanationDocument['peaks'][number];
export type PeakKind = ExplainedPeak['kind'];
/** One way to read a peak. */
export type Reading = ExplainedPeak['others'][number];
export type SimulationDocument = Documents['simulation'];
export type VibrationDocument = Documents['vibration'];
/** The spectrum of a test cut. */
export type Recording = Documents['recordings']['recordings'][number];
export type Peak = Recording['peaks'][number];
export type Calibration = Documents['calibration'];
/** The recordings that set the threshold, or those that verify it. */
export type CalibratedHalf = Calibration['setting'];
/** One threshold. */
export type RocPoint = CalibratedHalf['chosen'];
export type CalibrationRecording = Calibration['recordings'][number];

export type CoefficientsDocument = Documents['coefficients'];
/** A slot, its mean force and what the fit leaves of it. */
export type Slot = CoefficientsDocument['identification']['residuals'][number];

// A robot cell
export type CellDocument = Documents['check'];
export type CellJoint = CellDocument['joints'][number];
export type CellPosture = CellDocument['postures'][number];
export type Vector = CellPosture['tip_mm'];
export type CellPlacement = CellDocument['placement'];
/** A pose that the tool cannot take. */
export type CellMiss = CellPlacement['misses'][number];
export type CellFigure = CellDocument['drawing']['figures'][number];

// A recording that was monitored
export type Monitor = Documents['monitor'];
/** A line of events.jsonl. */
export type MonitorEvent = Monitor['events'][number];
/** Alarms of about one frequency that follow each other; of their frequencies chatter_frequency_hz is the surest. */
export type MonitorAlarm = Monitor['alarms'][number];
/** Why the monitor decided as it did. */
export type MonitorWhy = NonNullable<MonitorAlarm['why']>;
export type MonitorStay = Monitor['stays'][number];
export type MonitorState = MonitorStay['state'];
/** Why no speed is suggested. */
export type NoSpeed = NonNullable<MonitorAlarm['no_speed']>;

// Forces over a revolution, along a program, and over the turn about the spindle's axis
export type Forces = Shown['forces'];
type ForcesWith<Key extends keyof Forces> = Forces & Required<Pick<Forces, Key>>;
export type Revolution = ForcesWith<
  'mean_n' | 'peak_n' | 'rms_n' | 'torque_n_m' | 'peak_torque_n_m' | 'power_w' | 'chip_area_mm2' | 'removal_rate_mm3_per_s' | 'deflection_um' | 'peak_deflection_um' | 'vibration' | 'engagement' | 'rotation_deg' | 'fx_n' | 'fy_n' | 'fz_n' | 'torque_by_rotation_n_m'
>;
export type Program = ForcesWith<'cutting_blocks' | 'power_time_s' | 'torque_limit_n_m' | 'power_limit_w' | 'highest' | 'worst' | 'blocks'>;
/** A ring of the cutter and where its teeth are in the material. */
export type Ring = Revolution['engagement'][number];
/** A force record beside the revolution. */
export type MeasuredForces = NonNullable<Forces['measured']>;
export type SpindleRotation = NonNullable<Forces['spindle_rotation']>;
export type WorstBlock = NonNullable<Documents['forces']['worst']>[number];
type HighestValues = NonNullable<Documents['forces']['highest']>;
/** The highest value along a program, and where. */
export type Highest = NonNullable<HighestValues[keyof HighestValues]>;
export type Block = Pick<WorstBlock, 'block' | 'line' | 'x_mm' | 'y_mm' | 'z_mm' | keyof HighestValues | 'cuts' | 'path_mm' | 'time_s'>;

// The blocks of a program
type WholeBlocks = Required<Documents['blocks']['blocks']>;
/** Columns of blocks.json; a report leaves out those that say nothing. */
export type BlockColumns = Partial<WholeBlocks> & Pick<WholeBlocks, 'block' | 'line' | 'x_mm' | 'y_mm' | 'z_mm'>;
export type BlocksDocument = Shown['blocks'];
export type Regime = NonNullable<WholeBlocks['regime'][number]>;
/** The limit over one coordinate of the tool's pose, around one block. */
export type LimitOver = BlocksDocument['limit_over'][number];

// A smoothed program
export type SmoothDocument = Documents['smooth'];
/** One method's trajectory. */
export type SmoothedBy = NonNullable<SmoothDocument['methods']>[number];
export type SmoothedJoint = SmoothedBy['joints'][number];
/** Where a trajectory came nearest to a limit, and how many samples violate it. */
export type NearestToLimit = SmoothedJoint['velocity'];
export type MotionDocument = Documents['motion'];
/** One method's trajectory over time: bands over runs of run_s each. */
export type Motion = MotionDocument['motions'][number];
export type JointMotion = Motion['joints'][number];
export type Corner = MotionDocument['corners'][number];
/** One point after another in the work frame. */
export type Places = MotionDocument['program'];

/** As the page has them: it shows neither deviations nor what a reader left out, and of long programs some columns. */
interface Shown extends Omit<Documents, 'frf' | 'forces' | 'blocks'> {
  frf: Omit<Documents['frf'], 'deviation_m_per_n'>;
  forces: Omit<Documents['forces'], 'skipped' | 'blocks'> & { blocks?: Block[] };
  blocks: Omit<Documents['blocks'], 'blocks'> & { blocks: BlockColumns };
}

export interface StageFile {
  stage: string;
  file: string;
  description: string;
}

/** What robomill writes into the page. */
export type Report = { -readonly [Member in keyof typeof members]: Shown[(typeof members)[Member]] | null } & {
  title: string;
  created: string;
  assumed: Assumption[];
  warnings: string[]; // that no document holds
  notes: string[];
  files: StageFile[];
};
