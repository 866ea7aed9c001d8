// A smoothed program: what a machine does with it, beside its limits.
import { useState } from 'preact/hooks';
import type { MotionDocument, Num, SmoothDocument, SmoothedBy } from '../documents';
import { cornerFigure, pathFigure } from '../figures/corners';
import { jointFigure, speedFigure } from '../figures/smooth';
import { Bullets, Details, Facts, Section, Table, WarningBox, type Column } from '../parts';
import { Choice, Plot, type Draw } from '../plot';
import { boundText, jointShare, limitUses, smoothedBy, smoothFacts, smoothWarnings, trackingError } from '../smooth_views';
import { fixed, percent, scaled, significant } from '../text';

function Verdict({ method }: { method: SmoothedBy }) {
  return (
    <p class="why">
      <strong>{`${significant(method.duration_s)} s`}</strong>
      {` for ${method.blocks} blocks by ${method.method}${boundText(method)}. `}
      {method.violations === 0 ? (
        `None of ${method.samples} samples violates a limit.`
      ) : (
        <strong>{`${method.violations} times a sample violates a limit.`}</strong>
      )}
    </p>
  );
}

function ifKnown(heading: string, value: (method: SmoothedBy) => Num, text: (value: Num) => string = significant): Column<SmoothedBy> {
  return { heading, number: true, optional: true, cell: (m) => text(value(m)) };
}

const methodColumns: Column<SmoothedBy>[] = [
  { heading: 'Method', cell: (m) => m.method },
  { heading: 'Duration (s)', number: true, cell: (m) => significant(m.duration_s) },
  ifKnown('Bound (s)', (m) => m.lower_bound_s),
  { heading: 'Violations of limits', number: true, cell: (m) => fixed(m.violations, 0) },
  ifKnown('Joint limits used', jointShare, (share) => percent(share, 0)),
  { heading: 'Tip error (µm)', number: true, cell: (m) => significant(scaled(m.max_tip_error_mm, 1e3)) },
  { heading: 'Axis error (°)', number: true, cell: (m) => significant(m.max_axis_error_deg) },
  ifKnown('Tracking error (°)', (m) => scaled(trackingError(m, 'rad'), 180 / Math.PI)),
  ifKnown('Tracking error (µm)', (m) => scaled(trackingError(m, 'm'), 1e6)),
  ifKnown('ΣT2 (s)', (m) => m.sum_t2_s),
  { heading: 'Planned in (s)', number: true, cell: (m) => significant(m.plan_seconds) },
];

function violates({ violations }: { violations: number }): string {
  return violations > 0 ? 'chatter' : '';
}

function MethodsTable({ methods }: { methods: SmoothedBy[] }) {
  return (
    <Table
      caption={methods.length > 1 ? 'Methods side by side' : 'In short'}
      columns={methodColumns}
      rows={methods}
      rowClass={violates}
    />
  );
}

function UsesTable({ method }: { method: SmoothedBy }) {
  return (
    <Table
      caption={`Limits and what ${method.method} uses of them`}
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
      rows={limitUses(method)}
      rowClass={violates}
    />
  );
}

interface Documents {
  smooth: SmoothDocument;
  motion: MotionDocument;
}

function JointPlot({ smooth, motion: { motions } }: Documents) {
  const [joint, chooseJoint] = useState(0);
  const [chosen, chooseMethod] = useState(0);
  const methods = smoothedBy(smooth);
  return (
    <Plot
      which="smooth-joint"
      shows="Velocity, acceleration, jerk and tracking error of one joint over time, with its limits"
      caption="One joint by differences of the samples; dashed: its limits."
      draw={(theme) => jointFigure(methods[chosen]!, motions[chosen]!, joint, theme)}
    >
      <Choice legend="Joint" names={smooth.joints.map((_, i) => `${i + 1}`)} chosen={joint} choose={chooseJoint} />
      {methods.length > 1 && <Choice legend="Method" names={methods.map(({ method }) => method)} chosen={chosen} choose={chooseMethod} />}
    </Plot>
  );
}

function Plots({ smooth, motion }: Documents) {
  return (
    <>
      <Plot
        which="smooth-path"
        shows="The programmed path and the tip's, seen from above and from the side, coloured by speed"
        caption="The programmed path grey, the tip's in the colour of its speed."
        draw={(theme, width) => pathFigure(motion, theme, width)}
      />
      {motion.corners.length > 0 && (
        <Plot
          which="smooth-corners"
          shows="Sharp corners of the program seen close, with the tolerance and the tip's path"
          caption="Sharp corners of each kind, each in the plane of its two moves: within the shaded tube the tip is within its tolerance."
          draw={motion.corners.map((_, i): Draw => (theme, width) => cornerFigure(smooth, motion, i, theme, width))}
        />
      )}
      <Plot
        which="smooth-speed"
        shows="Speed of the tip and of the tool's axis over time"
        caption="Speed of the tip along its path, and of the axis below; dashed: their limits."
        draw={(theme) => speedFigure(smooth, motion, theme)}
      />
      <JointPlot smooth={smooth} motion={motion} />
    </>
  );
}

/** Whether there is something to draw. */
function isMoved(motion: MotionDocument | null): motion is MotionDocument {
  return (motion?.motions[0]?.tip_speed_mm_per_s.low.length ?? 0) > 0;
}

export function SmoothSection({ smooth, motion }: { smooth: SmoothDocument; motion: MotionDocument | null }) {
  const { notes, skipped } = smooth;
  const methods = smoothedBy(smooth);
  const [first, ...others] = methods; // the first is the one asked for
  return (
    <Section id="smooth" heading="Smoothed program" lead="How the machine runs the program, and how near it comes to each limit.">
      <Facts facts={smoothFacts(smooth)} />
      <WarningBox heading="Before you run it" texts={smoothWarnings(smooth)} />
      <Verdict method={first} />
      <MethodsTable methods={methods} />
      {isMoved(motion) && <Plots smooth={smooth} motion={motion} />}
      <h3>Limits and what is used of them</h3>
      <UsesTable method={first} />
      {others.map((method) => (
        <Details summary={`Limits used by ${method.method}`}>
          <UsesTable method={method} />
        </Details>
      ))}
      {skipped.length > 0 && (
        <Details summary={`${skipped.length} statement${skipped.length === 1 ? '' : 's'} of the program left out`}>
          <Bullets texts={skipped.map(({ line, what }) => `line ${line}: ${what}`)} />
        </Details>
      )}
      <Bullets texts={notes} />
    </Section>
  );
}
