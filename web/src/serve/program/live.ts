// A program with another γ: asks the server where the line of γ rests.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { asApiError, type Api, type ApiError } from '../api';
import { Latest } from '../latest';
import type { GammaLine } from './gamma_line';
import type { ProgramAnswer, ProgramRequest } from './documents';

/** What the server found with a line. */
export interface Evaluation {
  answer: ProgramAnswer;
  line: GammaLine;
}

/** To a thousandth of a millimetre and of a degree. */
export function requestOf(job: number, line: GammaLine, client: string, sequence: number): ProgramRequest {
  const rounded = (value: number) => Math.round(1000 * value) / 1000;
  return { job, gamma: line.map(([path, gamma]) => [rounded(path), rounded(gamma)]), client, channel: 'program', sequence };
}

export interface EvaluatorOptions {
  api: Pick<Api, 'program'>;
  job: number;
  client: string;
  answered: (evaluation: Evaluation) => void;
  failed: (error: ApiError | null) => void; // null: a newer line took its place
}

/** At most one request is under way: a newer line takes the place of the one before. */
export function evaluatorOf({ api, job, client, answered, failed }: EvaluatorOptions): Latest<GammaLine, ProgramAnswer> {
  return new Latest<GammaLine, ProgramAnswer>({
    ask: (line, sequence, signal) => api.program(requestOf(job, line, client, sequence), signal),
    interruptible: () => true,
    answered: (answer, line) => answered({ answer, line }),
    failed: (thrown) => {
      const error = asApiError(thrown);
      failed(error.superseded ? null : error);
    },
    drawn: () => Promise.resolve(),
  });
}

export interface Evaluated {
  evaluation: Evaluation | null; // the last
  error: ApiError | null; // of the last line
  busy: boolean;
  ask: (line: GammaLine) => void;
}

export function useEvaluated(api: Api, job: number, answered: () => void): Evaluated {
  const [evaluation, setEvaluation] = useState<Evaluation | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  const [busy, setBusy] = useState(false);
  const told = useRef(answered);
  told.current = answered;
  const evaluator = useMemo(
    () =>
      evaluatorOf({
        api,
        job,
        client: Math.random().toString(36).slice(2),
        answered: (got) => {
          setBusy(false);
          setEvaluation(got);
          told.current();
        },
        failed: (failure) => {
          setBusy(false);
          setError(failure);
        },
      }),
    [api, job],
  );
  useEffect(() => () => evaluator.stop(), [evaluator]);
  const ask = (line: GammaLine) => {
    setError(null);
    setBusy(true);
    evaluator.put(line);
  };
  return { evaluation, error, busy, ask };
}
