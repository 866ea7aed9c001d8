// What the points of a study say: each alone, and together.
import { useState } from 'preact/hooks';
import type { BoundaryResult, ProbabilityResult, SensitivityRow, StudyPoints } from '../documents';
import { columnsFigure, probabilityFigure, sensitivityFigure } from '../figures/study';
import { Bullets, DetailsTable, Section, Table } from '../parts';
import { Choice, narrow, Plot } from '../plot';
import { chosenAxes, columnTitle, conditionText, estimateText, leftOutTexts, notShownTexts, optimumText, probabilityMap, rowName, settledText, shownText, statusText, valueText } from '../study_views';
import { fixed, percent, significant } from '../text';

const most_plots = 8;
const most_names = 6; // as buttons; more are a list

/** Of several names one; nothing where there is only one. */
function Pick({ legend, names, chosen, choose }: { legend: string; names: string[]; chosen: number; choose: (index: number) => void }) {
  if (names.length < 2) return null;
  if (names.length <= most_names) return <Choice legend={legend} names={names} chosen={chosen} choose={choose} />;
  return (
    <label>
      {legend}{' '}
      <select value={chosen} onChange={({ currentTarget }) => choose(Number(currentTarget.value))}>
        {names.map((name, index) => (
          <option value={index}>{name}</option>
        ))}
      </select>
    </label>
  );
}

function LeftOut({ rows }: { rows: { value: string; at: Record<string, string>; left_out: number; of: number }[] }) {
  const texts = leftOutTexts(rows);
  if (texts.length === 0) return null;
  return (
    <>
      <h3>Samples left out</h3>
      <Bullets texts={texts.length > most_plots ? [...texts.slice(0, most_plots), `${texts.length - most_plots} more: statistics.json`] : texts} />
    </>
  );
}

export function ProbabilitySection({ result, points }: { result: ProbabilityResult; points: StudyPoints | null }) {
  const map = probabilityMap(result);
  const { rows } = result;
  const optimum = optimumText(result, points);
  const fixedText = map.fixed === '' ? '' : ` With ${map.fixed}.`;
  return (
    <Section id="probability" heading="Probability of keeping the condition" lead={`The share of samples with a value of ${conditionText(result, points)}, for each value and each combination of the keys that are not sampled.`}>
      {optimum !== '' && <p>{optimum}</p>}
      <Plot
        which="probability"
        shows="Probability of keeping the condition by collected value and combination of keys"
        caption={`Under the pointer: the 95 % interval.${map.optimum && optimum !== '' ? ' The robust optimum is outlined.' : ''}${fixedText}`}
        draw={(theme, width) => probabilityFigure(map, theme, width < narrow)}
      />
      <LeftOut rows={rows.map((row) => ({ ...row, of: row.points + row.left_out }))} />
      <DetailsTable
        summary="Probabilities as a table"
        caption="Probability by value and combination"
        rows={rows}
        columns={[
          { heading: 'Value', cell: ({ value }) => value },
          { heading: 'At', optional: true, cell: ({ at }) => settledText(at) },
          { heading: 'Probability (95 % interval)', number: true, cell: ({ probability }) => estimateText(probability) },
          { heading: 'Samples', number: true, cell: ({ points }) => `${points}` },
          { heading: 'Infinite', number: true, optional: true, cell: ({ infinite }) => (infinite === 0 ? '' : `${infinite}`) },
          { heading: 'Left out', number: true, optional: true, cell: ({ left_out: left }) => (left === 0 ? '' : `${left}`) },
          { heading: `Worst but for ${percent(result.worst_share, 0)}`, number: true, cell: ({ worst, points }) => (worst === null && points > 0 ? 'infinite' : significant(worst)) },
        ]}
      />
    </Section>
  );
}

export function SensitivitySection({ rows, points }: { rows: SensitivityRow[]; points: StudyPoints | null }) {
  const found = rows.filter(({ status }) => status === 'found');
  const other = rows.filter(({ status }) => status !== 'found');
  const indices = found.flatMap((row) => row.keys.map((key, i) => ({ row, key, ...row.indices[i]! })));
  return (
    <Section
      id="sensitivity"
      heading="Which key decides"
      lead="Sobol’ indices: the share of a value’s variance that goes if a key is known (first), and that remains if all other keys are known (total)."
    >
      {found.slice(0, most_plots).map((row) => (
        <Plot
          which="sensitivity"
          shows={`First and total index by key of ${rowName(row)}`}
          caption={`${rowName(row)}, from ${row.samples} samples. Mean ${valueText(row.mean, row.value, points)}, standard deviation ${valueText(row.variance === null ? null : Math.sqrt(row.variance), row.value, points)}. Whiskers: 95 % intervals.`}
          draw={(theme) => sensitivityFigure(row, theme)}
        />
      ))}
      {found.length > most_plots && <p>{found.length - most_plots} more have no plot: see the table.</p>}
      <Bullets texts={other.map((row) => `${rowName(row)}: ${statusText(row)}.`)} />
      <LeftOut rows={rows.map((row) => ({ ...row, of: row.samples + row.left_out }))} />
      <DetailsTable
        summary="Indices as a table"
        caption="Sobol’ indices with their 95 % intervals"
        rows={indices}
        columns={[
          { heading: 'Value', cell: ({ row }) => rowName(row) },
          { heading: 'Key', cell: ({ key }) => key },
          { heading: 'First', number: true, cell: ({ first }) => estimateText(first) },
          { heading: 'Total', number: true, cell: ({ total }) => estimateText(total) },
        ]}
      />
    </Section>
  );
}

export function BoundarySection({ result, points }: { result: BoundaryResult; points: StudyPoints | null }) {
  const [axes, setAxes] = useState<[number, number]>([0, 1]);
  const keys = points?.boundary_keys ?? [];
  const names = keys.map(columnTitle);
  const shown = keys[0]?.numbers.length ?? 0;
  const [across, up] = axes;
  const others = keys.filter((_, i) => i !== across && i !== up);
  const hidden = others.slice(1).map(({ name }) => name);
  const steps = Object.entries(result.steps).map(([key, step]) => `${key} ${significant(step)}`);
  const times = result.evaluations > 0 ? ` The full grid of the same steps has ${fixed(result.grid_points, 0)}, ${significant(result.grid_points / result.evaluations)} times as many.` : '';
  return (
    <Section id="boundary" heading="Boundary" lead={`Where ${result.value} is ${valueText(result.level, result.value, points)}.`}>
      <p>
        {fixed(result.evaluations, 0)} evaluations.{times} Steps: {steps.join(', ')}.
      </p>
      {result.interpolated > 0 && (
        <p>
          {fixed(result.interpolated, 0)} more points were interpolated. Of {fixed(result.compared, 0)} values that were evaluated and interpolated, {fixed(result.beyond_error, 0)} differ by more than the estimated error.
        </p>
      )}
      {!result.complete && <p>The most points were reached before all halvings were done.</p>}
      {result.unknown > 0 && <p>{result.unknown} points have no value; the boundary ends there.</p>}
      {result.points === 0 && <p>No point of the coarse grid lies on another side of the level than the others.</p>}
      {shown > 0 && keys.length > 1 && (
        <Plot
          which="boundary"
          shows={`Points of the boundary over ${names[across]} and ${names[up]}`}
          caption={`${shownText(shown, result.points, 'points of the boundary')} All are in boundary.csv.${hidden.length > 0 ? ` Not shown: ${hidden.join(', ')}.` : ''}`}
          draw={(theme) => columnsFigure(keys[across]!, keys[up]!, others[0] ?? null, theme)}
        >
          {keys.length > 2 && (
            <>
              <Pick legend="Across" names={names} chosen={across} choose={(key) => setAxes(chosenAxes(axes, 0, key))} />
              <Pick legend="Up" names={names} chosen={up} choose={(key) => setAxes(chosenAxes(axes, 1, key))} />
            </>
          )}
        </Plot>
      )}
      {keys.length === 1 && (
        <Table
          caption="Points of the boundary"
          rows={keys[0]!.numbers.slice(0, 24)}
          columns={[{ heading: names[0]!, number: true, cell: (value) => significant(value) }]}
        />
      )}
    </Section>
  );
}

export function ResultsSection({ points }: { points: StudyPoints }) {
  const { keys, values } = points;
  const [valueAt, setValue] = useState(0);
  const [keyAt, setKey] = useState(0);
  const value = values[valueAt]!;
  const key = keys[keyAt]!;
  const caption = [shownText(value.numbers.length, points.points, 'points'), ...notShownTexts(points, value), 'All are in results.csv.'].join(' ');
  return (
    <Section id="results" heading="Results" lead="Points of the study: a value over a key that varies.">
      <Plot which="results" shows={`${columnTitle(value)} over ${columnTitle(key)}`} caption={caption} draw={(theme) => columnsFigure(key, value, null, theme)}>
        {values.length + keys.length > 2 && (
          <>
            <Pick legend="Value" names={values.map(columnTitle)} chosen={valueAt} choose={setValue} />
            <Pick legend="Key" names={keys.map(columnTitle)} chosen={keyAt} choose={setKey} />
          </>
        )}
      </Plot>
    </Section>
  );
}
