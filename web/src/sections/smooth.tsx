// A smoothed program: what a machine does with it, beside its limits.
import { useState } from 'preact/hooks';
import type { LimitUse, Smooth, SmoothMethod } from '../documents';
import { cornerFigure, pathFigure } from '../figures/corners';
import { jointFigure, speedFigure } from '../figures/smooth';
import { Bullets, Details, Facts, Section, Table, WarningBox, type Column } from '../parts';
import { Choice, Plot, type Draw } from '../plot';
import { fixed, percent, significant } from '../text';

function boundOf({ duration_s: duration, lower_bound_s: bound }: SmoothMethod): string {
  if (bound === null) return '';
  return `; without jerk limits the same path takes ${significant(bound)} s at least, ${percent(1 - bound / duration, 1)} less`;
}

function Verdict({ smooth }: { smooth: Smooth }) {
  const method = smooth.methods[0]!;
  return (
    <p class="why">
      <strong>{`${significant(method.duration_s)} s`}</strong>
      {` for ${smooth.blocks} blocks by ${method.name}${boundOf(method)}. `}
      {method.violations === 0 ? (
        `None of ${method.samples} samples violates a limit.`
      ) : (
        <strong>{`${method.violations} times a sample violates a limit.`}</strong>
      )}
    </p>
  );
}

interface MethodColumn extends Column<SmoothMethod> {
  shownIf?: 'lower_bound_s' | 'joint_share' | 'tracking_error_deg' | 'tracking_error_um' | 'sum_t2_s' | 'plan_s'; // some method has it
}

const methodColumns: MethodColumn[] = [
  { heading: 'Method', cell: (m) => m.name },
  { heading: 'Duration (s)', number: true, cell: (m) => significant(m.duration_s) },
  { heading: 'Bound (s)', number: true, cell: (m) => significant(m.lower_bound_s), shownIf: 'lower_bound_s' },
  { heading: 'Violations of limits', number: true, cell: (m) => fixed(m.violations, 0) },
  { heading: 'Joint limits used', number: true, cell: (m) => percent(m.joint_share, 0), shownIf: 'joint_share' },
  { heading: 'Tip error (µm)', number: true, cell: (m) => significant(m.tip_error_um) },
  { heading: 'Axis error (°)', number: true, cell: (m) => significant(m.axis_error_deg) },
  { heading: 'Tracking error (°)', number: true, cell: (m) => significant(m.tracking_error_deg), shownIf: 'tracking_error_deg' },
  { heading: 'Tracking error (µm)', number: true, cell: (m) => significant(m.tracking_error_um), shownIf: 'tracking_error_um' },
  { heading: 'ΣT2 (s)', number: true, cell: (m) => significant(m.sum_t2_s), shownIf: 'sum_t2_s' },
  { heading: 'Planned in (s)', number: true, cell: (m) => significant(m.plan_s), shownIf: 'plan_s' },
];

function violates({ violations }: SmoothMethod | LimitUse): string {
  return violations > 0 ? 'chatter' : '';
}

function MethodsTable({ methods }: { methods: SmoothMethod[] }) {
  return (
    <Table
      caption={methods.length > 1 ? 'Methods side by side' : 'In short'}
      columns={methodColumns.filter(({ shownIf }) => shownIf === undefined || methods.some((method) => method[shownIf] !== null))}
      rows={methods}
      rowClass={violates}
    />
  );
}

function UsesTable({ method }: { method: SmoothMethod }) {
  return (
    <Table
      caption={`Limits and what ${method.name} uses of them`}
      quiet
      columns={[
        { heading: '', cell: (use) => use.what },
        { heading: 'Largest', number: true, cell: (use) => significant(use.max) },
        { heading: 'Limit', number: true, cell: (use) => significant(use.limit) },
        { heading: 'Unit', cell: (use) => use.unit },
        { heading: 'Used', number: true, cell: (use) => percent(use.share, 1) },
        { heading: 'Samples beyond', number: true, cell: ({ violations }) => (violations > 0 ? <strong>{violations}</strong> : '0') },
        { heading: 'At (s)', number: true, cell: (use) => significant(use.at_s) },
        { heading: 'Block', number: true, cell: (use) => fixed(use.block, 0) },
      ]}
      rows={method.uses}
      rowClass={violates}
    />
  );
}

function JointPlot({ methods }: { methods: SmoothMethod[] }) {
  const [joint, chooseJoint] = useState(0);
  const [chosen, chooseMethod] = useState(0);
  const method = methods[chosen]!;
  return (
    <Plot
      which="smooth-joint"
      shows="Velocity, acceleration, jerk and tracking error of one joint over time, with its limits"
      caption="One joint by differences of the samples; dashed: its limits."
      draw={(theme) => jointFigure(method, method.motion.joints[joint]!, theme)}
    >
      <Choice legend="Joint" names={methods[0]!.motion.joints.map((_, i) => `${i + 1}`)} chosen={joint} choose={chooseJoint} />
      {methods.length > 1 && <Choice legend="Method" names={methods.map(({ name }) => name)} chosen={chosen} choose={chooseMethod} />}
    </Plot>
  );
}

function Plots({ smooth }: { smooth: Smooth }) {
  const { methods, corners } = smooth;
  return (
    <>
      <Plot
        which="smooth-path"
        shows="The programmed path and the tip's, seen from above and from the side, coloured by speed"
        caption="The programmed path grey, the tip's in the colour of its speed."
        draw={(theme, width) => pathFigure(smooth, theme, width)}
      />
      {corners.length > 0 && (
        <Plot
          which="smooth-corners"
          shows="Sharp corners of the program seen close, with the tolerance and the tip's path"
          caption="Sharp corners of each kind, each in the plane of its two moves: within the shaded tube the tip is within its tolerance."
          draw={corners.map((corner): Draw => (theme, width) => cornerFigure(smooth, corner, theme, width))}
        />
      )}
      <Plot
        which="smooth-speed"
        shows="Speed of the tip and of the tool's axis over time"
        caption="Speed of the tip along its path, and of the axis below; dashed: their limits."
        draw={(theme) => speedFigure(smooth, theme)}
      />
      <JointPlot methods={methods} />
    </>
  );
}

export function SmoothSection({ smooth }: { smooth: Smooth }) {
  const { facts, warnings, notes, skipped, methods } = smooth;
  const [first, ...others] = methods as [SmoothMethod, ...SmoothMethod[]]; // the first is the one asked for
  return (
    <Section id="smooth" heading="Smoothed program" lead="How the machine runs the program, and how near it comes to each limit.">
      <Facts facts={facts} />
      <WarningBox heading="Before you run it" texts={warnings} />
      <Verdict smooth={smooth} />
      <MethodsTable methods={methods} />
      {first.motion.time_s.length > 0 && <Plots smooth={smooth} />}
      <h3>Limits and what is used of them</h3>
      <UsesTable method={first} />
      {others.map((method) => (
        <Details summary={`Limits used by ${method.name}`}>
          <UsesTable method={method} />
        </Details>
      ))}
      {skipped.length > 0 && (
        <Details summary={`${skipped.length} statement${skipped.length === 1 ? '' : 's'} of the program left out`}>
          <Bullets texts={skipped} />
        </Details>
      )}
      <Bullets texts={notes} />
    </Section>
  );
}
