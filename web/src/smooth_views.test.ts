import { expect, it } from 'vitest';
import type { SmoothDocument, SmoothedJoint } from './documents';
import { boundText, jointShare, limitUses, smoothedBy, smoothFacts, smoothWarnings, trackingError } from './smooth_views';

const place = (violations = 0) => ({ violations, at_s: 0.5, block: 3 });

function tool(unit: 'mm' | 'deg') {
  const suffixes = { error: `_${unit}`, velocity: `_${unit}_per_s`, acceleration: `_${unit}_per_s2`, jerk: `_${unit}_per_s3`, share_of_feed: '' };
  return Object.fromEntries(
    Object.entries(suffixes).flatMap(([name, suffix]) => [[`max_${name}${suffix}`, 4], [`limit_${name}${suffix}`, 8], [name, place()]]),
  ) as unknown as SmoothDocument['tip'] & SmoothDocument['axis'];
}

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
    ...more,
  };
}

function smoothed(more: Partial<SmoothDocument> = {}): SmoothDocument {
  return {
    method: 'verified',
    duration_s: 12,
    lower_bound_s: 11,
    max_tip_error_mm: 0.01,
    max_axis_error_deg: 0.02,
    violations: 0,
    tip: tool('mm'),
    axis: tool('deg'),
    joints: [joint('rad'), joint('m')],
    max_pose_error_mm: 0,
    limit_pose_error_mm: 1e-4,
    pose_error: place(),
    max_dwell_error_s: 0,
    limit_dwell_error_s: 0.002,
    dwell_error: place(),
    faulty_samples: 0,
    blocks: 16,
    samples: 12001,
    plan_seconds: 0.1,
    sum_t2_s: null,
    written: true,
    program: 'part.ngc',
    cell: 'cell.toml',
    gamma_deg: null,
    skipped: [],
    notes: [],
    robot_program: null,
    ...more,
  };
}

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
  expect(smoothFacts(smoothed()).map(({ value }) => value)).toEqual(['part.ngc, 16 blocks', 'cell.toml, 2 joints', 'tip 8 mm, axis 8°']);
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
  const struck = { status: 'collision', text: 'spindle collides with post, line 5' } as const;
  expect(smoothWarnings(smoothed({ collisions: struck }))).toEqual(['There is no trajectory: spindle collides with post, line 5.']);
  expect(smoothFacts(smoothed({ collisions: null })).at(-1)!.value).toMatch(/^not checked/);
  expect(smoothWarnings(smoothed({ violations: 7 }))).toEqual(['7 violations of limits; the trajectory was written all the same.']);
  expect(smoothWarnings(smoothed({ violations: 7, written: false }))).toEqual(['7 violations of limits: there is no trajectory.']);
  expect(smoothWarnings(smoothed({ robot_program: { holds: true } }))).toEqual([]);
  expect(smoothWarnings(smoothed({ written: false, robot_program: { holds: false } }))).toEqual(['The robot program does not hold, see the notes; it was not written.']);
});
