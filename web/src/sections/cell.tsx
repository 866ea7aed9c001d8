// A robot cell: where its joints put the tool, and whether that comes to the workpiece.
import type { CellDocument, CellPlacement, CellPosture } from '../documents';
import { cellFacts, gammaText, limitText, nearestText, placeOf, poseText, unitOf, vectorText } from '../cell_views';
import { CellDrawing } from '../figures/cell_drawing';
import { Bullets, Details, Facts, Section, Table } from '../parts';
import { fixed, significant } from '../text';

function Verdict({ placement }: { placement: CellPlacement }) {
  const what = placement.program === null ? "the workpiece's origin" : `all of ${placement.program}`;
  if (placement.works) {
    const how = gammaText(placement.gamma_deg);
    return (
      <p class="why">
        The tool reaches <strong>{what}</strong>
        {how === '' ? '' : ` with ${how}`}; margin {significant(placement.margin ?? null)} of the way to a limit or a singularity.
      </p>
    );
  }
  return (
    <p class="why none">
      {placement.no_way === null ? (
        <strong>{`${placement.missed} of ${placement.complete ? '' : 'the first '}${placement.poses} poses cannot be taken where the workpiece stands.`}</strong>
      ) : (
        <>
          Every block can be reached for itself, but <strong>{placement.no_way}</strong>.
        </>
      )}
    </p>
  );
}

function MissesTable({ placement: { misses, program } }: { placement: CellPlacement }) {
  return (
    <Table
      caption="Poses that cannot be taken, in the way that misses by least"
      columns={[
        { heading: 'Where', cell: (miss) => placeOf(miss, program) },
        { heading: 'State', cell: (miss) => miss.state },
        { heading: 'By how much', long: true, cell: (miss) => miss.text },
      ]}
      rows={misses}
    />
  );
}

function ProposalsTable({ document: { placement, proposals } }: { document: CellDocument }) {
  if (placement.works) return null;
  if (proposals.length === 0) return <p class="why">No pose of the workpiece nearby was found that serves.</p>;
  return (
    <Table
      caption="Poses of the workpiece that serve, the smallest change first"
      columns={[
        { heading: '', cell: (_, i) => `${i + 1}` },
        { heading: 'Shift (mm)', cell: ({ shift_mm }) => vectorText(shift_mm, 0) },
        { heading: 'Turn about z (°)', number: true, cell: ({ turn_deg }) => fixed(turn_deg, 0) },
        { heading: 'origin_mm', cell: ({ origin_mm }) => vectorText(origin_mm, 3) },
        { heading: 'rotation_deg', cell: ({ rotation_deg }) => vectorText(rotation_deg, 4) },
        { heading: 'Turn about the tool', cell: ({ gamma_deg }) => gammaText(gamma_deg) },
        { heading: 'Margin', number: true, cell: ({ margin }) => significant(margin) },
      ]}
      rows={proposals}
    />
  );
}

function LimitsTable({ joints }: CellDocument) {
  const unit = unitOf(joints);
  return (
    <>
      <Table
        caption="Limits of the joints"
        columns={[
          { heading: 'Joint', cell: ({ joint }) => `${joint}` },
          { heading: `From (${unit})`, number: true, cell: (joint) => limitText(joint, 'min_position') },
          { heading: `To (${unit})`, number: true, cell: (joint) => limitText(joint, 'max_position') },
          { heading: `Velocity (${unit}/s)`, number: true, cell: (joint) => limitText(joint, 'max_velocity_per_s') },
          { heading: `Acceleration (${unit}/s²)`, number: true, cell: (joint) => limitText(joint, 'max_acceleration_per_s2') },
          { heading: `Jerk (${unit}/s³)`, number: true, cell: (joint) => limitText(joint, 'max_jerk_per_s3') },
        ]}
        rows={joints}
      />
      {joints.some(({ assumed }) => assumed.length > 0) && <p>* Assumed, as it is not published.</p>}
    </>
  );
}

function PosturesTable({ caption, postures, unit }: { caption: string; postures: CellPosture[]; unit: string }) {
  return (
    <Table
      caption={caption}
      columns={[
        { heading: 'Posture', cell: ({ name }) => name },
        { heading: `Joints (${unit})`, cell: ({ joints }) => vectorText(joints, 2) },
        { heading: 'Tip in the base (mm)', cell: ({ tip_mm }) => vectorText(tip_mm, 2) },
        { heading: 'Axis in the base', cell: ({ axis }) => vectorText(axis, 3) },
        { heading: "Tip in the program's frame (mm)", cell: ({ program_tip_mm }) => vectorText(program_tip_mm, 2) },
        { heading: 'Flange in the base (mm)', cell: ({ flange }) => vectorText(flange.origin_mm, 2) },
        { heading: 'A B C (°)', cell: ({ flange }) => vectorText(flange.abc_deg, 2) },
        { heading: 'Nearest limit', cell: (posture) => nearestText(posture, unit) },
        { heading: 'Condition number', number: true, cell: ({ condition_number }) => significant(condition_number) },
      ]}
      rows={postures}
    />
  );
}

export function CellSection({ document }: { document: CellDocument }) {
  const { joints, postures, at_limits: atLimits, notes, placement } = document;
  const unit = unitOf(joints);
  return (
    <Section id="cell" heading="Robot cell" lead="Where the joints put the tool, to compare with the pendant, and whether it comes to the workpiece.">
      <Facts facts={cellFacts(document)} />
      <Verdict placement={placement} />
      <CellDrawing document={document} />
      <MissesTable placement={placement} />
      <ProposalsTable document={document} />
      <LimitsTable {...document} />
      <PosturesTable caption="Postures" postures={postures} unit={unit} />
      <p>A, B and C turn about z, y' and x'' (KUKA; FANUC's R, P, W; Yaskawa's Rz, Ry, Rx). The workpiece stands at {poseText(placement.origin_mm, placement.rotation_deg)}.</p>
      {atLimits.length > 0 && (
        <Details summary="From home, each joint at its limits">
          <PosturesTable caption="From home, each joint at its limits" postures={atLimits} unit={unit} />
        </Details>
      )}
      <Bullets texts={notes} />
    </Section>
  );
}
