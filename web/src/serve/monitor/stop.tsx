// How spindles are no longer monitored: each is ended once, a running one after a question.
import { useLayoutEffect, useRef, useState } from 'preact/hooks';
import type { ApiError } from '../api';
import { Confirm, useAsked, type Asked } from '../confirm';
import { useAction, useServe } from '../context';
import { goTo } from '../route';
import type { MonitorSummary } from './documents';
import { isOver, nameOf } from './text';

const settle_ms = 500; // the second click of a double click comes before, and meets the row that moved up

/** What a press of a spindle's button does; `gone_ms`: since a row went. */
export function stopAction({ id, status }: Pick<MonitorSummary, 'id' | 'status'>, ending: ReadonlySet<number>, gone_ms: number): 'nothing' | 'ask' | 'end' {
  if (ending.has(id) || gone_ms < settle_ms) return 'nothing';
  return isOver({ status }) ? 'end' : 'ask';
}

/** Of ids those that are still there; the same set where all are. */
export function stillThere(ids: ReadonlySet<number>, spindles: Pick<MonitorSummary, 'id'>[]): ReadonlySet<number> {
  const kept = [...ids].filter((id) => spindles.some((one) => one.id === id));
  return kept.length === ids.size ? ids : new Set(kept);
}

export interface Stopping {
  ending: ReadonlySet<number>; // until they are gone
  asked: Asked<MonitorSummary>; // whether it is to be stopped
  error: ApiError | null;
  press: (summary: MonitorSummary) => void;
  end: (summary: MonitorSummary) => void;
  keep: () => void;
}

/** `path`: of the view; of a spindle that is ended it is left. */
export function useStop(spindles: MonitorSummary[] | null, path: string): Stopping {
  const { api, announce } = useServe();
  const { error, act } = useAction();
  const [ending, setEnding] = useState<ReadonlySet<number>>(new Set());
  const [asked, ask] = useAsked<number>();
  const before = useRef<ReadonlySet<number>>(new Set());
  const went = useRef(-Infinity);
  useLayoutEffect(() => {
    if (spindles === null) return;
    if (stillThere(before.current, spindles) !== before.current) went.current = performance.now();
    before.current = new Set(spindles.map(({ id }) => id));
    setEnding((ids) => stillThere(ids, spindles));
  }, [spindles?.map(({ id }) => id).join()]);
  const end = (summary: MonitorSummary) => {
    ask(null);
    setEnding((ids) => new Set([...ids, summary.id]));
    void act(async () => {
      try {
        await api.endMonitor(summary.id);
      } catch (thrown) {
        setEnding((ids) => new Set([...ids].filter((id) => id !== summary.id)));
        throw thrown;
      }
      announce(`${nameOf(summary)} is no longer monitored`);
      if (String(summary.id) === path) goTo('monitor');
    });
  };
  const press = (summary: MonitorSummary) => {
    const action = stopAction(summary, ending, performance.now() - went.current);
    if (action === 'end') end(summary);
    else if (action === 'ask') ask(summary.id);
  };
  const what = spindles?.find(({ id }) => id === asked.what && !ending.has(id)) ?? null;
  return { ending, asked: { ...asked, what }, error, press, end, keep: () => ask(null) };
}

export function StopQuestion({ asked, end, keep }: Pick<Stopping, 'end' | 'keep'> & { asked: MonitorSummary }) {
  return (
    <Confirm heading={`Stop ${nameOf(asked)}?`} yes="Stop" no="Keep monitoring" act={() => end(asked)} cancel={keep}>
      {isOver(asked) ? 'It has ended.' : 'It is being monitored.'} Its history and spectrogram are lost.
    </Confirm>
  );
}
