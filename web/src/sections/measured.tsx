// A force record beside the prediction.
import { keys } from '#schema/forces';
import type { MeasuredForces, Num, Revolution } from '../documents';
import { forceCurves } from '../figures/forces';
import { axesNames, measuredCourse, measuredFigure } from '../figures/measured';
import { DetailsTable, someOf, Table, type Column } from '../parts';
import { narrow, Plot } from '../plot';
import { fixed, significant } from '../text';

const rows = [
  ['Mean, measured', 'mean_n'],
  ['… standard deviation of single revolutions', 'mean_std_n'],
  ['Mean, predicted', 'predicted_mean_n'],
  ['Peak, measured', 'peak_n'],
  ['… standard deviation of single revolutions', 'peak_std_n'],
  ['Peak, predicted', 'predicted_peak_n'],
  ['Root mean square, measured', 'rms_n'],
  ['Error, root mean square', 'error_n'],
  ['Error without the means', 'shape_error_n'],
  ["Scatter of the record's own revolutions", 'scatter_n'],
  ['What differs from tooth to tooth', 'between_teeth_n'],
  ['Drift over the stretch, taken out', 'drift_n'],
] as const;

const shares = [
  ['Error of the measured force (%)', 'error_ratio'],
  ['Error without the means (%)', 'shape_error_ratio'],
] as const;

function Numbers({ measured }: { measured: MeasuredForces }) {
  const all: [string, Num[]][] = [
    ...rows.map(([name, key]): [string, Num[]] => [`${name} (${keys[`measured.${key}`].unit})`, measured[key]]),
    ...shares.map(([name, key]): [string, Num[]] => [name, measured[key].map((value) => (value === null ? null : 100 * value))]),
  ];
  return (
    <Table
      caption="Measured and predicted force"
      columns={[
        { heading: '', cell: ([name]) => name },
        ...axesNames.map((name, i): Column<[string, Num[]]> => ({ heading: name, number: true, cell: ([, values]) => significant(values[i] ?? null) })),
      ]}
      rows={all}
    />
  );
}

function Courses({ turn, measured }: { turn: Revolution; measured: MeasuredForces }) {
  const predicted = forceCurves(turn);
  const columns = axesNames.flatMap((name, i): Column<number>[] => {
    const course = measuredCourse(measured, i);
    if (course === null) return [];
    return [
      { heading: `F${name} measured (N)`, number: true, cell: (at) => significant(course.mean[at] ?? null) },
      { heading: `F${name} predicted (N)`, number: true, cell: (at) => significant(predicted[i]![at] ?? null) },
    ];
  });
  return (
    <DetailsTable
      summary="Measured and predicted force over rotation as a table"
      caption="Measured and predicted force over rotation"
      columns={[{ heading: 'Rotation (°)', number: true, cell: (at) => fixed(turn.rotation_deg[at]!, 0) }, ...columns]}
      rows={someOf(turn.rotation_deg.length)}
    />
  );
}

type Harmonic = MeasuredForces['harmonics'][number];

function Harmonics({ measured }: { measured: MeasuredForces }) {
  const three = (values: Num[]) => values.map(significant).join(', ');
  return (
    <DetailsTable
      summary="Harmonics of the rotation as a table"
      caption="Amplitudes at multiples of the rotation: a resonance of the dynamometer stands out"
      columns={[
        { heading: '×', number: true, cell: (row: Harmonic) => fixed(row.multiple, 0) },
        { heading: 'Frequency (Hz)', number: true, cell: (row) => fixed(row.frequency_hz, 1) },
        { heading: 'Measured x, y, z (N)', number: true, cell: (row) => three(row.measured_n) },
        { heading: 'Predicted x, y, z (N)', number: true, cell: (row) => three(row.predicted_n) },
      ]}
      rows={measured.harmonics}
    />
  );
}

export function MeasuredPart({ turn, measured }: { turn: Revolution; measured: MeasuredForces }) {
  return (
    <>
      <h3>Measured beside predicted</h3>
      <p>
        {`${measured.file}: ${measured.revolutions} revolutions from ${significant(measured.from_s)} to ${significant(measured.to_s)} s at `}
        {`${fixed(measured.spindle_speed_rpm, 2)} ± ${significant(measured.spindle_speed_std_rpm)} rpm; x, y, z from ${measured.channels.join(', ')}.`}
      </p>
      <Numbers measured={measured} />
      <Plot
        which="measured"
        shows="Measured and predicted force in x, y and z over the cutter's rotation"
        caption="The mean of the record's revolutions, laid over the prediction where they correlate most. The band is one standard deviation of single revolutions."
        draw={(theme, width) => measuredFigure(turn, measured, theme, width < narrow)}
      />
      <Courses turn={turn} measured={measured} />
      <Harmonics measured={measured} />
    </>
  );
}
