// Stability over speed and another parameter, and methods side by side.
import type { ComparisonDocument, SweepDocument } from '../documents';
import { comparisonFigure, sweepFigure } from '../figures/sweep';
import { Bullets, DetailsTable, Section, someOf, Table } from '../parts';
import { Plot } from '../plot';
import { dash, fixed, percent, significant } from '../text';
import { intervalsText, sweptOf } from '../verb_views';
import { PointsTable } from './lobes';

export function SweepSection({ sweep }: { sweep: SweepDocument }) {
  const { name, unit, valueOf } = sweptOf(sweep);
  const { stable, points } = sweep;
  return (
    <Section id="sweep" heading="Stability by another parameter" lead={`Where the cut is stable while its ${name.toLowerCase()} and the spindle speed vary.`}>
      <Plot
        which="sweep"
        shows={`Spectral radius over spindle speed and ${name.toLowerCase()}`}
        caption="Where the spectral radius is above 1, a vibration grows; the line is where it is 1."
        draw={(theme) => sweepFigure(sweep, theme)}
      />
      <PointsTable points={points} heading={`${name} (${unit})`} valueOf={valueOf} />
      <DetailsTable
        summary="Stable intervals as a table"
        quiet={false}
        caption="Stable intervals at some of the computed speeds"
        rows={someOf(stable.length)}
        columns={[
          { heading: 'Spindle speed (rpm)', number: true, cell: (i) => fixed(stable[i]!.spindle_speed_rpm, 0) },
          { heading: `Stable from ${name.toLowerCase()} (${unit})`, cell: (i) => intervalsText(stable[i]!.intervals) || 'nowhere' },
        ]}
      />
    </Section>
  );
}

export function ComparisonSection({ comparison }: { comparison: ComparisonDocument }) {
  const { methods, spindle_speed_rpm: speed } = comparison;
  const least = (limit: ComparisonDocument['methods'][number]['limit_mm']) => {
    const found = limit.filter((value) => value !== null);
    return found.length === 0 ? null : Math.min(...found);
  };
  const rejected = methods.filter(({ rejection }) => rejection !== '');
  return (
    <Section id="comparison" heading="Methods side by side" lead="The same cut by every method; the first is what the others are compared with.">
      <Plot
        which="comparison"
        shows="Limit depth over spindle speed by method"
        caption={`At ${speed.length} spindle speeds. A gap: no limit up to the deepest cut that was looked at.`}
        draw={(theme) => comparisonFigure(comparison, theme)}
      />
      <Table
        caption="Methods"
        quiet
        rows={methods.filter(({ rejection }) => rejection === '')}
        columns={[
          { heading: 'Method', cell: ({ method }) => method },
          { heading: 'Lowest limit (mm)', number: true, cell: ({ limit_mm: limit }) => (limit.length === 0 ? dash : significant(least(limit))) },
          { heading: 'Median difference', number: true, cell: (row) => percent(row.median_error, 2) },
          { heading: 'Largest difference', number: true, cell: (row) => percent(row.worst_error, 2) },
          { heading: 'Limit for one alone', number: true, cell: ({ differ }) => `${differ}` },
          { heading: 'Time (s)', number: true, cell: (row) => significant(row.seconds) },
        ]}
      />
      {rejected.length > 0 && (
        <>
          <h3>Methods that do not take this cut</h3>
          <Bullets texts={rejected.map(({ method, rejection }) => `${method}: ${rejection}`)} />
        </>
      )}
    </Section>
  );
}
