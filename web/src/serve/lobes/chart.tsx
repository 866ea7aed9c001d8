// The lobes with the operating point on them, which can be dragged.
import { useCallback, useMemo, useRef } from 'preact/hooks';
import type { Theme } from '../../figures/theme';
import { Plot } from '../../plot';
import { sweptOf } from '../../verb_views';
import { recordLatency } from '../latency';
import { fromPixels, toPixels, useFrame, type Frame } from '../frame';
import { chartHeight, liveFigure, liveSweepFigure } from './figure';
import type { Curves } from './live';
import { placed, stepOf, type Point, type Ranges } from './settings';

interface HandleProps {
  frame: Frame;
  point: Point;
  ranges: Ranges;
  says: string;
  move: (point: Point, started: number) => void;
  rest: () => void;
}

const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

function Handle({ frame, point, ranges, says, move, rest }: HandleProps) {
  const dragged = useRef<[number, number] | null>(null); // from the pointer to the point
  const [left, top] = toPixels(frame, point);
  const at = (event: PointerEvent): [number, number] => [event.clientX, event.clientY];
  const press = (event: KeyboardEvent) => {
    const way = arrows[event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const [speed, depth] = point;
    const times = event.shiftKey ? 10 : 1;
    const steps = [10 * stepOf(ranges.speed), 5 * stepOf(ranges.depth)] as const;
    move(placed([speed + times * way[0] * steps[0], depth + times * way[1] * steps[1]], ranges), event.timeStamp);
    rest();
  };
  return (
    <>
      <div class="guide" aria-hidden="true" style={{ left: `${left}px`, top: `${top}px`, height: `${frame.top + frame.height - top}px` }} />
      <div class="guide across" aria-hidden="true" style={{ left: `${frame.left}px`, top: `${top}px`, width: `${left - frame.left}px` }} />
      <button
        type="button"
        class="handle"
        style={{ left: `${left}px`, top: `${top}px` }}
        aria-label={`Operating point: ${says}. Arrow keys move it, with shift ten times as far.`}
        onKeyDown={press}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          dragged.current = [left - event.clientX, top - event.clientY];
        }}
        onPointerMove={(event) => {
          if (!dragged.current) return;
          const [x, y] = at(event);
          move(placed(fromPixels(frame, [x + dragged.current[0], y + dragged.current[1]]), ranges), event.timeStamp);
        }}
        onLostPointerCapture={() => {
          dragged.current = null;
          rest();
        }}
      />
    </>
  );
}

interface ChartProps extends Omit<HandleProps, 'frame' | 'point'> {
  curves: Curves;
  name: string;
  kept: { curves: Curves; name: string } | null;
  point: Point | null;
}

/** Counts in the latency what was drawn because a hand moved, once. */
function useMeasured(curves: Curves): () => void {
  const last = useRef<Curves | null>(null);
  return () => {
    if (last.current !== curves && curves.started !== null) recordLatency(curves.started);
    last.current = curves;
  };
}

export function Chart({ curves, name, kept, point, ...handle }: ChartProps) {
  const { frame, drawn: find } = useFrame();
  const measured = useMeasured(curves);
  const drawn = (root: HTMLElement) => {
    measured();
    find(root);
  };
  const { sweep } = curves;
  const overlay = useMemo(() => kept && { lobes: kept.curves.lobes, sweep: kept.curves.sweep, name: kept.name }, [kept?.curves, kept?.name]);
  const draw = useCallback(
    (theme: Theme) => {
      const height = chartHeight(window.innerHeight);
      if (sweep === null) return liveFigure({ lobes: curves.lobes, name, kept: overlay, moving: !curves.whole }, theme, height);
      return liveSweepFigure({ sweep, kept: overlay?.sweep ? { sweep: overlay.sweep, name: overlay.name } : null }, theme, height);
    },
    [curves, name, overlay],
  );
  const drag = 'drag the point, or move it with the arrow keys.';
  return (
    <div class="chart-place" data-whole={curves.whole}>
      <Plot
        which="live-lobes"
        shows={
          sweep === null
            ? 'Stability lobes: limit depth over spindle speed, with the operating point'
            : `Spectral radius over spindle speed and ${sweptOf(sweep).name.toLowerCase()}, with the operating point`
        }
        caption={sweep === null ? `Below the line a cut is stable; ${drag}` : `Where the spectral radius is above 1, a vibration grows; the line is where it is 1. D${drag.slice(1)}`}
        draw={draw}
        drawn={drawn}
      />
      {frame && point && <Handle frame={frame} point={point} {...handle} />}
    </div>
  );
}
