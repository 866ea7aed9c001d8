// What tables and plots of a smoothed program need, made of smooth.json.
import type { Fact, NearestToLimit, Num, SmoothDocument, SmoothedBy, SmoothedJoint } from './documents';
import { general, percent, scaled, significant } from './text';

/** The method asked for, then those beside it. */
export function smoothedBy(document: SmoothDocument): [SmoothedBy, ...SmoothedBy[]] {
  const [first = document, ...others] = document.methods ?? [];
  return [first, ...others];
}

export function smoothFacts({ program, blocks, cell, joints, tip, axis, gamma_deg, collisions }: SmoothDocument): Fact[] {
  const degrees = (angle: Num) => `${general(angle ?? 0, 4)}°`;
  const facts = [
    { label: 'Program', value: `${program}, ${blocks} blocks` },
    { label: 'Machine', value: `${cell}, ${joints.length} joints` },
    { label: 'Tolerance', value: `tip ${general(tip.limit_error_mm ?? 0, 4)} mm, axis ${degrees(axis.limit_error_deg)}` },
  ];
  if (gamma_deg) {
    const [lowest, highest] = gamma_deg.map(degrees);
    facts.push({ label: 'Turn about the tool', value: lowest === highest ? lowest! : `${lowest} to ${highest} along the way` });
  }
  return [...facts, { label: 'Collisions', value: collisions?.text ?? 'not checked: the cell has no [geometry]' }];
}

export function smoothWarnings({ violations, written, robot_program: program, collisions }: SmoothDocument): string[] {
  if (collisions && collisions.status !== 'clear') return [`There is no trajectory: ${collisions.text}.`];
  if (violations > 0) return [`${violations} violations of limits${written ? '; the trajectory was written all the same' : ': there is no trajectory'}.`];
  if (!program || program.holds) return [];
  return [`The robot program does not hold, see the notes; it was ${written ? 'written all the same' : 'not written'}.`];
}

/** "; without jerk limits the same path takes 11 s at least, 8.3 % less" */
export function boundText({ duration_s: duration, lower_bound_s: bound }: SmoothedBy): string {
  if (bound === null) return '';
  return `; without jerk limits the same path takes ${significant(bound)} s at least, ${percent(1 - bound / duration, 1)} less`;
}

/** The unit that a joint is shown in, and how many of it are one of the document's. */
export function jointUnit({ unit }: SmoothedJoint): [string, number] {
  return unit === 'rad' ? ['°', 180 / Math.PI] : ['mm', 1e3];
}

/** One limit and how near a method came to it. */
export interface LimitUse {
  what: string;
  unit: string;
  max: Num;
  limit: Num;
  share: Num;
  violations: number;
  at_s: Num;
  block: Num;
}

function shareOf(max: Num, limit: Num): Num {
  return max === null || limit === null ? null : max / limit;
}

function limitUse(what: string, most: Num, allowed: Num, nearest: NearestToLimit, unit: string, factor = 1): LimitUse {
  const max = scaled(most, factor);
  const limit = scaled(allowed, factor);
  return { what, unit, max, limit, share: shareOf(max, limit), ...nearest };
}

const rates = [
  { rate: 'velocity', per: '/s' },
  { rate: 'acceleration', per: '/s²' },
  { rate: 'jerk', per: '/s³' },
] as const;

function jointUses(joint: SmoothedJoint, index: number): LimitUse[] {
  const [unit, factor] = jointUnit(joint);
  const name = `joint ${index + 1}`;
  const uses = rates.map(({ rate, per }) => limitUse(`${name}, ${rate}`, joint[`max_${rate}`], joint[`limit_${rate}`], joint[rate], `${unit}${per}`, factor));
  if (joint.position.violations === 0) return uses;
  return [{ what: `${name}, beyond its range`, unit, max: scaled(joint.beyond_position, factor), limit: null, share: null, ...joint.position }, ...uses];
}

/** Every limit; of what neither tool nor joints are limited in only what is violated. */
export function limitUses(method: SmoothedBy): LimitUse[] {
  const { tip, axis, joints, faulty_samples: faulty } = method;
  const others = [
    limitUse('joints, their pose beside the tip', method.max_pose_error_mm, method.limit_pose_error_mm, method.pose_error, 'mm'),
    limitUse('dwells, cut short by', method.max_dwell_error_s, method.limit_dwell_error_s, method.dwell_error, 's'),
    { what: 'samples, faulty', unit: '', max: null, limit: null, share: null, violations: faulty, at_s: null, block: null },
  ];
  return [
    limitUse('tip, distance to the program', tip.max_error_mm, tip.limit_error_mm, tip.error, 'mm'),
    limitUse('axis, angle to the program', axis.max_error_deg, axis.limit_error_deg, axis.error, '°'),
    limitUse('tip, speed over the programmed', tip.max_share_of_feed, tip.limit_share_of_feed, tip.share_of_feed, ''),
    limitUse('tip, speed', tip.max_velocity_mm_per_s, tip.limit_velocity_mm_per_s, tip.velocity, 'mm/s'),
    limitUse('tip, acceleration', tip.max_acceleration_mm_per_s2, tip.limit_acceleration_mm_per_s2, tip.acceleration, 'mm/s²'),
    limitUse('tip, jerk', tip.max_jerk_mm_per_s3, tip.limit_jerk_mm_per_s3, tip.jerk, 'mm/s³'),
    limitUse('axis, speed', axis.max_velocity_deg_per_s, axis.limit_velocity_deg_per_s, axis.velocity, '°/s'),
    limitUse('axis, acceleration', axis.max_acceleration_deg_per_s2, axis.limit_acceleration_deg_per_s2, axis.acceleration, '°/s²'),
    limitUse('axis, jerk', axis.max_jerk_deg_per_s3, axis.limit_jerk_deg_per_s3, axis.jerk, '°/s³'),
    ...joints.flatMap(jointUses),
    ...others.filter(({ violations }) => violations > 0),
  ];
}

function largest(values: Num[]): Num {
  return values.reduce((most, value) => (value === null || (most !== null && most >= value) ? most : value), null);
}

/** The most of a joint's velocity, acceleration or jerk limit that is used. */
export function jointShare({ joints }: SmoothedBy): Num {
  return largest(
    joints.flatMap((joint) => rates.map(({ rate }) => shareOf(joint[`max_${rate}`], joint[`limit_${rate}`]))),
  );
}

/** The largest of the joints of that unit, in it; null where no drive was modelled. */
export function trackingError({ joints }: SmoothedBy, unit: SmoothedJoint['unit']): Num {
  return largest(joints.filter((joint) => joint.unit === unit).map((joint) => joint.max_tracking_error ?? null));
}
