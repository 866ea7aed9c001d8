// The margin along the line of γ, below its map and as wide.
import { useMemo } from 'preact/hooks';
import type { GammaMap, Num } from '../../documents';
import { scaleEnd } from '../../figures/gamma_map';
import { general } from '../../text';
import type { Frame } from '../frame';
import { curvePath } from './gamma_figure';
import { lineMargin } from './gamma_line';
import type { EvaluatedGamma } from './documents';

const height = 96; // px
const edge = 8; // above and below the curves

interface MarginCurveProps {
  frame: Frame | null; // of the map
  map: GammaMap;
  margins: Num[]; // along the line, by the map
  chosen: Num[]; // along γ as chosen
  evaluated: EvaluatedGamma | null;
  selected: number | null;
}

function Key({ evaluated }: { evaluated: boolean }) {
  return (
    <ul class="key">
      <li>Margin along the line:</li>
      <li>
        <span class="by-map" />
        by the map
      </li>
      <li class={evaluated ? undefined : 'muted'}>
        <span class="evaluated" />
        re-evaluated
      </li>
      <li>
        <span class="chosen" />
        as chosen
      </li>
    </ul>
  );
}

export function MarginCurve({ frame, map, margins, chosen, evaluated, selected }: MarginCurveProps) {
  const end = useMemo(() => scaleEnd(map.margin), [map]);
  const { index } = lineMargin(margins);
  const [left, width, x] = frame ? [frame.left, frame.width, frame.x] : [0, 0, [0, 1]];
  const across = (path: number) => left + (width * (path - x[0]!)) / (x[1]! - x[0]!);
  const down = (margin: number) => edge + ((height - 2 * edge) * (1 - Math.min(1, Math.max(-1, margin / end)))) / 2;
  const place = (path: number, margin: number): [number, number] => [across(path), down(margin)];
  const level = (at: number, name: string) => <line class={name} x1={left} x2={left + width} y1={down(at)} y2={down(at)} />;
  return (
    <div class="margin-curve">
      <Key evaluated={evaluated !== null} />
      <svg width="100%" height={height} aria-hidden="true">
        {frame && (
          <>
            {[end, 0, -end].map((at) => (
              <text x={left - 6} y={down(at)} text-anchor="end" dominant-baseline="central">
                {general(at, 2).replace('-', '−')}
              </text>
            ))}
            <clipPath id="margin-frame">
              <rect x={left} y={0} width={width} height={height} />
            </clipPath>
            {level(0, 'zero')}
            {map.least_margin !== null && map.least_margin > 0 && map.least_margin < end && level(map.least_margin, 'asked')}
            <g clip-path="url(#margin-frame)">
              {selected !== null && <line class="selected" x1={across(map.path_mm[selected]!)} x2={across(map.path_mm[selected]!)} y1={0} y2={height} />}
              <path class="chosen" d={curvePath(map.path_mm, chosen, place)} />
              {evaluated && <path class="evaluated" d={curvePath(evaluated.path_mm, evaluated.margin, place)} />}
              <path class="by-map" d={curvePath(map.path_mm, margins, place)} />
              {index !== null && <circle class="least" cx={across(map.path_mm[index]!)} cy={down(margins[index]!)} r={5} />}
            </g>
          </>
        )}
      </svg>
    </div>
  );
}
