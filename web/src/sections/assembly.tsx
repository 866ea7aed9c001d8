// Tool, joint and holder, and what is predicted of them.
import type { AssemblyDocument, TipPeak } from '../documents';
import { AssemblyDrawing } from '../figures/drawing';
import { Bullets, Details, Section, Table, type Column } from '../parts';
import { dash, fixed, general, percent, significant, withPower } from '../text';
import { assemblyOf, type Assembly, type Joint, type Segment } from '../views';

function segmentRemark({ beam, flutes, flute_diameter_ratio: ratio = 1, diameter_mm: diameter }: Segment): string {
  const name = beam === 'timoshenko' ? 'Timoshenko' : 'Euler–Bernoulli';
  return flutes ? `${name}; ${flutes} flutes, counted as a solid round of ${significant(ratio * diameter)} mm` : name;
}

function SegmentsTable({ assembly }: { assembly: Assembly }) {
  return (
    <Table
      caption="Segments from the tip"
      rows={[...assembly.tool, ...(assembly.joint?.shank ?? []), ...assembly.holder.segments]}
      columns={[
        { heading: 'Segment', cell: ({ part, count }) => `${part} ${count}` },
        { heading: 'Length (mm)', number: true, cell: (segment) => general(segment.length_mm, 6) },
        { heading: 'Diameter (mm)', number: true, cell: (segment) => general(segment.diameter_mm, 6) },
        { heading: 'Bore (mm)', number: true, cell: (segment) => significant(segment.inner_diameter_mm || null) },
        { heading: 'E (GPa)', number: true, cell: (segment) => significant(segment.youngs_modulus_gpa) },
        {
          heading: 'Density (kg/m³) or mass',
          number: true,
          cell: ({ mass_kg: mass, density_kg_per_m3: density }) => (mass ? `${significant(mass)} kg` : significant(density ?? null)),
        },
        { heading: 'Loss factor', number: true, cell: (segment) => significant(segment.loss_factor) },
        { heading: 'Beam', cell: segmentRemark },
      ]}
    />
  );
}

function JointPart({ joint }: { joint: Joint | null }) {
  if (joint === null) return <p>The joint between tool and holder is rigid.</p>;
  const rows: [string, string, string, string, string][] = [
    ['shift', withPower(joint.translational_stiffness_n_per_m), 'N/m', withPower(joint.translational_damping_n_s_per_m), 'N·s/m'],
    ['rotation', withPower(joint.rotational_stiffness_n_m_per_rad), 'N·m/rad', withPower(joint.rotational_damping_n_m_s_per_rad), 'N·m·s/rad'],
  ];
  if (joint.cross_stiffness_n_per_rad) rows.push(['shift by rotation', withPower(joint.cross_stiffness_n_per_rad), 'N/rad', dash, '']);
  return (
    <>
      <Table
        caption="Joint between tool and holder"
        rows={rows}
        columns={[
          { heading: 'Direction', cell: (row) => row[0] },
          { heading: 'Stiffness', number: true, cell: (row) => row[1] },
          { heading: 'Unit', cell: (row) => row[2] },
          { heading: 'Damping', number: true, cell: (row) => row[3] },
          { heading: 'Unit', cell: (row) => row[4] },
        ]}
      />
      {joint.points > 1 && (
        <p>
          Spread over {joint.points} points along {significant(joint.insertion_length_mm ?? null)} mm of the shank, an equal share at each.
        </p>
      )}
    </>
  );
}

function PeaksTable({ peaks }: { peaks: TipPeak[] }) {
  const columns: Column<TipPeak>[] = [
    { heading: 'FRF', cell: ({ frf }) => frf },
    { heading: 'Frequency (Hz)', number: true, cell: (peak) => fixed(peak.frequency_hz, 1) },
    { heading: 'Magnitude (µm/N)', number: true, cell: ({ receptance_m_per_n: size }) => significant(size === null ? null : 1e6 * size) },
  ];
  if (peaks.some((peak) => peak.measured_frequency_hz !== null)) {
    columns.push(
      { heading: 'Measured (Hz)', number: true, cell: (peak) => fixed(peak.measured_frequency_hz, 1) },
      {
        heading: 'Predicted too high by',
        number: true,
        cell: ({ frequency_hz: predicted, measured_frequency_hz: measured }) => percent(measured === null ? null : predicted / measured - 1, 1),
      },
    );
  }
  return <Table caption="First peaks of the predicted FRFs" columns={columns} rows={peaks} />;
}

function lines(count: number): string {
  return `At ${count} line${count === 1 ? '' : 's'}`;
}

function MarkedLines({ suspect_lines: suspect, unreliable_lines: unreliable }: Assembly) {
  return (
    <>
      {suspect > 0 && (
        <p>
          <strong>{lines(suspect)} the measured holder would create energy</strong>: the prediction is suspect there, and the plot below is shaded.
        </p>
      )}
      {unreliable > 0 && (
        <p>
          <strong>{lines(unreliable)} the holder's receptances are unreliable</strong>: a small error of the measurement became a large one; between
          dotted lines in the plot below.
        </p>
      )}
    </>
  );
}

export function AssemblySection({ document }: { document: AssemblyDocument }) {
  const assembly = assemblyOf(document);
  return (
    <Section id="assembly" heading="Tool and holder" lead="What the prediction was made of: the tool from its tip, the joint, and what holds it.">
      <AssemblyDrawing assembly={assembly} />
      {assembly.holder.file !== '' && (
        <p>
          The holder was measured: <code>{assembly.holder.file}</code>.
        </p>
      )}
      <MarkedLines {...assembly} />
      <PeaksTable peaks={assembly.peaks} />
      {assembly.holder.kind === 'free' ? <p>Nothing holds the tool: it hangs free.</p> : <JointPart joint={assembly.joint} />}
      <Details summary="Segments one by one">
        <SegmentsTable assembly={assembly} />
      </Details>
      <Bullets texts={assembly.notes} />
    </Section>
  );
}
