// What the view of a program needs, made of jobs, columns and answers.
import type { BlockColumns, BlocksDocument, Decision, Num, Report } from '../../documents';
import { isUnstable, numberAt } from '../../path_views';
import { significant } from '../../text';
import type { Job } from '../documents';
import type { LineBounds, LineMargin } from './gamma_line';
import type { Evaluation } from './live';

/** What is kept of a job's report. */
export interface LoadedProgram {
  id: number; // of the job
  input: string;
  document: BlocksDocument;
  decision: Decision | null;
}

/** Jobs that may have a program to show, the newest first. */
export function candidates(jobs: Job[]): Job[] {
  return jobs.filter(({ verb, state, report }) => verb === 'plan' && state === 'done' && report).sort((a, b) => b.id - a.id);
}

/** What is still known of jobs: of those that are there, and of the one that is shown; the same where all are. */
export function stillKnown<T>(known: ReadonlyMap<number, T>, jobs: Pick<Job, 'id'>[], shown: number | null): ReadonlyMap<number, T> {
  const kept = [...known].filter(([id]) => id === shown || jobs.some((job) => job.id === id));
  return kept.length === known.size ? known : new Map(kept);
}

/** null: the job has no program. */
export function programOf({ id, input }: Job, { blocks, plan }: Report): LoadedProgram | null {
  return blocks ? { id, input, document: blocks, decision: plan?.decision ?? null } : null;
}

/** Whether the blocks are those of a program that was decided, or of the one that was given. */
export function jobName({ decision }: LoadedProgram): string {
  return decision?.decided ? 'as chosen by the job' : 'as programmed';
}

/** What a program comes to. */
export interface ProgramOutcome {
  unstable: number;
  least: Num; // stability margin
  block: Num; // where it is
  force_n: Num;
  deflection_um: Num;
  engagement_lost: number; // blocks whose force pushes the tool out of the cut
  cannot_take: Num; // blocks that the robot cannot take; null: the job did not ask
}

function most(column: Num[] | undefined): Num {
  return (column ?? []).reduce<Num>((high, value) => (value === null ? high : Math.max(high ?? value, value)), null);
}

export function outcomeOf({ blocks: columns, summary }: BlocksDocument): ProgramOutcome {
  let worst: number | null = null;
  columns.block.forEach((_, i) => {
    const margin = numberAt(columns.stability_margin, i);
    if (margin !== null && (worst === null || margin < columns.stability_margin![worst]!)) worst = i;
  });
  return {
    unstable: columns.block.filter((_, i) => isUnstable(columns, i)).length,
    least: worst === null ? null : columns.stability_margin![worst]!,
    block: worst === null ? null : columns.block[worst]!,
    force_n: most(columns.peak_f_n),
    deflection_um: most(columns.deflection_um),
    engagement_lost: summary.engagement_lost,
    cannot_take: null,
  };
}

export function evaluatedOutcome({ answer }: Evaluation): ProgramOutcome {
  const { blocks, unstable, least_margin, lost } = answer;
  return { ...outcomeOf(blocks), unstable, least: least_margin, cannot_take: lost.length };
}

export interface Standing {
  shown: 'job' | 'line';
  name: string; // of the job's columns
  evaluation: Evaluation | null;
  current: boolean; // the evaluation belongs to the line as it is
  busy: boolean;
}

/** Which columns are shown, in words. */
export function standingText({ shown, name, evaluation, current, busy }: Standing): string {
  const seconds = evaluation === null ? '' : ` in ${significant(evaluation.answer.milliseconds / 1000)} s`;
  const is = shown === 'job' || evaluation === null ? `Shown: ${name}.` : `Shown: re-evaluated with your γ${current ? `${seconds}.` : ' as it was before the last change.'}`;
  return busy ? `${is} Your γ is being evaluated …` : is;
}

/** "Least margin on the map 0.31 at block 46 (123 mm)." */
export function lineText({ least, index, unstable, without }: LineMargin, map: { block: number[]; path_mm: number[] }): string {
  if (index === null) return 'The map has no margin along this line.';
  const chatters = unstable === 0 ? '' : ` ${unstable} of ${map.block.length} places chatter.`;
  const missing = without === 0 ? '' : ` At ${without} the robot cannot stand so.`;
  return `Least margin on the map ${significant(least)} at block ${map.block[index]!} (${map.path_mm[index]!.toFixed(1)} mm).${chatters}${missing}`;
}

/** What a key does to γ; null: nothing. */
export function keyTurn(key: string, shift: boolean, gamma_deg: number, { gamma: [low, high] }: LineBounds): number | null {
  const step = shift ? 10 : 1;
  switch (key) {
    case 'ArrowUp':
    case 'ArrowRight':
      return gamma_deg + step;
    case 'ArrowDown':
    case 'ArrowLeft':
      return gamma_deg - step;
    case 'PageUp':
      return gamma_deg + 10;
    case 'PageDown':
      return gamma_deg - 10;
    case 'Home':
      return low;
    case 'End':
      return high;
    default:
      return null;
  }
}

/** That many blocks in their order, the selected one in the middle; those that cut, and the selected one. */
export function blocksAround(columns: BlockColumns, selected: number | null, count: number): number[] {
  const some = columns.block.map((_, i) => i).filter((i) => i === selected || numberAt(columns.spectral_radius, i) !== null);
  const at = selected === null ? 0 : some.indexOf(selected);
  const first = Math.max(0, Math.min(some.length - count, at - Math.floor(count / 2)));
  return some.slice(first, first + count);
}
