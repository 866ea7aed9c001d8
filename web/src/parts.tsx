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

/** A column of a table; `number`: its cells are numbers; `optional`: not shown where no cell says anything. */
export interface Column<Row> {
  heading: string;
  number?: boolean;
  optional?: boolean;
  cell: (row: Row, index: number) => ComponentChildren;
}

interface TableProps<Row> {
  caption: string;
  quiet?: boolean; // the caption is only for who cannot see the heading above it
  columns: Column<Row>[];
  rows: Row[];
  rowClass?: (row: Row) => string;
}

function cellClass(number: boolean | undefined, content: ComponentChildren): string | undefined {
  if (number) return 'number';
  return typeof content === 'string' && content.length > 24 ? 'long' : undefined;
}

export function Table<Row>({ caption, quiet, columns: all, rows, rowClass }: TableProps<Row>) {
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
            <tr class={rowClass?.(row) || undefined}>
              {columns.map(({ number, cell }) => {
                const content = cell(row, index);
                return <td class={cellClass(number, content)}>{content}</td>;
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

/** Labels and values; nothing where there are none. */
export function Facts({ facts }: { facts: Fact[] }) {
  if (facts.length === 0) return null;
  return (
    <dl class="facts">
      {facts.map(({ label, value }) => (
        <div>
          <dt>{label}</dt>
          <dd>{value}</dd>
        </div>
      ))}
    </dl>
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
export function WarningBox({ heading, texts }: { heading: string; texts: string[] }) {
  if (texts.length === 0) return null;
  return (
    <aside class="warnings" aria-label={heading}>
      <h3>{heading}</h3>
      <Bullets texts={texts} />
    </aside>
  );
}

/** At most about 24 of the indices of a curve, evenly: for who has no plots or cannot see them. */
export function someOf(count: number): number[] {
  const step = Math.max(1, Math.floor(count / 24));
  return Array.from({ length: Math.ceil(count / step) }, (_, i) => i * step);
}
