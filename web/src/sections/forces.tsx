// Forces: over a revolution, along a program, over the spindle's rotation.
import { keys } from '#schema/forces';
import type { Forces, Highest, Num, Program, Revolution, Ring, SpindleRotation, WorstBlock } from '../documents';
import { engagementFigure, forceCurves, gammaFigure, programFigure, revolutionFigure } from '../figures/forces';
import { trackFigure } from '../figures/track';
import { Bullets, DetailsTable, Facts, Section, someOf, Table, WarningBox, type Column } from '../parts';
import { narrow, Plot } from '../plot';
import { dash, fixed, significant } from '../text';
import { isProgram, isRevolution, valueAt } from '../views';
import { MeasuredPart } from './measured';

type Triple = [number, number, number];

/** "12.1, −3, 40": three numbers in one cell. */
function coordinates(triple: Triple): string {
  return triple.map(significant).join(', ');
}

function Components({ turn }: { turn: Revolution }) {
  const rows: [string, Triple][] = [
    ['Mean (N)', turn.mean_n],
    ['Peak (N)', turn.peak_n],
    ['Root mean square (N)', turn.rms_n],
  ];
  if (turn.rigid_mean_n) rows.push(['Mean as if the robot did not deflect (N)', turn.rigid_mean_n]);
  if (turn.deflection_um !== null) rows.push(['Deflection by the mean force (µm)', turn.deflection_um]);
  return (
    <Table
      caption={`Force on the ${turn.force_on}: x along the feed, y to its left, z to the spindle`}
      columns={[
        { heading: '', cell: ([name]) => name },
        { heading: 'x', number: true, cell: ([, [x]]) => significant(x) },
        { heading: 'y', number: true, cell: ([, [, y]]) => significant(y) },
        { heading: 'z', number: true, cell: ([, [, , z]]) => significant(z) },
      ]}
      rows={rows}
    />
  );
}

const totals = [
  ['torque_n_m', 'Torque, mean'],
  ['peak_torque_n_m', 'Torque, peak'],
  ['power_w', 'Power, mean'],
  ['removal_rate_mm3_per_s', 'Removal rate'],
  ['chip_area_mm2', 'Chip area across the feed'],
  ['peak_deflection_um', 'Deflection, peak'],
] as const;

function Totals({ turn }: { turn: Revolution }) {
  return (
    <Table
      caption="Over one revolution"
      columns={[
        { heading: '', cell: ([, name]) => name },
        { heading: 'Value', number: true, cell: ([key]) => significant(turn[key]) },
        { heading: 'Unit', cell: ([key]) => keys[key].unit },
      ]}
      rows={totals.filter(([key]) => turn[key] !== null)}
    />
  );
}

const verdicts = { stable: 'stable', chatter: 'chatter', undecided: 'undecided: the simulation was too short' };

function Verdict({ turn: { vibration, vibrating_fx_n: vibrating } }: { turn: Revolution }) {
  if (vibration === null) return null;
  const frequency = vibration.chatter_frequency_hz;
  return (
    <p class="why">
      <strong>{verdicts[vibration.verdict]}</strong> {frequency !== null && `Chatter at ${fixed(frequency, 0)} Hz. `}
      {vibrating && 'Simulated in the time domain: the vibration is in the forces.'}
    </p>
  );
}

function OverRotation({ turn }: { turn: Revolution }) {
  const { rotation_deg: rotation } = turn;
  const [fx, fy, fz] = forceCurves(turn);
  if (rotation.length === 0) return null;
  const forces = (heading: string, values: number[]): Column<number> => ({ heading, number: true, cell: (i) => significant(values[i]!) });
  return (
    <>
      <Plot
        which="revolution"
        shows="Forces in x, y and z and torque over the cutter's rotation"
        caption="Rotation counts clockwise from +y, seen from the spindle: at 90° the first tooth points along the feed."
        draw={(theme, width) => revolutionFigure(turn, theme, width < narrow)}
      />
      <DetailsTable
        summary="Force and torque over rotation as a table"
        caption="Force and torque over rotation"
        columns={[
          { heading: 'Rotation (°)', number: true, cell: (i) => fixed(rotation[i]!, 0) },
          forces('Fx (N)', fx),
          forces('Fy (N)', fy),
          forces('Fz (N)', fz),
          forces('Torque (N·m)', turn.torque_by_rotation_n_m),
        ]}
        rows={someOf(rotation.length)}
      />
    </>
  );
}

function arcsOf(ring: Ring): string {
  const arcs = ring.arcs_deg.map(([entry, exit]) => `${fixed(entry, 1)} – ${fixed(exit, 1)}`);
  return arcs.length > 0 ? arcs.join('; ') : dash;
}

function Engagement({ rings }: { rings: Ring[] }) {
  if (rings.length === 0) return null;
  if (rings.every((ring) => ring.arcs_deg.length === 0)) return <p>No tooth is in the material here.</p>;
  return (
    <>
      <Plot
        which="engagement"
        shows="Engagement map: where around the axis and how high above the tip teeth are in the material"
        caption="Between the ends of a bar a tooth at that height is in the material."
        draw={(theme, width) => engagementFigure(rings, theme, width < narrow)}
      />
      <DetailsTable
        summary="Engagement as a table"
        caption="Engagement"
        columns={[
          { heading: 'Height (mm)', number: true, cell: (ring) => significant(ring.height_mm) },
          { heading: 'Position angle κ (°)', number: true, cell: (ring) => fixed(ring.position_deg, 1) },
          { heading: 'In the material from – to (°)', cell: arcsOf },
        ]}
        rows={someOf(rings.length).map((i) => rings[i]!)}
      />
    </>
  );
}

function RevolutionPart({ turn }: { turn: Revolution }) {
  return (
    <>
      <h3>Over a revolution</h3>
      <Verdict turn={turn} />
      <Components turn={turn} />
      <Totals turn={turn} />
      <OverRotation turn={turn} />
      <Engagement rings={turn.engagement} />
    </>
  );
}

function powerName(program: Program): string {
  return `Power over ${significant(program.power_time_s)} s`;
}

type HighestRow = Highest & { name: string; unit: string; limit: Num };

function highestRows(program: Program): HighestRow[] {
  const row = (name: string, key: keyof Program['highest'], limit: Num = null) => {
    const entry = program.highest[key];
    return entry === null ? [] : [{ ...entry, name, unit: keys[`highest.${key}`].unit, limit }];
  };
  return [
    ...row('Force, peak', 'peak_f_n'),
    ...row('Torque over a revolution', 'revolution_torque_n_m', program.torque_limit_n_m),
    ...row('Torque, peak', 'peak_torque_n_m'),
    ...row(powerName(program), 'sustained_power_w', program.power_limit_w),
    ...row('Deflection over a revolution', 'peak_deflection_um'),
  ];
}

function isAbove({ value, limit }: HighestRow): boolean {
  return limit !== null && value > limit;
}

function besideLimit(row: HighestRow) {
  if (isAbove(row)) return <strong>above the limit</strong>;
  return row.limit === null ? dash : 'within the limit';
}

/** The highest values of a program, beside what the spindle can give. */
function HighestTable({ program }: { program: Program }) {
  return (
    <Table
      caption="Highest values"
      columns={[
        { heading: '', cell: (row) => row.name },
        { heading: 'Value', number: true, cell: (row) => significant(row.value) },
        { heading: 'Unit', cell: (row) => row.unit },
        { heading: 'Block', number: true, cell: (row) => fixed(row.block, 0) },
        { heading: 'Line', number: true, cell: (row) => fixed(row.line, 0) },
        { heading: "Spindle's limit", number: true, cell: (row) => significant(row.limit) },
        { heading: 'Verdict', cell: besideLimit },
      ]}
      rows={highestRows(program)}
      rowClass={(row) => (isAbove(row) ? 'chatter' : '')}
    />
  );
}

type NumberKey = 'axial_depth_mm' | 'radial_depth_mm' | keyof Program['highest'];

function WorstTable({ program }: { program: Program }) {
  const { worst, highest } = program;
  const shown = (name: string, key: NumberKey): Column<WorstBlock> => ({ heading: `${name} (${keys[`worst.${key}`].unit})`, number: true, cell: (row) => significant(row[key]) });
  const columns: Column<WorstBlock>[] = [
    { heading: 'Block', number: true, cell: (row) => fixed(row.block, 0) },
    { heading: 'Line', number: true, cell: (row) => fixed(row.line, 0) },
    { heading: 'Tip at x, y, z (mm)', number: true, cell: (row) => coordinates([row.x_mm, row.y_mm, row.z_mm]) },
    shown('Axial depth', 'axial_depth_mm'),
    shown('Radial depth', 'radial_depth_mm'),
    shown('Peak force', 'peak_f_n'),
    { heading: `Mean force on the ${program.force_on} while cutting x, y, z (N)`, number: true, cell: (row) => coordinates([row.mean_fx_n, row.mean_fy_n, row.mean_fz_n]) },
    shown('Torque over a revolution', 'revolution_torque_n_m'),
    shown(powerName(program), 'sustained_power_w'),
  ];
  if (highest.peak_deflection_um !== null) columns.push(shown('Deflection', 'peak_deflection_um'));
  return <Table caption="The blocks with the highest peak force" columns={columns} rows={worst} />;
}

function ProgramPart({ program }: { program: Program }) {
  const last = program.blocks[program.blocks.length - 1]!;
  return (
    <>
      <h3>Along the program</h3>
      <p>{`${program.cutting_blocks} of ${last.block} blocks cut; ${fixed(last.path_mm, 0)} mm in ${fixed(last.time_s, 1)} s.`}</p>
      <HighestTable program={program} />
      <Plot
        which="program"
        shows="Peak force, torque, power and deflection over the length of the path"
        caption="Each step is a block of the program."
        draw={(theme) => programFigure(program, theme)}
      />
      <Plot
        which="track"
        shows="The tool's path seen from above and from the side, coloured by peak force"
        caption="Coloured by the peak force of each block; grey where nothing is cut."
        draw={(theme, width) => trackFigure(program.blocks, theme, width)}
      />
      <WorstTable program={program} />
    </>
  );
}

function Stiffest({ sweep }: { sweep: SpindleRotation }) {
  if (sweep.best_deg === null) return null;
  const bending = (deflection: Num) => (deflection === null ? '' : ` with ${significant(deflection)} µm`);
  const used = bending(valueAt(sweep.rotation_deg, sweep.deflection_um, sweep.used_deg));
  return (
    <p class="why">
      Stiffest at <strong>{`γ = ${significant(sweep.best_deg)}°`}</strong>
      {`${bending(sweep.best_deflection_um)}; this job uses ${significant(sweep.used_deg)}°${used}.`}
    </p>
  );
}

function SweepTable({ sweep }: { sweep: SpindleRotation }) {
  const { rotation_deg: rotation, deflection_um: deflection, condition_number: condition } = sweep;
  return (
    <DetailsTable
      summary="Deflection over rotation as a table"
      caption="Deflection over rotation"
      columns={[
        { heading: 'Rotation γ (°)', number: true, cell: (i) => fixed(rotation[i]!, 0) },
        { heading: 'Deflection (µm)', number: true, cell: (i) => (deflection[i] === null ? 'out of reach' : significant(deflection[i]!)) },
        { heading: 'Condition number', number: true, cell: (i) => significant(condition[i]!) },
      ]}
      rows={someOf(rotation.length)}
    />
  );
}

function RotationPart({ sweep }: { sweep: SpindleRotation }) {
  return (
    <>
      <h3>Rotation about the spindle's axis</h3>
      <Stiffest sweep={sweep} />
      <Plot
        which="gamma"
        shows="Deflection over the redundant rotation about the spindle's axis"
        caption="The tool does the same in every rotation γ; the robot stands differently, and bends differently."
        draw={(theme, width) => gammaFigure(sweep, theme, width < narrow)}
      />
      <SweepTable sweep={sweep} />
    </>
  );
}

export function ForcesSection({ forces }: { forces: Forces }) {
  const { facts, warnings, notes, spindle_rotation: sweep } = forces;
  return (
    <Section id="forces" heading="Forces" lead="What the cut asks of cutter, spindle and robot.">
      <Facts facts={facts} />
      <WarningBox heading="Before you use these forces" texts={warnings} />
      {isRevolution(forces) && <RevolutionPart turn={forces} />}
      {isRevolution(forces) && forces.measured && <MeasuredPart turn={forces} measured={forces.measured} />}
      {isProgram(forces) && <ProgramPart program={forces} />}
      {sweep && <RotationPart sweep={sweep} />}
      <Bullets texts={notes} />
    </Section>
  );
}
