// Curves that follow the sliders: asks while they move, and for all when they rest.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import type { ChartPoint, LimitRow, SweepDocument } from '../../documents';
import { lobesOf, type Lobes } from '../../views';
import { asApiError, type Api, type ApiError } from '../api';
import type { LobesAnswer, LobesRequest } from '../documents';
import { Latest } from '../latest';
import { firstPoint, keysOf, pointsOf, sameCurves, type Evaluated, type FileValues, type Point, type Settings } from './settings';
import { firstSweptPoint } from './swept';

const rest_ms = 120; // after the last movement

interface Question {
  settings: Settings;
  answer: LobesRequest['answer'];
  started: number | null; // when the hand moved, on the clock of events
}

/** What was answered: the limit over the speed, or the map of another parameter that the file sweeps. */
export interface Curves {
  lobes: Lobes; // empty of a sweep
  limit: LimitRow[];
  sweep: SweepDocument | null;
  settings: Settings; // that it belongs to
  whole: boolean; // with boundary and band
  started: number | null;
}

export interface Live {
  curves: Curves | null;
  points: ChartPoint[]; // of the settings as they are
  answer: LobesAnswer | null; // the last
  settings: Settings;
  file: FileValues | null; // known with the first answer
  error: ApiError | null;
  retry: () => void; // asks for the first curve again
  move: (change: Partial<Settings>, started: number | null) => void;
  rest: () => void;
  wrote: (file: FileValues) => void; // the file says this now
}

/** The answer as the figures need it. */
export function curvesOf({ lobes }: LobesAnswer, { settings, answer, started }: Question): Curves {
  const rest = { settings, whole: answer === 'chart', started };
  if (lobes.document === 'sweep/1') {
    const none = { spindle_speed_rpm: lobes.spindle_speed_rpm, axial_depth_mm: [], boundary: [], limit: [] };
    return { lobes: lobesOf(none), limit: [], sweep: lobes, ...rest };
  }
  const found = lobes.limit.filter((row) => row.axial_depth_mm !== null);
  const boundary = lobes.boundary.length > 0 ? lobes.boundary : found;
  return { lobes: lobesOf({ ...lobes, boundary }), limit: lobes.limit, sweep: null, ...rest };
}

function firstPointOf({ lobes, sweep }: Curves): Point {
  return sweep ? firstSweptPoint(sweep) : firstPoint(lobes);
}

/** A hidden page has no frames. */
function nextFrame(): Promise<void> {
  return new Promise((resolve) => void (document.hidden ? setTimeout(resolve, 0) : requestAnimationFrame(() => resolve())));
}

export function useLive(api: Api, path: string): Live {
  const [settings, setSettings] = useState<Settings>({ set: {}, modes: null, point: null });
  const [curves, setCurves] = useState<Curves | null>(null);
  const [answer, setAnswer] = useState<LobesAnswer | null>(null);
  const [evaluated, setEvaluated] = useState<Evaluated | null>(null);
  const [file, setFile] = useState<FileValues | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  const now = useRef({ settings, curves });
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  const client = useMemo(() => Math.random().toString(36).slice(2), []);

  const set = (next: Settings) => {
    now.current.settings = next;
    setSettings(next);
  };
  /** A point that moves leaves the curves as they are. */
  const answered = (got: LobesAnswer, question: Question) => {
    setError(null);
    setAnswer(got);
    setEvaluated({ points: got.lobes.points, settings: question.settings });
    const before = now.current.curves;
    const keep = before !== null && question.answer === 'limit' && sameCurves(before.settings, question.settings);
    if (!keep) {
      now.current.curves = curvesOf(got, question);
      setCurves(now.current.curves);
    }
    if (before === null) begin(got);
  };
  const begin = (got: LobesAnswer) => {
    setFile({ fields: got.fields, modes: got.modes.filter(({ kept }) => kept).map(({ number }) => number) });
    set({ ...now.current.settings, point: firstPointOf(now.current.curves!) });
    latest.put({ settings: now.current.settings, answer: 'chart', started: null });
  };
  const latest = useMemo(
    () =>
      new Latest<Question, LobesAnswer>({
        ask: ({ settings: { point, ...rest }, answer: wanted }, sequence, signal) =>
          api.lobes({ file: path, set: keysOf({ ...rest, point }), answer: wanted, at: point ? [point] : [], client, channel: 'a', sequence }, signal),
        interruptible: (question) => question.answer === 'chart',
        drawn: nextFrame,
        answered,
        failed: (thrown) => {
          const failure = asApiError(thrown);
          if (!failure.superseded) setError(failure);
        },
      }),
    [],
  );
  const first = () => latest.put({ settings: now.current.settings, answer: 'limit', started: null });
  useEffect(() => {
    first();
    return () => {
      clearTimeout(timer.current);
      latest.stop();
    };
  }, []);

  return {
    curves,
    points: pointsOf(evaluated, settings),
    answer,
    settings,
    file,
    error,
    retry: first,
    move: (change, started) => {
      clearTimeout(timer.current);
      set({ ...now.current.settings, ...change });
      latest.put({ settings: now.current.settings, answer: 'limit', started });
    },
    rest: () => {
      clearTimeout(timer.current);
      timer.current = setTimeout(() => {
        const { settings: last, curves: shown } = now.current;
        if (!shown?.whole || !sameCurves(shown.settings, last)) latest.put({ settings: last, answer: 'chart', started: null });
      }, rest_ms);
    },
    wrote: setFile,
  };
}
