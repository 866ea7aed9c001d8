// Values that were found from measurements: coefficients, stiffness of a robot's joints, a joint of tool and holder.
import type { CoefficientsDocument, JointDocument, Num, StiffnessDocument } from '../documents';
import { displacementFigure, jointsFigure, slotResidualFigure, slotsFigure } from '../figures/identified';
import { convergenceFigure } from '../figures/fit';
import { Bullets, Details, DetailsTable, Section, Table } from '../parts';
import { Plot } from '../plot';
import { dash, fixed, percent, significant, withDeviation, withPower } from '../text';
import { coefficientRows, jointRows, type CoefficientRow } from '../verb_views';

function pair({ value, std }: { value: Num; std: Num }): string {
  return withDeviation(value, std, 1, 1);
}

function CoefficientTable({ caption, rows }: { caption: string; rows: CoefficientRow[] }) {
  return (
    <Table
      caption={caption}
      rows={rows}
      columns={[
        { heading: 'Direction', cell: ({ direction }) => direction },
        { heading: 'Cutting (N/mm²)', number: true, cell: ({ cutting }) => pair(cutting) },
        { heading: 'Edge (N/mm)', number: true, cell: ({ edge }) => pair(edge) },
        { heading: 'R²', number: true, optional: true, cell: (row) => fixed(row.r_squared, 4) },
        { heading: 'Noise (N)', number: true, optional: true, cell: (row) => significant(row.noise_n) },
      ]}
    />
  );
}

export function CoefficientsSection({ document }: { document: CoefficientsDocument }) {
  const { identification: found } = document;
  const { residuals: slots } = found;
  const force = (values: [number, number, number]) => values.map((value) => significant(value)).join(', ');
  return (
    <Section
      id="coefficients"
      heading="Cutting force coefficients"
      lead="What the mean forces of slots say of the material and the edge: the slope over the feed is cutting, the height at no feed is the edge. ± is one standard deviation."
    >
      <CoefficientTable caption={`From ${found.rows} slots`} rows={coefficientRows({ coefficients: document.coefficients, std: found.std }, found)} />
      <Bullets texts={found.notes} />
      <Plot
        which="slots"
        shows="Mean force over feed per tooth, measured and fitted"
        caption="Points are measured, lines are the fit; one line a depth and speed."
        draw={(theme) => slotsFigure(slots, theme)}
      />
      {found.depends_on_speed &&
        found.by_speed.map((group) => <CoefficientTable caption={`At ${fixed(group.spindle_speed_rpm, 0)} rpm, ${group.rows} slots`} rows={coefficientRows(group)} />)}
      <Plot
        which="slot-residuals"
        shows="Measured less fitted mean force over feed per tooth"
        caption="What the fit leaves should scatter about zero; a pattern in it is what the model does not have."
        draw={(theme) => slotResidualFigure(slots, theme)}
      />
      <DetailsTable
        summary="Slots one by one"
        caption="Slots"
        rows={slots}
        columns={[
          { heading: 'Line', number: true, cell: ({ line }) => `${line}` },
          { heading: 'Feed per tooth (mm)', number: true, cell: (slot) => significant(slot.feed_per_tooth_mm) },
          { heading: 'Axial depth (mm)', number: true, cell: (slot) => significant(slot.axial_depth_mm) },
          { heading: 'Spindle speed (rpm)', number: true, optional: true, cell: (slot) => fixed(slot.spindle_speed_rpm, 0) },
          { heading: 'Mean force x, y, z (N)', number: true, cell: (slot) => force(slot.force_n) },
          { heading: 'Less the fit (N)', number: true, cell: (slot) => force(slot.residual_n) },
        ]}
      />
    </Section>
  );
}

export function StiffnessSection({ document }: { document: StiffnessDocument }) {
  const { joint_stiffness_n_m_per_rad: stiffness, std, unit, identifiable, reason, r_squared: explained, rms_mm: rms } = document;
  return (
    <Section id="stiffness" heading="Stiffness of the joints" lead="How stiff each joint of the robot is, from the deflection of the tool under known loads.">
      <p>
        {document.displacement_mm.length} loads, of which {percent(explained, 2)} of the displacement is explained; the residual is {significant(rms)} mm (rms).
        {document.convergence.status !== 'converged' && <strong> The search did not converge.</strong>}
      </p>
      <Table
        caption="Joints"
        quiet
        rows={stiffness}
        columns={[
          { heading: 'Joint', number: true, cell: (_, i) => `${i + 1}` },
          { heading: 'Stiffness', number: true, cell: (value) => withPower(value) },
          { heading: 'Standard deviation', number: true, cell: (_, i) => withPower(std[i] ?? null) },
          { heading: 'Unit', cell: (_, i) => unit[i] ?? dash },
          { heading: 'Known', cell: (_, i) => (identifiable[i] ? 'yes' : <strong>no</strong>) },
          { heading: 'Why not', long: true, optional: true, cell: (_, i) => reason[i] ?? dash },
        ]}
      />
      <Plot
        which="joint-stiffness"
        shows="Stiffness of each joint with twice its standard deviation"
        caption="Bars are two standard deviations; a joint that the loads do not turn has no point."
        draw={(theme) => jointsFigure(document, theme)}
      />
      <Plot
        which="displacement"
        shows="Predicted over measured displacement of the tool under each load"
        caption="On the dashed line the joints explain what was measured."
        draw={(theme) => displacementFigure(document, theme)}
      />
    </Section>
  );
}

export function JointSection({ document }: { document: JointDocument }) {
  const { relative_error: error, convergence, suspect_hz: suspect, notes } = document;
  return (
    <Section id="joint" heading="Joint between tool and holder" lead="Springs and dampers with which the prediction comes nearest to the measured FRFs.">
      <p>
        Predicted with this joint, the FRFs differ from the measured ones by {percent(error, 2)}; both are below.
        {convergence.status === 'not converged' && <strong> The search did not converge.</strong>}
        {convergence.status === 'stalled' && <strong> The search stalled: its generations did not improve on its random start.</strong>}
        {suspect.length > 0 && ` At ${suspect.length} ${suspect.length === 1 ? 'line' : 'lines'} the measured holder would create energy.`}
      </p>
      <Table
        caption="Values of the joint"
        quiet
        rows={jointRows(document)}
        columns={[
          { heading: 'Quantity', cell: ({ name }) => name },
          { heading: 'Value', number: true, cell: (row) => withPower(row.value) },
          { heading: 'Standard deviation', number: true, cell: (row) => withPower(row.std) },
          { heading: 'Unit', cell: ({ unit }) => unit },
          { heading: 'Identifiable', cell: ({ identifiable }) => (identifiable ? 'yes' : <strong>no</strong>) },
          { heading: 'Told from rigid up to', number: true, optional: true, cell: (row) => withPower(row.visible_up_to) },
        ]}
      />
      <Bullets texts={notes} />
      {convergence.best.length > 1 && (
        <Details summary="Convergence of the search">
          <Plot
            which="joint-convergence"
            shows="Best objective over iterations"
            caption="The search is done when the curve no longer falls."
            draw={(theme) => convergenceFigure(convergence.best, theme)}
          />
        </Details>
      )}
    </Section>
  );
}
