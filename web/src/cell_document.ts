// check.json: what robomill found of a robot cell.
import type { Num } from './parts_of_documents';
import type { Assumption } from './verb_documents';

export type Vector = [number, number, number];
/** Of a joint that can be anywhere: null. */
type ByJoint = Num[];

export interface CellJoint {
  joint: number;
  unit: 'deg' | 'mm';
  min_position: Num;
  max_position: Num;
  max_velocity_per_s: Num;
  max_acceleration_per_s2: Num;
  max_jerk_per_s3: Num;
  assumed: string[]; // keys of this row
}

export interface CellPosture {
  name: string;
  joints: ByJoint;
  tip_mm: Vector; // in the robot's base
  axis: Vector;
  program_tip_mm: Vector;
  program_axis: Vector;
  gamma_deg: Num;
  flange: { origin_mm: Vector; abc_deg: Vector; quaternion: number[]; rotation_vector_rad: Vector };
  to_limit: ByJoint; // < 0: beyond
  nearest_joint: Num;
  condition_number: Num;
}

/** A pose that the tool cannot take. */
export interface CellMiss {
  block: number; // 0: the start, or the workpiece's origin
  line: Num;
  base_tip_mm: Vector;
  state: 'out of reach' | 'outside limits' | 'singular';
  text: string;
}

interface WorkpiecePose {
  origin_mm: Vector;
  rotation_deg: Vector;
}
interface Reached {
  margin: Num;
  gamma_deg: [number, number] | null; // lowest and highest turn about the tool
}

export interface CellPlacement extends WorkpiecePose, Partial<Reached> {
  works: boolean;
  program: string | null;
  whole: boolean;
  poses: number;
  complete: boolean; // else the poses after the last miss were not looked at
  missed: number;
  misses: CellMiss[];
  no_way: string | null;
}

export interface CellProposal extends WorkpiecePose, Reached {
  shift_mm: Vector;
  turn_deg: number;
}

/** The machine as lines. */
export interface CellFigure {
  name: string;
  links_mm: Vector[][];
  joints_mm: Vector[];
  flange_mm: Vector;
  tip_mm: Vector;
}

export interface CellDocument {
  cell: string;
  robot: { kind: string; model: string | null; description: string | null; source: string | null };
  joints: CellJoint[];
  postures: CellPosture[];
  at_limits: CellPosture[];
  placement: CellPlacement;
  proposals: CellProposal[];
  drawing: {
    figures: CellFigure[];
    reach_side_mm: [number, number][][]; // x and z
    reach_top_mm: [number, number][][]; // x and y
    program_mm: Vector[];
  };
  assumed: Assumption[];
  notes: string[];
}
