// The program: its path in three dimensions, limits over its blocks, the worst of them.
import { useCallback, useMemo } from 'preact/hooks';
import type { BlockColumns, BlocksDocument, LimitOver } from '../documents';
import { deepest, limitFigure, overFigure } from '../figures/program_limit';
import type { Theme } from '../figures/theme';
import { Bullets, Facts, Section, Table, type Column } from '../parts';
import { blockFacts, boundOf, headingOf, isUnstable, numberAt, programFacts, quantitiesOf, regimeName, worstBlocks, type NumberColumn } from '../path_views';
import { Plot, type Draw } from '../plot';
import { useSelection } from '../selection';
import { dash, fixed, significant } from '../text';
import { PathFigure } from './path';

type Select = (index: number | null) => void;

/** A short name stays on its line. */
function together(name: string): string {
  return name.length > 16 ? name : name.replace(/ /g, '\u00a0');
}

interface BlocksTableProps {
  caption: string;
  columns: BlockColumns;
  rows: number[];
  selected: number | null;
  select: Select;
}

/** Some of the blocks; the number of each selects it. */
export function BlocksTable({ caption, columns, rows, selected, select }: BlocksTableProps) {
  const number = (name: string, key: NumberColumn): Column<number> => ({
    heading: headingOf(key, name),
    number: true,
    optional: true,
    cell: (i) => significant(numberAt(columns[key], i)),
  });
  const shown: Column<number>[] = [
    {
      heading: 'Block',
      number: true,
      cell: (i) => (
        <button type="button" class="link" onClick={() => select(i)}>
          {fixed(columns.block[i]!, 0)}
        </button>
      ),
    },
    { heading: 'Line', number: true, cell: (i) => fixed(columns.line[i] ?? null, 0) },
    number('|μ|', 'spectral_radius'),
    number('Gain margin', 'gain_margin'),
    number('Margin', 'stability_margin'),
    number('Depth', 'axial_depth_mm'),
    { heading: 'Limit, 5 – 95 % (mm)', number: true, cell: (i) => boundOf(columns, i) },
    number('Chatter', 'chatter_frequency_hz'),
    { heading: 'Mode', optional: true, cell: (i) => together(columns.mode?.[i] ?? dash) },
    { heading: 'Regime', optional: true, cell: (i) => together(regimeName(columns, i)) },
    number('Peak force', 'peak_f_n'),
  ];
  const rowClass = (i: number) => [isUnstable(columns, i) && 'chatter', i === selected && 'selected'].filter(Boolean).join(' ');
  return <Table caption={caption} columns={shown} rows={rows} rowClass={rowClass} />;
}

/** What the order and the signs of a table of the worst blocks say. */
export function worstText(columns: BlockColumns, rows: number[]): string {
  const bounds = rows.some((i) => columns.lower_bound?.[i]) ? ' ≥: a lower bound, for process damping is not known.' : '';
  return `Unstable blocks first, then by gain margin: the factor by which the cut may get stiffer before it chatters.${bounds}`;
}

function WorstTable(props: Omit<BlocksTableProps, 'caption' | 'rows'>) {
  const { columns } = props;
  const rows = useMemo(() => worstBlocks(columns, 10), [columns]);
  if (rows.length === 0) return null;
  return (
    <>
      <BlocksTable caption="The blocks nearest to chatter" rows={rows} {...props} />
      <p>{worstText(columns, rows)}</p>
    </>
  );
}

const names: Record<LimitOver['parameter'], string> = { x_mm: 'x', y_mm: 'y', z_mm: 'z', gamma_deg: 'γ' };

function Scans({ scans: all, columns }: { scans: LimitOver[]; columns: BlockColumns }) {
  const at = all[0]!.at_block;
  const scans = useMemo(() => all.filter((scan) => scan.limit_depth_mm.some((limit) => limit !== null)), [all]);
  const depth = numberAt(columns.axial_depth_mm, columns.block.indexOf(at));
  const draw = useMemo(() => scans.map((scan): Draw => (theme) => overFigure(scan, deepest(scans, depth), depth, theme)), [scans, depth]);
  const namesOf = (some: LimitOver[]) => some.map(({ parameter }) => names[parameter]).join(', ');
  const without = namesOf(all.filter((scan) => !scans.includes(scan)));
  return (
    <>
      <h3>What the posture does to the limit</h3>
      {without !== '' && <p>{`With the cut of block ${fixed(at, 0)} no limit was found anywhere along ${without}.`}</p>}
      {scans.length > 0 && (
        <Plot
          which="limit-over"
          shows={`Limit depth over ${namesOf(scans)}`}
          caption={`Limit depth with the cut of block ${fixed(at, 0)} at other places, one coordinate at a time; dashed: its programmed depth. Gaps: no limit found, or out of the robot's reach.`}
          draw={draw}
        />
      )}
    </>
  );
}

export function ProgramSection({ document }: { document: BlocksDocument }) {
  const { blocks: columns, summary, limit_over: scans } = document;
  const { block, select: selectBlock } = useSelection();
  const selected = useMemo(() => (block !== null && columns.block.includes(block) ? columns.block.indexOf(block) : null), [columns, block]);
  const select = useCallback((index: number | null) => selectBlock(index === null ? null : columns.block[index]!), [columns, selectBlock]);
  const quantities = useMemo(() => quantitiesOf(columns), [columns]);
  const draw = useMemo((): Draw => (theme: Theme) => limitFigure(columns, selected, theme), [columns, selected]);
  const picked = useCallback((at: number) => void (columns.block.includes(at) && selectBlock(at)), [columns, selectBlock]);
  return (
    <Section id="program" heading="Program" lead="How far each block of the program is from chatter.">
      <Facts facts={programFacts(document)} />
      <PathFigure columns={columns} quantities={quantities} selected={selected} select={select} facts={(i) => blockFacts(columns, i)} />
      {summary.cutting > 0 && (
        <Plot
          which="program-limit"
          shows="Limit depth and programmed depth over the blocks of the program"
          caption="Click on a block to select it. Gaps in the depth: no cut; in the limit: none found up to the depth that was searched."
          draw={draw}
          picked={picked}
        />
      )}
      <WorstTable columns={columns} selected={selected} select={select} />
      {scans.length > 0 && <Scans scans={scans} columns={columns} />}
      <Bullets texts={summary.notes} />
    </Section>
  );
}
