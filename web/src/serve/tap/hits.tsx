// The single hits of a tap test: over each other, and as a table in which each can be left out.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { Table } from '../../parts';
import { Choice, Plot, type Draw } from '../../plot';
import { dash, significant } from '../../text';
import type { Api } from '../api';
import { useAction, useServe } from '../context';
import type { Tap, TapHit, TapHitCurves } from '../documents';
import { Button, ErrorBox } from '../pieces';
import { frfNames, hitFrfFigure, timeFigure, timeNames, type Overlaid } from './overlay';

const at_a_time = 8;

/** Asks for the curves of the hits that are not known yet, some at a time; what it gets it hands on. */
export async function loadCurves(api: Pick<Api, 'tapHit'>, known: number, count: number, got: (hits: TapHitCurves[]) => void, signal: AbortSignal): Promise<void> {
  for (let from = known + 1; from <= count; from += at_a_time) {
    const numbers = Array.from({ length: Math.min(at_a_time, count - from + 1) }, (_, i) => from + i);
    const hits = await Promise.all(numbers.map((number) => api.tapHit(number, signal)));
    if (signal.aborted) return;
    got(hits);
  }
}

/** Of each hit once: they do not change. Those that do not come are asked for again with the next hit. */
function useCurves(id: number, count: number): TapHitCurves[] {
  const { api } = useServe();
  const [curves, setCurves] = useState<TapHitCurves[]>([]);
  const known = useRef<{ id: number; hits: TapHitCurves[] }>({ id, hits: [] });
  useEffect(() => {
    if (known.current.id !== id) known.current = { id, hits: [] };
    setCurves(known.current.hits);
    const controller = new AbortController();
    const took = (hits: TapHitCurves[]) => {
      known.current = { id, hits: [...known.current.hits, ...hits] };
      setCurves(known.current.hits);
    };
    loadCurves(api, known.current.hits.length, count, took, controller.signal).catch(() => {});
    return () => controller.abort();
  }, [id, count]);
  return curves;
}

/** The hits that are drawn; which of them are used the state says. `all`: also those that are not. */
export function overlaid(curves: TapHitCurves[], taken: TapHit[], all: boolean): Overlaid[] {
  return curves.flatMap((hit) => {
    const used = taken[hit.number - 1]?.accepted;
    const newest = hit.number === taken.length;
    return used !== undefined && hit.force && (used || newest || all) ? [{ hit, used, newest }] : [];
  });
}

/** Whether a logarithmic axis serves the FRFs of single hits. */
function spansDecades(curves: TapHitCurves[]): boolean {
  const lines = curves.find((hit) => hit.frf)?.frf?.frequency_hz ?? [];
  return (lines[lines.length - 1] ?? 1) / (lines.find((line) => line > 0) ?? 1) > 30;
}

export function Overlay({ tap: { id, taken } }: { tap: Tap }) {
  const curves = useCurves(id, taken.length);
  const [all, setAll] = useState(false);
  const [time, setTime] = useState('force');
  const [pulse, setPulse] = useState(true);
  const [frf, setFrf] = useState('');
  const times = useMemo(() => timeNames(curves), [curves]);
  const names = useMemo(() => frfNames(curves), [curves]);
  const shownTime = times.includes(time) ? time : 'force';
  const shownFrf = names.includes(frf) ? frf : (names[0] ?? '');
  // The same until there is something else to draw: another one draws up to 200 hits anew.
  const draw = useMemo(() => {
    const hits = overlaid(curves, taken, all);
    const inTime: Draw = (theme) => timeFigure(hits, shownTime, pulse, theme);
    const ownFrf: Draw = (theme) => hitFrfFigure(hits, shownFrf, spansDecades(curves), theme);
    return shownFrf === '' ? [inTime] : [inTime, ownFrf];
  }, [curves, taken, all, shownTime, pulse, shownFrf]);
  if (!curves.some(({ force }) => force)) return <p class="notice">Each hit is drawn here, over those before it.</p>;
  return (
    <Plot
      which="tap-hits"
      shows={`Single hits over each other: ${shownTime} in time, and the magnitude of ${shownFrf}`}
      caption="The newest hit is the thick line; hits that are not used are dashed."
      draw={draw}
    >
      <Choice legend="Hits" names={['used', 'all']} chosen={Number(all)} choose={(chosen) => setAll(chosen === 1)} />
      <Choice legend="In time" names={times} chosen={times.indexOf(shownTime)} choose={(chosen) => setTime(times[chosen]!)} />
      <Choice legend="Stretch" names={['pulse', 'whole']} chosen={pulse ? 0 : 1} choose={(chosen) => setPulse(chosen === 0)} />
      {names.length > 1 && <Choice legend="FRF" names={names} chosen={names.indexOf(shownFrf)} choose={(chosen) => setFrf(names[chosen]!)} />}
    </Plot>
  );
}

function whyText({ excluded, reasons }: TapHit): string {
  return [...(excluded ? ['left out by hand'] : []), ...reasons].join('; ');
}

interface TableProps {
  taken: TapHit[];
  busy: boolean;
  accept?: (number: number, accepted: boolean) => void; // none: the test is over
}

export function HitsTable({ taken, busy, accept }: TableProps) {
  const change = ({ number, accepted, excluded }: TapHit) => {
    if (!accept || (!accepted && !excluded)) return dash;
    return (
      <Button act={() => accept(number, !accepted)} disabled={busy} label={accepted ? `Leave out hit ${number}` : `Use hit ${number}`}>
        {accepted ? 'Leave out' : 'Use'}
      </Button>
    );
  };
  return (
    <Table
      caption="Hits, the newest first"
      rows={[...taken].reverse()}
      rowClass={({ accepted }) => (accepted ? '' : 'rejected')}
      rowKey={({ number }) => number}
      columns={[
        { heading: 'Hit', number: true, cell: ({ number }) => number },
        { heading: 'File', cell: ({ file }) => file },
        { heading: 'Force', cell: ({ force_direction }) => force_direction },
        { heading: 'Peak (N)', number: true, cell: ({ peak_force_n }) => significant(peak_force_n) },
        { heading: 'Used', cell: ({ accepted }) => (accepted ? 'yes' : <strong>no</strong>) },
        { heading: 'Why', long: true, cell: whyText },
        { heading: 'Change', optional: true, cell: change },
      ]}
    />
  );
}

/** The table with what its buttons do. */
export function Hits({ tap }: { tap: Tap }) {
  const { api, announce } = useServe();
  const { busy, error, act } = useAction();
  const accept = (number: number, accepted: boolean) =>
    void act(async () => {
      await api.acceptHit(number, accepted);
      announce(accepted ? `Hit ${number} is used` : `Hit ${number} is left out`);
    });
  return (
    <>
      <HitsTable taken={tap.taken} busy={busy} {...(tap.running ? { accept } : {})} />
      <ErrorBox error={error} />
    </>
  );
}
