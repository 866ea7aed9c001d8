// What tables of a cell need, made of check.json.
import type { CellDocument, CellJoint, CellMiss, CellPosture, Fact, Num, Vector } from './documents';
import { dash, fixed, general, significant } from './text';

/** Joints are in degrees, or in millimetres where they slide. */
export function unitOf(joints: CellJoint[]): string {
  return joints.every(({ unit }) => unit === 'mm') ? 'mm' : '°';
}

export function vectorText(values: Num[], decimals: number): string {
  return values.map((value) => (value === null ? dash : fixed(Math.abs(value) < 0.5 * 10 ** -decimals ? 0 : value, decimals))).join(', ');
}

/** A limit, marked where it is assumed. */
export function limitText(joint: CellJoint, key: 'min_position' | 'max_position' | 'max_velocity_per_s' | 'max_acceleration_per_s2' | 'max_jerk_per_s3'): string {
  const value = joint[key];
  if (value === null) return dash;
  return `${significant(value)}${joint.assumed.includes(key) ? '*' : ''}`;
}

/** "origin of the workpiece", "block 12 (line 40)". */
export function placeOf({ block, line }: Pick<CellMiss, 'block' | 'line'>, program: string | null): string {
  if (program === null) return "workpiece's origin";
  return block === 0 ? "program's start" : `block ${block}${line === null ? '' : ` (line ${line})`}`;
}

/** What a posture is nearest to. */
export function nearestText({ nearest_joint: joint, to_limit }: CellPosture, unit: string): string {
  const beyond = to_limit.flatMap((distance, i) => (distance !== null && distance < 0 ? [`joint ${i + 1} by ${significant(-distance)}${unit}`] : []));
  if (beyond.length > 0) return `beyond: ${beyond.join(', ')}`;
  if (joint === null) return 'no limits';
  return `joint ${joint}, ${significant(to_limit[joint - 1] ?? null)}${unit}`;
}

export function gammaText(gamma: [number, number] | null | undefined): string {
  if (!gamma) return '';
  const [low, high] = gamma.map((angle) => `${general(angle, 4)}°`);
  return low === high ? `γ ${low}` : `γ ${low} to ${high}`;
}

export function cellFacts({ cell, robot, joints, placement }: CellDocument): Fact[] {
  const kind = robot.kind === 'serial' ? `arm of ${joints.length} joints` : 'hybrid machine 2-UPR-RPU';
  const facts = [
    { label: 'Cell', value: cell },
    { label: 'Robot', value: robot.description ?? kind },
    { label: 'Workpiece', value: poseText(placement.origin_mm, placement.rotation_deg) },
  ];
  if (robot.model) facts.push({ label: 'Model', value: robot.model });
  if (placement.program) facts.push({ label: 'Program', value: placement.program });
  return facts;
}

export function poseText(origin_mm: Vector, rotation_deg: Vector): string {
  return `(${vectorText(origin_mm, 1)}) mm, (${vectorText(rotation_deg, 2)})°`;
}
