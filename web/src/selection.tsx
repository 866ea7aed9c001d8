// The block that is selected, for every section that shows blocks.
import { createContext, type ComponentChildren } from 'preact';
import { useContext, useMemo, useState } from 'preact/hooks';
import type { Num } from './documents';
import { dash, fixed } from './text';

interface SelectedBlock {
  block: number | null; // its number, from 1
  select: (block: number | null) => void;
  inPath: (block: number) => boolean; // the page has its place
}

const Context = createContext<SelectedBlock>({ block: null, select: () => {}, inPath: () => false });

/** Only what calls useSelection is made anew when a block is selected. */
export function Selection({ blocks, children }: { blocks: number[]; children: ComponentChildren }) {
  const [block, select] = useState<number | null>(null);
  const known = useMemo(() => new Set(blocks), [blocks]);
  const value = useMemo(() => ({ block, select, inPath: (one: number) => known.has(one) }), [block, known]);
  return <Context.Provider value={value}>{children}</Context.Provider>;
}

export function useSelection(): SelectedBlock {
  return useContext(Context);
}

/** "block 12 (line 40)", which selects the block and goes to the path where the page has one. */
export function BlockLink({ block, line }: { block: Num; line: Num }) {
  const { select, inPath } = useSelection();
  if (block === null) return <>{line === null ? dash : `line ${fixed(line, 0)}`}</>;
  const text = `block ${fixed(block, 0)}${line === null ? '' : ` (line ${fixed(line, 0)})`}`;
  if (!inPath(block)) return <>{text}</>;
  return (
    <a class="block-link" href="#path" onClick={() => select(block)}>
      {text}
    </a>
  );
}

/** A text in which "block 12 (line 40)" is such a link. */
export function LinkedText({ text }: { text: string }) {
  const parts = text.split(/(\bblock \d+(?: \(line \d+\))?)/);
  const link = (part: string) => {
    const [, block, line] = /^block (\d+)(?: \(line (\d+)\))?$/.exec(part)!;
    return <BlockLink block={Number(block)} line={line === undefined ? null : Number(line)} />;
  };
  return <>{parts.map((part, index) => (index % 2 === 1 ? link(part) : part))}</>;
}
