// The map with the line of γ on it, which can be dragged: the map is drawn once, the line over it at each movement.
import { useCallback, useMemo, useRef } from 'preact/hooks';
import type { GammaMap, Num } from '../../documents';
import { nearest } from '../../decision_views';
import { BlockSteps } from '../../parts';
import { narrow, Plot, type Draw } from '../../plot';
import { fixed, significant } from '../../text';
import { fromPixels, useFrame, type Frame } from '../frame';
import { apart, linePoints, liveGammaFigure, mapHeight, pixelsAt } from './gamma_figure';
import { chosenMargins, gammaAt, placeOfBlock, shifted, withGamma, withoutKnot, type GammaLine, type Knot, type LineBounds } from './gamma_line';
import { MarginCurve } from './margin_curve';
import type { ProgramAnswer } from './documents';
import { keyTurn } from './views';

/** Changes of the line by a hand; `gesture` names what belongs together. */
export interface LineMoves {
  change: (line: GammaLine, gesture: string, started: number | null) => void;
  rest: () => void;
}

interface LineProps extends LineMoves {
  line: GammaLine;
  bounds: LineBounds;
}

let drags = 0;

/** Follows a pointer from where it was pressed: `moved` gets how far γ went since then. */
function useDrag(frame: Frame, rest: () => void, moved: (by_deg: number, gesture: string, event: PointerEvent) => void, clicked?: (event: PointerEvent) => void) {
  const from = useRef<{ x: number; y: number; gesture: string; moved: boolean } | null>(null);
  return {
    onPointerDown: (event: PointerEvent) => {
      if (event.button !== 0) return;
      (event.currentTarget as Element).setPointerCapture(event.pointerId);
      from.current = { x: event.clientX, y: event.clientY, gesture: `drag ${++drags}`, moved: false };
    },
    onPointerMove: (event: PointerEvent) => {
      const start = from.current;
      if (!start) return;
      start.moved ||= Math.abs(event.clientY - start.y) > 2;
      const [, at] = fromPixels(frame, [0, event.clientY]);
      const [, before] = fromPixels(frame, [0, start.y]);
      if (start.moved) moved(at - before, start.gesture, event);
    },
    onPointerUp: (event: PointerEvent) => {
      if (from.current?.moved === false) clicked?.(event);
    },
    onLostPointerCapture: () => {
      if (from.current?.moved) rest();
      from.current = null;
    },
  };
}

interface HandleProps extends LineProps {
  frame: Frame;
  label: string;
  id: string;
  kind: 'knot' | 'grip';
  at: [number, number]; // px
  gamma: number;
  says: string;
  turned: (line: GammaLine, gamma_deg: number) => GammaLine; // of the line as it was
  remove?: () => void;
}

function Handle({ frame, line, bounds, label, id, kind, at: [left, top], gamma, says, turned, remove, change, rest }: HandleProps) {
  const held = useRef({ line, gamma });
  const drag = useDrag(frame, rest, (by, gesture, event) => change(turned(held.current.line, held.current.gamma + by), gesture, event.timeStamp));
  const press = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const removes = remove !== undefined && (event.key === 'Delete' || event.key === 'Backspace');
    const to = keyTurn(event.key, event.shiftKey, gamma, bounds);
    if (to === null && !removes) return;
    event.preventDefault();
    if (removes) return remove();
    change(turned(line, to!), `keys ${id}`, event.timeStamp);
  };
  return (
    <div
      id={id}
      class={`handle ${kind}`}
      role="slider"
      tabIndex={0}
      aria-orientation="vertical"
      aria-label={label}
      aria-valuemin={bounds.gamma[0]}
      aria-valuemax={bounds.gamma[1]}
      aria-valuenow={Math.round(10 * gamma) / 10}
      aria-valuetext={says}
      style={{ left: `${left}px`, top: `${top}px` }}
      onKeyDown={press}
      {...drag}
      onPointerDown={(event) => {
        held.current = { line, gamma };
        drag.onPointerDown(event);
      }}
    />
  );
}

function within({ left, top, width, height }: Frame, [x, y]: [number, number]): boolean {
  return x >= left - 1 && x <= left + width + 1 && y >= top - 1 && y <= top + height + 1;
}

interface OverlayProps extends LineProps {
  frame: Frame;
  margins: Num[];
  map: GammaMap;
  lost: number[]; // numbers of blocks
  select: (block: number) => void;
  remove: (index: number) => void;
}

/** The line to see, and its broad invisible one to take hold of. */
function Line({ frame, line, bounds, map, lost, change, rest, select }: OverlayProps) {
  const held = useRef(line);
  const root = useRef<SVGSVGElement>(null);
  const points = linePoints(frame, line);
  const clicked = (event: PointerEvent) => {
    const [at] = fromPixels(frame, [event.clientX - root.current!.getBoundingClientRect().left + frame.left, 0]);
    select(map.block[nearest(map.path_mm, at)]!);
  };
  const drag = useDrag(frame, rest, (by, gesture, event) => change(shifted(held.current, by, bounds), gesture, event.timeStamp), clicked);
  const places = useMemo(() => lost.map((block) => placeOfBlock(map, block)).sort((a, b) => a - b), [lost, map]);
  const crosses = places.map((path) => pixelsAt({ ...frame, left: 0, top: 0 }, [path, gammaAt(line, path)]));
  const cross = apart(crosses, 16).map(([x, y]) => `M${(x - 6).toFixed(1)},${(y - 6).toFixed(1)}l12,12m-12,0l12,-12`).join('');
  const { left, top, width, height } = frame;
  return (
    <svg ref={root} class="gamma-line" aria-hidden="true" width={width} height={height} style={{ left: `${left}px`, top: `${top}px` }}>
      <polyline class="edge" points={points} />
      <polyline class="line" points={points} />
      {cross !== '' && <path class="edge lost" d={cross} />}
      {cross !== '' && <path class="lost" d={cross} />}
      <polyline
        class="hold"
        points={points}
        {...drag}
        onPointerDown={(event) => {
          held.current = line;
          drag.onPointerDown(event);
        }}
      />
    </svg>
  );
}

function says(gamma: number, margin: Num): string {
  return `${fixed(gamma, 1)}°, margin ${margin === null ? 'not known' : significant(margin)} on the map`;
}

function Handles({ frame, line, bounds, map, margins, remove, ...moves }: OverlayProps) {
  const marginNear = (path: number) => margins[nearest(map.path_mm, path)] ?? null;
  const [, last] = [line[0]!, line[line.length - 1]!];
  const gripTop = pixelsAt(frame, [frame.x[1], last[1]])[1];
  const places = line.map((knot) => pixelsAt(frame, knot));
  const grip: [number, number] = [frame.left + frame.width + 24, Math.min(frame.top + frame.height, Math.max(frame.top, gripTop))];
  return (
    <>
      {line.map(([path, gamma]: Knot, index) =>
        within(frame, places[index]!) ? (
          <Handle
            key={index}
            {...moves}
            frame={frame}
            line={line}
            bounds={bounds}
            kind="knot"
            id={`knot-${index}`}
            label={`γ at ${fixed(path, 1)} mm, handle ${index + 1} of ${line.length}`}
            at={places[index]!}
            gamma={gamma}
            says={says(gamma, marginNear(path))}
            turned={(of, to) => withGamma(of, index, to, bounds)}
            remove={() => remove(index)}
          />
        ) : null,
      )}
      <Handle
        {...moves}
        frame={frame}
        line={line}
        bounds={bounds}
        kind="grip"
        id="grip"
        label="γ of the whole line, at its end"
        at={grip}
        gamma={last[1]}
        says={says(last[1], marginNear(last[0]))}
        turned={(of, to) => shifted(of, to - of[of.length - 1]![1], bounds)}
      />
    </>
  );
}

interface GammaPlaceProps extends LineProps {
  map: GammaMap;
  margins: Num[]; // along the line
  answer: ProgramAnswer | null; // to the line as it was
  selected: number | null; // a place of the map
  select: (block: number) => void;
}

export function GammaPlace({ map, line, bounds, margins, answer, selected, select, change, rest }: GammaPlaceProps) {
  const { frame, drawn } = useFrame();
  const draw = useMemo((): Draw => (theme, width) => liveGammaFigure(map, selected, theme, width < narrow, mapHeight(window.innerHeight)), [map, selected]);
  const picked = useCallback((at: number) => select(map.block[nearest(map.path_mm, at)]!), [map, select]);
  const chosen = useMemo(() => chosenMargins(map), [map]);
  const remove = (index: number) => {
    change(withoutKnot(line, index), `remove ${line.length}`, null);
    rest();
    requestAnimationFrame(() => document.getElementById(`knot-${Math.min(index, line.length - 2)}`)?.focus());
  };
  const lost = useMemo(() => (answer?.lost ?? []).map(({ block }) => block), [answer]);
  const over = { line, bounds, map, margins, change, rest, select, remove, lost };
  return (
    <div class="chart-place gamma-place">
      <Plot
        which="gamma-line"
        shows="Stability margin over the place along the path and the turn γ about the tool's axis; the line is the γ that you set"
        caption="Drag a handle up or down, or the whole line. Below 0 the cut chatters; grey: the robot cannot stand there. A click on a place selects its block."
        draw={draw}
        picked={picked}
        drawn={drawn}
      >
        <span class="buttons">
          <BlockSteps blocks={map.block} selected={selected} select={(index) => select(map.block[index]!)} />
        </span>
      </Plot>
      {frame && <Line frame={frame} {...over} />}
      {frame && <Handles frame={frame} {...over} />}
      <MarginCurve frame={frame} map={map} margins={margins} chosen={chosen} evaluated={answer?.gamma ?? null} selected={selected} />
    </div>
  );
}
