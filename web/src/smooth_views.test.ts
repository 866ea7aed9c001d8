import { expect, it } from 'vitest';
import type { SmoothDocument, SmoothedJoint } from './documents';
import { sampleReport } from './report_sample';

const sample = sampleReport().smooth!;
import { boundText, jointShare, limitUses, smoothedBy, smoothFacts, smoothWarnings, trackingError } from './smooth_views';

const place = (violations = 0) => ({ violations, at_s: 0.5, block: 3 });

function joint(unit: 'rad' | 'm', more: Partial<SmoothedJoint> = {}): SmoothedJoint {
  return {
    unit,
    max_velocity: 0.5,
    limit_velocity: 1,
    velocity: place(),
    max_acceleration: 3,
    limit_acceleration: 4,
    acceleration: place(),
    max_jerk: 5,
    limit_jerk: null,
    jerk: place(),
    beyond_position: 0,
    position: place(),
    violations: 0,
    ...more,
  };
}

function smoothed(more: Partial<SmoothDocument> = {}): SmoothDocument {
  const { methods: _, ...document } = sample;
  return {
    ...document,
    duration_s: 12,
    lower_bound_s: 11,
    violations: 0,
    tip: { ...sample.tip, max_error_mm: 4, limit_error_mm: 8, error: place() },
    joints: [joint('rad'), joint('m')],
    notes: [],
    ...more,
  };
}

type Collisions = NonNullable<SmoothDocument['collisions']>;
const struck: Collisions = {
  status: 'collision',
  bodies: ['spindle', 'post'],
  least_distance_mm: null,
  depth_mm: 3,
  clearance_mm: 5,
  looked_within_mm: 50,
  block: 2,
  line: 5,
  at_s: 1.2,
  positions: 400,
  most_between_mm: 1,
  text: 'spindle collides with post, line 5',
};

const robotProgram: NonNullable<SmoothDocument['robot_program']> = {
  points: 120,
  shortest_step_ms: 4,
  longest_step_ms: 12,
  max_joint_deviation_deg: 0.01,
  max_tip_deviation_mm: 0.02,
  max_axis_deviation_deg: 0.01,
  max_tip_error_mm: 0.03,
  max_axis_error_deg: 0.02,
  limit_error_mm: 0.05,
  limit_error_deg: 0.1,
  spindle_speeds_rpm: [9000],
  most_points: null,
  holds: true,
};

it('lists every limit in the units of the shop', () => {
  const uses = limitUses(smoothed());
  expect(uses).toHaveLength(9 + 2 * 3);
  expect(uses[0]).toEqual({ what: 'tip, distance to the program', unit: 'mm', max: 4, limit: 8, share: 0.5, violations: 0, at_s: 0.5, block: 3 });
  expect(uses[9]).toMatchObject({ what: 'joint 1, velocity', unit: '°/s', share: 0.5 });
  expect(uses[9]!.max).toBeCloseTo(28.65, 2);
  expect(uses[14]).toMatchObject({ what: 'joint 2, jerk', unit: 'mm/s³', max: 5000, limit: null, share: null });
});

it('lists what has no limit of its own where it is violated', () => {
  const beyond = joint('m', { beyond_position: 0.002, position: place(4) });
  const uses = limitUses(smoothed({ joints: [beyond], pose_error: place(1), dwell_error: place(2), faulty_samples: 3 }));
  expect(uses.filter(({ violations }) => violations > 0).map(({ what, violations }) => [what, violations])).toEqual([
    ['joint 1, beyond its range', 4],
    ['joints, their pose beside the tip', 1],
    ['dwells, cut short by', 2],
    ['samples, faulty', 3],
  ]);
  expect(uses[9]).toMatchObject({ max: 2, limit: null, unit: 'mm' });
});

it('takes the most of all joints, the largest tracking error of each kind', () => {
  expect(jointShare(smoothed())).toBe(0.75);
  const free = { limit_velocity: null, limit_acceleration: null };
  expect(jointShare(smoothed({ joints: [joint('m', free)] }))).toBeNull();
  const joints = [joint('rad', { max_tracking_error: 0.1 }), joint('rad', { max_tracking_error: 0.3 }), joint('m')];
  expect([trackingError(smoothed({ joints }), 'rad'), trackingError(smoothed({ joints }), 'm')]).toEqual([0.3, null]);
});

it('is its own method where there is one alone', () => {
  const alone = smoothed();
  expect(smoothedBy(alone)).toEqual([alone]);
  expect(smoothedBy({ ...alone, methods: [alone, { ...alone, method: 'paper' }] }).map(({ method }) => method)).toEqual(['verified', 'paper']);
});

it('says what was run, and how the flange turns', () => {
  expect(smoothFacts(smoothed()).map(({ value }) => value)).toEqual(['zigzag.ngc, 12 blocks', 'cell.toml, 2 joints', 'tip 8 mm, axis 0.1°', 'not checked: the cell has no [geometry]']);
  const turn = (lowest: number, highest: number) => smoothFacts(smoothed({ gamma_deg: [lowest, highest] }))[3];
  expect(turn(30, 30)).toEqual({ label: 'Turn about the tool', value: '30°' });
  expect(turn(-30, 45.5)?.value).toBe('-30° to 45.5° along the way');
});

it('sets the duration beside its bound', () => {
  expect(boundText(smoothed())).toBe('; without jerk limits the same path takes 11 s at least, 8.3\u202f% less');
  expect(boundText(smoothed({ lower_bound_s: null }))).toBe('');
});

it('warns of what does not hold', () => {
  expect(smoothWarnings(smoothed())).toEqual([]);
  expect(smoothWarnings(smoothed({ collisions: struck }))).toEqual(['There is no trajectory: spindle collides with post, line 5.']);
  expect(smoothFacts(smoothed({ collisions: null })).at(-1)!.value).toMatch(/^not checked/);
  expect(smoothWarnings(smoothed({ violations: 7 }))).toEqual(['7 violations of limits; the trajectory was written all the same.']);
  expect(smoothWarnings(smoothed({ violations: 7, written: false }))).toEqual(['7 violations of limits: there is no trajectory.']);
  expect(smoothWarnings(smoothed({ robot_program: robotProgram }))).toEqual([]);
  expect(smoothWarnings(smoothed({ written: false, robot_program: { ...robotProgram, holds: false } }))).toEqual(['The robot program does not hold, see the notes; it was not written.']);
});
