// A program: its path, the map of γ with a line to drag, and its blocks, as the job has it or re-evaluated.
import { useCallback, useEffect, useLayoutEffect, useMemo, useRef, useState } from 'preact/hooks';
import type { BlocksDocument, GammaMap } from '../../documents';
import { nearest } from '../../decision_views';
import { Bullets, Table } from '../../parts';
import { blockFacts, quantitiesOf, worstBlocks } from '../../path_views';
import { Choice } from '../../plot';
import { PathFigure } from '../../sections/path';
import { BlocksTable, worstText } from '../../sections/program';
import { BlockLink, Selection, useSelection } from '../../selection';
import { capital, fixed, significant } from '../../text';
import { useServe } from '../context';
import { recordLatency } from '../latency';
import { Button, ErrorBox, Panel } from '../pieces';
import { boundsOf, changed, lineAlong, marginsAlong, rested, sameLine, undone, type GammaLine, type LineHistory } from './gamma_line';
import { GammaPanel, Knots } from './gamma_panel';
import type { ProgramAnswer } from './documents';
import { useEvaluated } from './live';
import { blocksAround, evaluatedOutcome, jobName, outcomeOf, standingText, type LoadedProgram, type ProgramOutcome } from './views';

const rest_ms = 250; // after the last movement
const table_rows = 12;

/** The selected block as an index of these columns, and how to select one by such. */
function useSelected({ blocks: columns }: BlocksDocument) {
  const { block, select } = useSelection();
  const at = useMemo(() => (block === null ? -1 : columns.block.indexOf(block)), [columns, block]);
  const selectIndex = useCallback((index: number | null) => select(index === null ? null : columns.block[index]!), [columns, select]);
  return { selected: at < 0 ? null : at, select: selectIndex };
}

function PathPanel({ document }: { document: BlocksDocument }) {
  const { blocks: columns } = document;
  const quantities = useMemo(() => quantitiesOf(columns), [columns]);
  return (
    <Panel heading="Path" name="path">
      <PathFigure columns={columns} quantities={quantities} facts={(i) => blockFacts(columns, i)} {...useSelected(document)} />
    </Panel>
  );
}

function BlocksPanel({ document }: { document: BlocksDocument }) {
  const { blocks: columns } = document;
  const { selected, select } = useSelected(document);
  const [chosen, choose] = useState(0);
  const worst = useMemo(() => worstBlocks(columns, table_rows), [columns]);
  const rows = chosen === 0 ? worst : blocksAround(columns, selected, table_rows);
  return (
    <Panel heading="Blocks" name="blocks">
      <div class="controls">
        <Choice legend="Blocks" names={['Nearest to chatter', 'Around the selected one']} chosen={chosen} choose={choose} />
      </div>
      <BlocksTable caption={chosen === 0 ? 'The blocks nearest to chatter' : 'Blocks in their order'} columns={columns} rows={rows} selected={selected} select={select} />
      {chosen === 0 && <p>{worstText(columns, rows)}</p>}
    </Panel>
  );
}

interface NamedOutcome {
  name: string;
  outcome: ProgramOutcome | null; // null: not evaluated yet
  shown: boolean;
}

/** What both come to, side by side. */
export function Outcomes({ rows }: { rows: NamedOutcome[] }) {
  return (
    <Table
      caption="What the program comes to"
      quiet
      rows={rows}
      rowClass={({ shown }) => (shown ? 'selected' : '')}
      columns={[
        { heading: 'γ', cell: ({ name }) => name },
        { heading: 'Unstable blocks', number: true, cell: ({ outcome }) => fixed(outcome?.unstable ?? null, 0) },
        { heading: 'Least margin', number: true, cell: ({ outcome }) => significant(outcome?.least ?? null) },
        { heading: 'in', cell: ({ outcome }) => <BlockLink block={outcome?.block ?? null} line={null} /> },
        { heading: 'Highest peak force (N)', number: true, cell: ({ outcome }) => significant(outcome?.force_n ?? null) },
        { heading: 'Highest deflection (µm)', number: true, cell: ({ outcome }) => significant(outcome?.deflection_um ?? null) },
        { heading: 'Engagement lost', number: true, cell: ({ outcome }) => fixed(outcome?.engagement_lost ?? null, 0) },
        { heading: 'Robot cannot take', number: true, cell: ({ outcome }) => fixed(outcome?.cannot_take ?? null, 0) },
      ]}
    />
  );
}

const most_lost = 20;

/** What the answer says beside its numbers. */
export function AnswerPanel({ answer }: { answer: ProgramAnswer | null }) {
  if (!answer || answer.lost.length + answer.notes.length === 0) return null;
  const { lost, notes } = answer;
  return (
    <Panel heading="Re-evaluated with your γ" name="answer">
      {lost.length > 0 && (
        <>
          <p class="error">{lost.length === 1 ? 'One block cannot be cut with this γ:' : `${lost.length} blocks cannot be cut with this γ:`}</p>
          <ul class="lost">
            {lost.slice(0, most_lost).map(({ block, line, text }) => (
              <li>
                <BlockLink block={block} line={line} />: {text}
              </li>
            ))}
            {lost.length > most_lost && <li>and {lost.length - most_lost} more</li>}
          </ul>
        </>
      )}
      <Bullets texts={notes} />
    </Panel>
  );
}

/** The line, its steps back, and when it comes to rest. */
function useLine(first: GammaLine, came_to_rest: (line: GammaLine) => void) {
  const [history, setHistory] = useState<LineHistory>({ line: first, past: [], gesture: null });
  const now = useRef(history);
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  const started = useRef<number | null>(null);
  const done = useRef(first); // where it came to rest last
  const set = (next: LineHistory) => {
    now.current = next;
    setHistory(next);
  };
  const settle = () => {
    if (sameLine(done.current, now.current.line)) return;
    done.current = now.current.line;
    came_to_rest(now.current.line);
  };
  const rest = () => {
    clearTimeout(timer.current);
    set(rested(now.current));
    settle();
  };
  const change = (line: GammaLine, gesture: string, at: number | null) => {
    started.current = at;
    set(changed(now.current, line, gesture));
    clearTimeout(timer.current);
    timer.current = setTimeout(() => {
      if (!gesture.startsWith('drag')) return rest();
      settle(); // a hand that holds still goes on with the same gesture
    }, rest_ms);
  };
  const undo = () => {
    set(undone(now.current));
    rest();
  };
  useEffect(() => () => clearTimeout(timer.current), []);
  useLayoutEffect(() => {
    if (started.current !== null) recordLatency(started.current);
    started.current = null;
  });
  return { line: history.line, change, rest, undo: history.past.length > 0 ? undo : null };
}

function Working({ program, map }: { program: LoadedProgram; map: GammaMap }) {
  const { api } = useServe();
  const [shown, show] = useState<'job' | 'line'>('job');
  const { evaluation, error, busy, ask } = useEvaluated(api, program.id, () => show('line'));
  const bounds = useMemo(() => boundsOf(map), [map]);
  const first = useMemo(() => lineAlong(map, map.chosen_deg), [map]);
  const { line, change, rest, undo } = useLine(first, ask);
  const { block, select } = useSelection();
  const selected = useMemo(() => (block === null ? null : nearest(map.block, block)), [map, block]);
  const margins = useMemo(() => marginsAlong(map, line), [map, line]);
  const name = jobName(program);
  const isLine = shown === 'line' && evaluation !== null;
  const document = isLine ? evaluation.answer.blocks : program.document;
  const own = useMemo(() => outcomeOf(program.document), [program]);
  const other = useMemo(() => evaluation && evaluatedOutcome(evaluation), [evaluation]);
  const current = evaluation !== null && sameLine(evaluation.line, line);
  const answer = evaluation?.answer ?? null;
  // The same while the line is dragged: made anew for another document alone.
  const path = useMemo(() => <PathPanel document={document} />, [document]);
  const blocks = useMemo(() => <BlocksPanel document={document} />, [document]);
  const outcomes = useMemo(
    () => <Outcomes rows={[{ name, outcome: own, shown: !isLine }, { name: 're-evaluated with your γ', outcome: other, shown: isLine }]} />,
    [name, own, other, isLine],
  );
  const choose = (index: number) => {
    show(index === 0 ? 'job' : 'line');
    if (index === 1 && !current && !busy) ask(line);
  };
  const moves = { line, bounds, map, margins, change, rest };
  return (
    <>
      <section aria-label="What is shown" class="standing" data-shown={isLine ? 'line' : 'job'} data-current={current && !busy}>
        <div class="controls">
          <Choice legend="Shown" names={[capital(name), 'Re-evaluated with your γ']} chosen={shown === 'job' ? 0 : 1} choose={choose} />
        </div>
        <p role="status">{standingText({ shown, name, evaluation, current, busy })}</p>
        {outcomes}
      </section>
      <div class="program-sides">
        {path}
        <GammaPanel {...moves} answer={answer} selected={selected} select={select} undo={undo} />
      </div>
      <ErrorBox error={error} />
      {error && <Button act={() => ask(line)}>Try again</Button>}
      <div class="program-tables">
        {blocks}
        <Panel heading="The line in numbers" name="knots">
          <Knots {...moves} />
        </Panel>
      </div>
      <AnswerPanel answer={answer} />
    </>
  );
}

export function ProgramWork({ program }: { program: LoadedProgram }) {
  const { document, decision } = program;
  const map = decision?.gamma_map ?? null;
  return (
    <Selection blocks={document.blocks.block}>
      {map && map.block.length > 0 ? (
        <Working program={program} map={map} />
      ) : (
        <>
          <p class="notice">
            This job decides nothing, so that it has no map over γ. A job.toml with <code>[decide]</code> has one.
          </p>
          <PathPanel document={document} />
          <BlocksPanel document={document} />
        </>
      )}
    </Selection>
  );
}
