// What the turn about the tool's axis does to the margin, all along the path.
import { useCallback, useMemo } from 'preact/hooks';
import type { GammaMap, Num } from '../documents';
import { columnFacts, leastAlong, marginAt, nearest } from '../decision_views';
import { gammaFigure } from '../figures/gamma_map';
import { BlockSteps, DetailsTable, Facts, someOf } from '../parts';
import { narrow, Plot, type Draw } from '../plot';
import { useSelection } from '../selection';
import { fixed, significant } from '../text';

function GammaTable({ map }: { map: GammaMap }) {
  const rows = someOf(map.block.length);
  const gamma = (line: Num[]) => (i: number) => significant(line[i] ?? null);
  const margin = (line: Num[]) => (i: number) => significant(marginAt(map, i, line[i] ?? null));
  return (
    <DetailsTable
      summary="γ and margin along the path as a table"
      quiet={false}
      caption="γ and margin at some of the blocks"
      rows={rows}
      columns={[
        { heading: 'Block', number: true, cell: (i) => fixed(map.block[i]!, 0) },
        { heading: 'Along the path (mm)', number: true, cell: (i) => fixed(map.path_mm[i]!, 1) },
        { heading: 'γ as programmed (°)', number: true, cell: gamma(map.programmed_deg) },
        { heading: 'Margin there', number: true, cell: margin(map.programmed_deg) },
        { heading: 'γ as chosen (°)', number: true, cell: gamma(map.chosen_deg) },
        { heading: 'Margin there', number: true, cell: margin(map.chosen_deg) },
      ]}
    />
  );
}

function caption({ least_margin: least }: GammaMap): string {
  const asked = least === null || least <= 0 ? '' : ', dotted where it is what is asked for';
  return `Below 0 the cut chatters. Thin lines: where the margin is 0${asked}. Grey: no posture, the robot cannot stand there. Click on a place to select its block.`;
}

/** The least margins along both lines; empty where none is known. */
function sentence(map: GammaMap): string {
  const [programmed, chosen] = [leastAlong(map, map.programmed_deg), leastAlong(map, map.chosen_deg)];
  const said: string[] = [];
  if (programmed !== null) said.push(`${significant(programmed)} with γ as programmed`);
  if (chosen !== null) said.push(`${significant(chosen)} with γ as chosen`);
  if (said.length > 0 && map.least_margin !== null) said.push(`${significant(map.least_margin)} is asked for`);
  return said.length > 0 ? `Least margin on this map: ${said.join(', ')}.` : '';
}

export function GammaSection({ map }: { map: GammaMap }) {
  const { block, select } = useSelection();
  const selected = block === null ? null : nearest(map.block, block);
  const draw = useMemo((): Draw => (theme, width) => gammaFigure(map, selected, theme, width < narrow), [map, selected]);
  const picked = useCallback((at: number) => select(map.block[nearest(map.path_mm, at)]!), [map, select]);
  const words = useMemo(() => sentence(map), [map]);
  return (
    <>
      <h3>The turn γ about the tool's axis along the path</h3>
      {words !== '' && <p class="why">{words}</p>}
      <Plot
        which="gamma-map"
        shows="Stability margin over the place along the path and the turn γ about the tool's axis, with γ as programmed and as chosen"
        caption={caption(map)}
        draw={draw}
        picked={picked}
      >
        <span class="buttons">
          <BlockSteps blocks={map.block} selected={selected} select={(index) => select(map.block[index]!)} />
        </span>
      </Plot>
      <div aria-live="polite">{selected !== null && <Facts facts={columnFacts(map, selected)} />}</div>
      <GammaTable map={map} />
    </>
  );
}
