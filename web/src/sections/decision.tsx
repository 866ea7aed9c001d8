// What was decided for a program: the numbers to run it with, beside those it had.
import type { Decision, OtherSpeed, Outcome, Plan, Stretch } from '../documents';
import {
  allowedText,
  beyondText,
  collisionCaution,
  decidedTime,
  decisionFacts,
  feedText,
  leanText,
  limited,
  limitName,
  measures,
  rangeText,
  savedText,
  speedText,
  timeText as shownTime,
  unknown,
  valueText,
  violationOf,
  type Measure,
} from '../decision_views';
import { thinSpace } from '../figures/theme';
import { Bullets, Details, Facts, KeyFigures, Table, WarningBox, type Column, type KeyFigure, type TableProps } from '../parts';
import { BlockLink, LinkedText } from '../selection';
import { fixed, significant } from '../text';
import { GammaSection } from './gamma_map';
import { Disagreement } from './recommendation';

function keyFigure(label: string, value: string, unit: string, note = ''): KeyFigure {
  return { label, value, unit, note, state: value === unknown ? 'unknown' : undefined, wide: value.includes('–') };
}

function cardFigures(decision: Decision, decided: Outcome): KeyFigure[] {
  const { as_programmed: before, stretches } = decision;
  const shown = decidedTime(before, decided);
  return [
    keyFigure('Spindle speed', speedText(decided), 'rpm', speedText(decided).includes('–') ? `in ${stretches.length} stretches` : ''),
    keyFigure(shown.label, shownTime(shown.decided), 's', savedText(shown.before, shown.decided)),
    keyFigure('Feed', feedText(stretches), 'mm/min'),
    ...limited.map((measure): KeyFigure => {
      const violation = violationOf(decided, measure);
      const figure = keyFigure(measure.name, measure.text(decided), measure.unit);
      return violation ? { ...figure, note: beyondText(violation), state: 'over' } : figure;
    }),
  ];
}

function Verdict({ outcome }: { outcome: Outcome }) {
  const count = outcome.violations.length;
  if (count === 0) return <span class="verdict stable">within every limit</span>;
  return <span class="verdict chatter">{`violates ${count} ${count === 1 ? 'limit' : 'limits'}`}</span>;
}

function Card({ decision }: { decision: Decision }) {
  const { decided, reason, status } = decision;
  if (status === 'infeasible' || decided === null) {
    return (
      <p class="why none">
        <strong>Nothing that is free to choose keeps every limit.</strong> <LinkedText text={reason} />
      </p>
    );
  }
  return (
    <>
      <p class="why">
        <Verdict outcome={decided} />
      </p>
      <KeyFigures figures={cardFigures(decision, decided)} />
    </>
  );
}

function measured(outcome: Outcome, measure: Measure) {
  const violation = violationOf(outcome, measure);
  const text = measure.text(outcome);
  if (violation) {
    return (
      <strong class="over">
        {text} <small>{beyondText(violation)}</small>
      </strong>
    );
  }
  if (measure.chatters?.(outcome)) return <strong class="over">{text}</strong>;
  return text;
}

function Comparison({ decision: { as_programmed: programmed, decided } }: { decision: Decision }) {
  const columns: Column<Measure>[] = [
    { heading: 'Quantity', cell: ({ name, unit }) => (unit === '' ? name : `${name} (${unit})`) },
    { heading: 'As programmed', number: true, cell: (measure) => measured(programmed, measure) },
  ];
  if (decided) columns.push({ heading: 'As decided', number: true, cell: (measure) => measured(decided, measure) });
  return <Table caption={decided ? 'As programmed, and as decided' : 'As programmed'} columns={columns} rows={measures} />;
}

const fewRows = 10;
const mostRows = 200;

/** The first of many rows, and how many there are. */
function ManyRows<Row>(table: TableProps<Row>) {
  const { rows } = table;
  return (
    <>
      <Table {...table} rows={rows.slice(0, mostRows)} />
      {rows.length > mostRows && <p>{`The first ${mostRows} of ${rows.length}.`}</p>}
    </>
  );
}

function Violations({ outcome, which }: { outcome: Outcome; which: string }) {
  const { violations } = outcome;
  if (violations.length === 0) return <p>{`Nothing is violated ${which}.`}</p>;
  return (
    <ManyRows
      caption={`Violated ${which}, each where it is worst`}
      rows={violations}
      columns={[
        { heading: 'Limit', cell: limitName },
        { heading: 'Value', number: true, cell: valueText },
        { heading: 'Allowed', number: true, cell: allowedText },
        { heading: 'Where', cell: ({ block, line }) => <BlockLink block={block} line={line} /> },
      ]}
    />
  );
}

const stretchColumns: Column<Stretch>[] = [
  { heading: 'From', cell: ({ first_block: block, first_line: line }) => <BlockLink block={block} line={line} /> },
  { heading: 'To', cell: ({ last_block: block, last_line: line }) => <BlockLink block={block} line={line} /> },
  { heading: 'Spindle speed (rpm)', number: true, cell: (row) => fixed(row.spindle_speed_rpm, 0) },
  { heading: 'Feed (mm/min)', number: true, cell: (row) => rangeText(row.lowest_feed_mm_per_min, row.highest_feed_mm_per_min, significant) },
  { heading: 'Lead, tilt', number: true, optional: true, cell: leanText },
  { heading: 'Cutting time at the feeds (s)', number: true, cell: (row) => fixed(row.cutting_time_s, 1) },
  { heading: 'Limited by', long: true, cell: ({ limited_by: text }) => <LinkedText text={text} /> },
];

/** The longest in cutting time, and all of them where there are more. */
function Stretches({ stretches }: { stretches: Stretch[] }) {
  if (stretches.length === 0) return null;
  if (stretches.length <= fewRows) return <Table caption="Stretch by stretch" rows={stretches} columns={stretchColumns} />;
  const longest = [...stretches].sort((a, b) => b.cutting_time_s - a.cutting_time_s).slice(0, fewRows);
  return (
    <>
      <Table caption={`The ${fewRows} stretches that take longest`} rows={longest} columns={stretchColumns} />
      <Details summary={`All ${stretches.length} stretches in their order`}>
        <ManyRows caption="Stretch by stretch" quiet rows={stretches} columns={stretchColumns} />
      </Details>
    </>
  );
}

/** What stopped it, and where, if the text does not say so itself. */
function stopped({ stopped_by: text, block, line }: OtherSpeed) {
  const place = block !== null && !text.includes(`block ${block}`);
  return (
    <>
      <LinkedText text={text} />
      {place && (
        <>
          {' in '}
          <BlockLink block={block} line={line} />
        </>
      )}
    </>
  );
}

/** Where a limit stops it, the time is the least that it would take. */
function timeText({ cutting_time_s: time, limit }: OtherSpeed): string {
  return time !== null && limit !== null ? `≥${thinSpace}${fixed(time, 1)}` : fixed(time, 1);
}

/** `several`: each is of one of several stretches. */
function OtherSpeeds({ speeds, several }: { speeds: OtherSpeed[]; several: boolean }) {
  return (
    <Table
      caption="Other spindle speeds"
      rows={speeds}
      columns={[
        { heading: 'Spindle speed (rpm)', number: true, cell: (row) => fixed(row.spindle_speed_rpm, 0) },
        { heading: 'Stretch', number: true, optional: true, cell: ({ stretch }) => fixed(several ? stretch : null, 0) },
        { heading: several ? 'Its cutting time at the feeds (s)' : 'Cutting time at the feeds (s)', number: true, cell: timeText },
        { heading: 'Why not', long: true, cell: stopped },
      ]}
    />
  );
}

export function DecisionSection({ decision, plan: { agreement, warnings } }: { decision: Decision; plan: Plan }) {
  const { as_programmed: programmed, decided, alternatives, stretches, notes, gamma_map: map } = decision;
  const caution = collisionCaution(decision);
  return (
    <section id="decision" class="hero">
      <h2>Decision</h2>
      <Disagreement {...agreement} />
      <Card decision={decision} />
      <Facts facts={decisionFacts(decision)} />
      <WarningBox heading="Before you use these numbers" texts={caution === '' ? warnings : [caution, ...warnings]} />
      <Bullets texts={notes} />
      <div class="beside">
        <Comparison decision={decision} />
        <div>
          <Violations outcome={programmed} which="as programmed" />
          {decided && <Violations outcome={decided} which="as decided" />}
        </div>
      </div>
      <Stretches stretches={stretches} />
      <OtherSpeeds speeds={alternatives} several={alternatives.some(({ stretch }) => stretch > 1)} />
      {map && map.block.length > 1 && map.gamma_deg.length > 1 && <GammaSection map={map} />}
    </section>
  );
}
