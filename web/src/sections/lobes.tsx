// Stability lobes, over speed, over feed direction, and of some modes alone.
import type { Agreement, ChartPoint, Cut, LobesDocument, Num, Plan, Verdict } from '../documents';
import { lobesFigure, mapFigure, pairFigure, surfaceFigure } from '../figures/lobes';
import { polarFigure } from '../figures/polar';
import { Details, DetailsTable, Section, someOf, Table, type Column } from '../parts';
import { narrow, Plot } from '../plot';
import { dash, fixed, modeName, significant } from '../text';
import { feedOf, partOf, type Lobes } from '../views';

export function VerdictBadge({ verdict }: { verdict: Verdict | null }) {
  return <span class={`verdict ${verdict ?? 'unknown'}`}>{verdict ?? 'not stated'}</span>;
}

/** A limit; where there is none, how deep was searched. */
function depthText(limit: Num, searched: Num): string {
  return limit === null ? `above ${significant(searched)}` : fixed(limit, 3);
}

function AgreementSentence({ agree, disagree, not_compared: rest }: Agreement) {
  const compared = agree + disagree;
  if (compared === 0) return <p class="agreement">No test cut carries a result to compare with the prediction.</p>;
  return (
    <p class="agreement">
      <strong>
        {agree} of {compared}
      </strong>{' '}
      test cuts with a result came out as predicted.{rest > 0 && ` ${rest} more could not be compared.`}
    </p>
  );
}

function CutsTable({ cuts }: { cuts: Cut[] }) {
  return (
    <Table
      caption="Test cuts"
      quiet
      rows={cuts}
      columns={[
        { heading: 'Spindle speed (rpm)', number: true, cell: (cut) => fixed(cut.spindle_speed_rpm, 0) },
        { heading: 'Axial depth (mm)', number: true, cell: (cut) => significant(cut.axial_depth_mm) },
        { heading: 'Result', cell: (cut) => <VerdictBadge verdict={cut.result} /> },
        { heading: 'Predicted', cell: (cut) => <VerdictBadge verdict={cut.predicted} /> },
        { heading: 'Limit at this speed (mm)', number: true, cell: (cut) => fixed(cut.limit_depth_mm, 3) },
        { heading: 'Agrees', cell: ({ agrees }) => (agrees === null ? dash : agrees ? 'yes' : <strong>no</strong>) },
        { heading: 'Note', cell: (cut) => cut.note },
      ]}
    />
  );
}

function LimitTable({ lobes }: { lobes: Lobes }) {
  const { spindle_speed_rpm: speed, limit_mm: limit, searched_depth_mm: searched } = lobes;
  return (
    <DetailsTable
      summary="The limit as a table"
      quiet={false}
      caption="Limit depth at some of the computed speeds"
      rows={someOf(speed.length)}
      columns={[
        { heading: 'Spindle speed (rpm)', number: true, cell: (i) => fixed(speed[i]!, 0) },
        { heading: 'Limit depth (mm)', number: true, cell: (i) => depthText(limit[i]!, searched) },
      ]}
    />
  );
}

interface PointsTableProps {
  points: ChartPoint[];
  heading: string; // of what varies beside the speed
  valueOf: (point: ChartPoint) => Num;
}

/** Points that were asked for; nothing where there are none. */
export function PointsTable({ points, heading, valueOf }: PointsTableProps) {
  return (
    <Table
      caption="Points that were asked for"
      rows={points}
      columns={[
        { heading: 'Spindle speed (rpm)', number: true, cell: (point) => fixed(point.spindle_speed_rpm, 0) },
        { heading, number: true, cell: (point) => significant(valueOf(point)) },
        { heading: 'Limit there (mm)', number: true, optional: true, cell: ({ limit_depth_mm: limit = null }) => fixed(limit, 3) },
        { heading: 'Stability', cell: ({ stable }) => <VerdictBadge verdict={stable ? 'stable' : 'chatter'} /> },
        { heading: 'Spectral radius', number: true, cell: (point) => fixed(point.spectral_radius, 4) },
        { heading: 'Gain margin', number: true, optional: true, cell: ({ gain_margin: gain = null }) => significant(gain) },
        { heading: 'Chatter at (Hz)', number: true, optional: true, cell: (point) => (point.stable ? dash : fixed(point.dominant_frequency_hz, 1)) },
        { heading: 'Mode', optional: true, cell: (point) => (point.stable ? dash : modeName(point)) },
      ]}
    />
  );
}

function Surface({ surface }: Required<Pick<LobesDocument, 'surface'>>) {
  return (
    <Details summary="Error of the surface">
      <Plot
        which="surface"
        shows="Error of the surface over spindle speed and axial depth"
        caption="Of stable cuts, positive where material is left; grey: the cut chatters."
        draw={(theme) => surfaceFigure(surface, theme)}
      />
    </Details>
  );
}

interface LobesSectionProps {
  lobes: Lobes | null;
  plan: Plan | null;
  document: LobesDocument | null;
}

export function LobesSection({ lobes, plan, document }: LobesSectionProps) {
  const { points = [], surface } = document ?? {};
  const { other_limits: otherLimits = [], cuts = [], recommended: recommendation = null, alternatives = [] } = plan ?? {};
  return (
    <Section id="lobes" heading="Stability lobes" lead="How deep the cutter may go at each spindle speed before chatter starts.">
      {plan && cuts.length > 0 && <AgreementSentence {...plan.agreement} />}
      {lobes && (
        <>
          <Plot
            which="lobes"
            shows="Stability lobes: limit depth over spindle speed, with the recommended point and the test cuts"
            caption="Below the line a cut is stable, above it the tool chatters; the lower plot says at which frequency."
            draw={(theme, width) => lobesFigure({ lobes, otherLimits, cuts, recommendation, alternatives, points }, theme, width < narrow)}
          />
          {lobes.map !== null && (
            <Details summary="Spectral radius">
              <Plot
                which="map"
                shows="Spectral radius over spindle speed and axial depth"
                caption="Where the spectral radius is above 1, a vibration grows from tooth to tooth."
                draw={(theme) => mapFigure(lobes, theme)}
              />
            </Details>
          )}
          {surface && <Surface surface={surface} />}
          <PointsTable points={points} heading="Axial depth (mm)" valueOf={(point) => point.axial_depth_mm ?? null} />
          <LimitTable lobes={lobes} />
        </>
      )}
      {cuts.length > 0 && (
        <Details summary="Test cuts one by one">
          <CutsTable cuts={cuts} />
        </Details>
      )}
    </Section>
  );
}

export function FeedSection({ plan, searched }: { plan: Plan; searched: Num }) {
  const feed = feedOf(plan, searched);
  const { direction_deg: direction, limit_at_speed_mm: atSpeed } = feed;
  const columns: Column<number>[] = [
    { heading: 'Feed direction (°)', number: true, cell: (i) => fixed(direction[i]!, 0) },
    { heading: 'Lowest limit (mm)', number: true, cell: (i) => depthText(feed.lowest_limit_mm[i]!, searched) },
  ];
  if (atSpeed !== null) {
    const heading = `Limit at ${fixed(feed.spindle_speed_rpm, 0)} rpm (mm)`;
    columns.push({ heading, number: true, cell: (i) => depthText(atSpeed[i]!, searched) });
  }
  const parts: ('lowest' | 'speed')[] = atSpeed === null ? ['lowest'] : ['lowest', 'speed'];
  return (
    <Section id="feed" heading="Feed direction" lead="A robot is not the same in every direction: where the feed runs changes the limit.">
      <Plot
        which="feed"
        shows="Limit depth over the direction of the feed, as a polar plot"
        caption="The further out the line, the deeper the cut may be when the feed runs in that direction."
        draw={parts.map((part) => (theme, width) => polarFigure(feed, part, theme, width))}
      />
      <DetailsTable summary="The limit over direction as a table" caption="Limit over feed direction" columns={columns} rows={someOf(direction.length)} />
    </Section>
  );
}

/** The lowest limit of a curve and its speed. */
function lowest({ limit_mm: limit, spindle_speed_rpm: speed }: Lobes): { limit: Num; speed: Num } {
  let at = -1;
  limit.forEach((depth, i) => {
    if (depth !== null && (at < 0 || depth < limit[at]!)) at = i;
  });
  return at < 0 ? { limit: null, speed: null } : { limit: limit[at]!, speed: speed[at]! };
}

export function PairsSection({ all, plan }: { all: Lobes; plan: Plan }) {
  const parts = plan.pairs.map((pair) => partOf(pair, all));
  return (
    <Section id="pairs" heading="Which modes matter" lead="The lobes of some modes alone show which of them set the limit.">
      <Plot
        which="pairs"
        shows="Stability lobes of some modes alone beside those of all modes"
        caption="Each panel keeps only the named modes; the grey line is the limit with all of them."
        draw={parts.map((part) => (theme) => pairFigure(part, all, plan.cuts, theme))}
      />
      <Table
        caption="Lowest limit by modes kept"
        rows={[all, ...parts]}
        columns={[
          { heading: 'Modes', cell: (part) => part.label },
          { heading: 'Lowest limit (mm)', number: true, cell: (part) => depthText(lowest(part).limit, part.searched_depth_mm) },
          { heading: 'At spindle speed (rpm)', number: true, cell: (part) => fixed(lowest(part).speed, 0) },
        ]}
      />
    </Section>
  );
}
