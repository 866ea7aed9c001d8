// The place of the path in three dimensions: what chooses above it, the block under the pointer beside it, its colours below.
import { useLayoutEffect, useMemo, useRef, useState } from 'preact/hooks';
import type { BlockColumns, Fact } from '../documents';
import { dark, light, thinSpace, type Theme } from '../figures/theme';
import { BlockSteps, Facts } from '../parts';
import type { PathData, PathView, Side } from '../path/contract';
import { coloursOf, gradient, headingOf, pathData, rangeOf, regimes, samePlaces, worstBlocks, type Quantity } from '../path_views';
import { Choice, onColours } from '../plot';
import { significant } from '../text';

interface PathProps {
  columns: BlockColumns;
  quantities: Quantity[];
  selected: number | null;
  select: (index: number | null) => void;
  facts: (index: number) => Fact[];
}

function Regimes({ theme }: { theme: Theme }) {
  return (
    <ul class="key">
      {regimes.map(({ name, colour }) => (
        <li>
          <span style={{ background: colour(theme) }} />
          {name}
        </li>
      ))}
    </ul>
  );
}

function ColourBar({ columns, quantity, theme }: { columns: BlockColumns; quantity: Quantity; theme: Theme }) {
  const { key, name, worse } = quantity;
  const range = useMemo(() => rangeOf(key === 'regime' ? [] : (columns[key] ?? [])), [columns, key]);
  if (key === 'regime') return <Regimes theme={theme} />;
  const { low, high, below, above } = range;
  return (
    <div class="colour-bar">
      <div>{headingOf(key, name)}</div>
      <div class="scale" style={{ background: gradient(theme, worse) }} />
      <div class="ends">
        <span>{`${below ? `≤${thinSpace}` : ''}${significant(low)}`}</span>
        <span>{significant((low + high) / 2)}</span>
        <span>{`${above ? `≥${thinSpace}` : ''}${significant(high)}`}</span>
      </div>
    </div>
  );
}

const sides: { side: Side; name: string }[] = [
  { side: 'above', name: 'From above' },
  { side: 'front', name: 'From the front' },
  { side: 'right', name: 'From the right' },
  { side: 'corner', name: 'From a corner' },
];

function Buttons({ view, columns, selected, select }: { view: () => PathView | null } & Pick<PathProps, 'columns' | 'selected' | 'select'>) {
  return (
    <div class="controls buttons">
      <button type="button" onClick={() => view()?.fit()}>
        Fit
      </button>
      {sides.map(({ side, name }) => (
        <button type="button" onClick={() => view()?.fit(side)}>
          {name}
        </button>
      ))}
      <BlockSteps blocks={columns.block} selected={selected} select={select}>
        <button type="button" onClick={() => select(worstBlocks(columns, 1)[0] ?? null)}>
          Worst block
        </button>
      </BlockSteps>
    </div>
  );
}

/** What is known of the path, and the one that it was opened with: another where a place moved. */
function useData(columns: BlockColumns): { data: PathData; opened: PathData } {
  const data = useMemo(() => pathData(columns), [columns]);
  const first = useRef(data);
  if (!samePlaces(first.current, data)) first.current = data;
  return { data, opened: first.current };
}

/** The view in its element, opened once for its places. */
function useView(columns: BlockColumns, quantity: Quantity | undefined, selected: number | null, select: PathProps['select']) {
  const root = useRef<HTMLDivElement>(null);
  const view = useRef<PathView | null>(null);
  const { data, opened } = useData(columns);
  const judged = useRef<PathData | null>(null); // what the view shows
  const picked = useRef(select);
  picked.current = select;
  const [theme, setTheme] = useState(light);
  const [hovered, setHovered] = useState<number | null>(null);
  const [painter, setPainter] = useState<'webgl' | 'canvas' | 'none' | 'unknown'>('unknown');
  useLayoutEffect(() => {
    if (!window.robomillPath) return setPainter('none');
    judged.current = data;
    view.current = window.robomillPath(root.current!, data, { picked: (index) => picked.current(index), hovered: setHovered, painter: setPainter });
    return () => view.current?.dispose();
  }, [opened]);
  useLayoutEffect(() => {
    if (judged.current !== data) view.current?.judge(data.kinds);
    judged.current = data;
  }, [data]);
  useLayoutEffect(() => {
    if (!quantity) return undefined;
    return onColours((isDark) => {
      const colours = isDark ? dark : light;
      setTheme(colours);
      view.current?.paint(coloursOf(columns, quantity, colours));
    });
  }, [columns, quantity]);
  useLayoutEffect(() => view.current?.mark(selected), [opened, selected]);
  return { root, view, theme, hovered, painter };
}

export function PathFigure({ columns, quantities, selected, select, facts }: PathProps) {
  const [key, choose] = useState<Quantity['key'] | null>(null);
  const chosen = Math.max(0, quantities.findIndex((one) => one.key === key));
  const quantity = quantities[chosen];
  const { root, view, theme, hovered, painter } = useView(columns, quantity, selected, select);
  if (!quantity) return <p class="notice">No block of the program cuts.</p>;
  const shown = hovered ?? selected;
  const press = (event: KeyboardEvent) => {
    if (!event.ctrlKey && !event.metaKey && !event.altKey && view.current?.key(event.key)) event.preventDefault();
  };
  return (
    <figure id="path" class="path" data-painter={painter}>
      <div class="controls">
        <Choice legend="Colour" names={quantities.map(({ name }) => name)} chosen={chosen} choose={(index) => choose(quantities[index]!.key)} />
      </div>
      <div class="path-and-block">
        <div ref={root} class="path-view" tabIndex={0} role="group" aria-label="The path in three dimensions; arrow keys turn it, plus and minus zoom, 0 fits it" onKeyDown={press} />
        <div class="path-block" aria-live="polite">
          {shown === null ? <p class="lead">Point at a block to see what is known of it; click to select it.</p> : <Facts facts={facts(shown)} />}
        </div>
      </div>
      <ColourBar columns={columns} quantity={quantity} theme={theme} />
      <Buttons view={() => view.current} columns={columns} selected={selected} select={select} />
      {painter === 'canvas' && <p class="notice">This browser has no WebGL: the path is drawn in the plane, nearer blocks not always over those behind.</p>}
      {painter === 'none' && <p class="notice">This page has no script for the path.</p>}
      <figcaption>Lined with red: unstable. Thin and grey: not cutting; grey: no value. Drag turns, shift and drag moves; after a click the wheel zooms.</figcaption>
    </figure>
  );
}
