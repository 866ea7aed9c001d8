// The line of γ with its map, its buttons and its numbers.
import type { GammaMap, Num } from '../../documents';
import { nearest } from '../../decision_views';
import { Table } from '../../parts';
import { fixed, significant } from '../../text';
import { NumberBox } from '../number_box';
import { Button, Panel } from '../pieces';
import { gammaAt, lineAlong, lineMargin, most_knots, widestGap, withGamma, withKnot, withoutKnot, withPath, type GammaLine, type LineBounds } from './gamma_line';
import { GammaPlace, type LineMoves } from './gamma_place';
import type { ProgramAnswer } from './documents';
import { lineText } from './views';

interface KnotsProps extends LineMoves {
  line: GammaLine;
  bounds: LineBounds;
  map: GammaMap;
  margins: Num[];
}

/** As far as a handle can be told from one beside it. */
function shownNumber(value: number): string {
  return String(Number(value.toFixed(2)));
}

/** The handles as numbers. */
export function Knots({ line, bounds, map, margins, change, rest }: KnotsProps) {
  const set = (next: GammaLine) => {
    change(next, 'number', null);
    rest();
  };
  return (
    <Table
      caption="Handles of the line"
      rows={line.map((_, index) => index)}
      columns={[
        { heading: 'Handle', number: true, cell: (i) => i + 1 },
        { heading: 'Along the path (mm)', cell: (i) => <NumberBox label={`Handle ${i + 1}, along the path, millimetres`} shown={shownNumber(line[i]![0])} range={bounds.path} set={(path) => set(withPath(line, i, path, bounds))} /> },
        { heading: 'γ (°)', cell: (i) => <NumberBox label={`Handle ${i + 1}, γ, degrees`} shown={shownNumber(line[i]![1])} range={bounds.gamma} set={(gamma) => set(withGamma(line, i, gamma, bounds))} /> },
        { heading: 'Margin on the map', number: true, cell: (i) => significant(margins[nearest(map.path_mm, line[i]![0])] ?? null) },
        {
          heading: '',
          cell: (i) => (
            <Button act={() => set(withoutKnot(line, i))} disabled={line.length === 1} label={`Remove handle ${i + 1}`}>
              Remove
            </Button>
          ),
        },
      ]}
    />
  );
}

interface GammaPanelProps extends KnotsProps {
  answer: ProgramAnswer | null;
  selected: number | null; // a place of the map
  select: (block: number) => void;
  undo: (() => void) | null; // null: nothing to undo
}

export function GammaPanel({ map, line, bounds, margins, answer, selected, select, change, rest, undo }: GammaPanelProps) {
  const set = (next: GammaLine, gesture: string) => {
    change(next, gesture, null);
    rest();
  };
  const add = () => {
    const here = selected === null ? line : withKnot(line, map.path_mm[selected]!, bounds);
    set(here === line ? withKnot(line, widestGap(line, bounds), bounds) : here, `add ${line.length}`);
  };
  const at = selected === null ? '' : ` At block ${fixed(map.block[selected]!, 0)}: γ ${fixed(gammaAt(line, map.path_mm[selected]!), 1)}°, margin ${significant(margins[selected] ?? null)}.`;
  return (
    <Panel heading="The turn γ about the tool's axis" name="gamma">
      <div class="buttons">
        <Button act={() => set(lineAlong(map, map.programmed_deg), 'as programmed')}>As programmed</Button>
        <Button act={() => set(lineAlong(map, map.chosen_deg), 'as chosen')}>As chosen</Button>
        <Button act={add} disabled={line.length >= most_knots}>
          Add a handle
        </Button>
        <Button act={() => undo?.()} disabled={undo === null}>
          Undo
        </Button>
      </div>
      <p class="line-margin">{`${lineText(lineMargin(margins), map)}${at}`}</p>
      <GammaPlace map={map} line={line} bounds={bounds} margins={margins} answer={answer} selected={selected} select={select} change={change} rest={rest} />
    </Panel>
  );
}
