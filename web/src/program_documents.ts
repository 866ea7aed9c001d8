// A program: the forces and the stability of its blocks, and its smoothed trajectory.
import type { BlocksDocument as WrittenBlocks } from '#schema/blocks';
import type { Num } from './parts_of_documents';

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

type WholeBlocks = Required<WrittenBlocks['blocks']>;
/** Columns of blocks.json; a report leaves out those that say nothing. */
export type BlockColumns = Partial<WholeBlocks> & Pick<WholeBlocks, 'block' | 'line' | 'x_mm' | 'y_mm' | 'z_mm'>;
export type BlocksDocument = Omit<WrittenBlocks, 'blocks'> & { blocks: BlockColumns };
export type Regime = NonNullable<WholeBlocks['regime'][number]>;
/** The limit over one coordinate of the tool's pose, around one block. */
export type LimitOver = BlocksDocument['limit_over'][number];

/** Where a trajectory came nearest to a limit, and how many samples violate it. */
export interface NearestToLimit {
  violations: number;
  at_s: Num;
  block: number; // from 1
}

/** A limit by its name: max_velocity_mm_per_s, limit_velocity_mm_per_s (null: none), and velocity. */
type Limited<Name extends string, Suffix extends string = ''> = Record<`max_${Name}${Suffix}` | `limit_${Name}${Suffix}`, Num> & Record<Name, NearestToLimit>;

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
  collisions?: { status: 'clear' | 'too_near' | 'gouge' | 'collision'; text: string } | null; // null: not checked
}
