// What the sections are made of.
import type { ComponentChildren } from 'preact';
import type { Fact } from './documents';
import { dash } from './text';

interface SectionProps {
  id: string;
  heading: string;
  lead: string;
  children: ComponentChildren;
}

/** A section with a heading and a sentence on what it shows. */
export function Section({ id, heading, lead, children }: SectionProps) {
  return (
    <section id={id}>
      <h2>{heading}</h2>
      <p class="lead">{lead}</p>
      {children}
    </section>
  );
}

/** A column of a table; `number`: its cells are numbers; `long`: sentences; `optional`: not shown where no cell says anything. */
export interface Column<Row> {
  heading: string;
  number?: boolean;
  long?: boolean;
  optional?: boolean;
  cell: (row: Row, index: number) => ComponentChildren;
}

export interface TableProps<Row> {
  caption: string;
  quiet?: boolean; // the caption is only for who cannot see the heading above it
  columns: Column<Row>[];
  rows: Row[];
  rowClass?: (row: Row) => string;
  rowKey?: (row: Row) => string | number; // where rows come, go or move: what has the focus stays with its row
}

function cellClass<Row>({ number, long }: Column<Row>, content: ComponentChildren): string | undefined {
  if (number) return 'number';
  return long || (typeof content === 'string' && content.length > 24) ? 'long' : undefined;
}

/** Nothing where there are no rows. */
export function Table<Row>({ caption, quiet, columns: all, rows, rowClass, rowKey }: TableProps<Row>) {
  if (rows.length === 0) return null;
  const columns = all.filter(({ optional, cell }) => !optional || rows.some((row, index) => !['', dash].includes(cell(row, index) as string)));
  return (
    <div class="table" tabIndex={0} role="region" aria-label={caption}>
      <table>
        <caption class={quiet ? 'quiet' : undefined}>{caption}</caption>
        <thead>
          <tr>
            {columns.map(({ heading, number }) => (
              <th scope="col" class={number ? 'number' : undefined}>
                {heading}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row, index) => (
            <tr key={rowKey?.(row)} class={rowClass?.(row) || undefined}>
              {columns.map((column) => {
                const content = column.cell(row, index);
                return <td class={cellClass(column, content)}>{content}</td>;
              })}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** A part that opens on a click. */
export function Details({ summary, children }: { summary: string; children: ComponentChildren }) {
  return (
    <details>
      <summary>{summary}</summary>
      {children}
    </details>
  );
}

/** A table that opens on a click. */
export function DetailsTable<Row>({ summary, ...table }: TableProps<Row> & { summary: string }) {
  if (table.rows.length === 0) return null;
  return (
    <Details summary={summary}>
      <Table quiet {...table} />
    </Details>
  );
}

/** Labels and values; nothing where there are none. */
export function Facts({ facts }: { facts: Fact[] }) {
  if (facts.length === 0) return null;
  return (
    <dl class="facts">
      {facts.map(({ label, value, meaning }) => (
        <div>
          <dt title={meaning}>{label}</dt>
          <dd>{value}</dd>
        </div>
      ))}
    </dl>
  );
}

/** A number in large type. */
export interface KeyFigure {
  label: string;
  value: string;
  unit: string;
  note?: string; // below it
  state?: 'over' | 'unknown' | undefined; // beyond its limit; no number
  wide?: boolean; // needs the room of two
}

export function KeyFigures({ figures }: { figures: KeyFigure[] }) {
  return (
    <dl class="figures">
      {figures.map(({ label, value, unit, note, state, wide }) => (
        <div class={[state, wide && 'wide'].filter(Boolean).join(' ') || undefined}>
          <dt>{label}</dt>
          <dd>
            {value} <small>{state === 'unknown' ? '' : unit}</small>
          </dd>
          {note !== undefined && note !== '' && <dd class="note">{note}</dd>}
        </div>
      ))}
    </dl>
  );
}

interface BlockStepsProps {
  blocks: number[]; // their numbers
  selected: number | null; // an index
  select: (index: number) => void;
  children?: ComponentChildren; // more buttons
}

/** Buttons and a number that select a block without a pointer. */
export function BlockSteps({ blocks, selected, select, children }: BlockStepsProps) {
  const last = blocks.length - 1;
  const step = (by: number) => select(selected === null ? 0 : Math.min(last, Math.max(0, selected + by)));
  return (
    <span class="steps">
      <button type="button" aria-label="Block before" onClick={() => step(-1)}>
        ◂
      </button>
      <label>
        Block{' '}
        <input
          type="number"
          min={blocks[0]}
          max={blocks[last]}
          value={selected === null ? '' : blocks[selected]}
          onChange={({ currentTarget }) => {
            const index = blocks.indexOf(currentTarget.valueAsNumber);
            if (index >= 0) select(index);
          }}
        />
      </label>
      <button type="button" aria-label="Block after" onClick={() => step(1)}>
        ▸
      </button>
      {children}
    </span>
  );
}

/** The texts as a list; nothing where there are none. */
export function Bullets({ texts }: { texts: string[] }) {
  if (texts.length === 0) return null;
  return (
    <ul>
      {texts.map((text) => (
        <li>{text}</li>
      ))}
    </ul>
  );
}

/** What to know first, under a heading; nothing where there is nothing. */
export function WarningBox({ heading, texts, level: Level = 'h3' }: { heading: string; texts: string[]; level?: 'h2' | 'h3' }) {
  if (texts.length === 0) return null;
  return (
    <aside class="warnings" aria-label={heading}>
      <Level>{heading}</Level>
      <Bullets texts={texts} />
    </aside>
  );
}

/** At most about 24 of the indices of a curve, evenly: for who has no plots or cannot see them. */
export function someOf(count: number): number[] {
  const step = Math.max(1, Math.floor(count / 24));
  return Array.from({ length: Math.ceil(count / step) }, (_, i) => i * step);
}
