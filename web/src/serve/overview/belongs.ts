// Where dropped files go in a job.
import type { Api } from '../api';
import type { FileKind } from '../documents';
import type { Overview } from './documents';
import { stageOf } from './stages';

/** "a/b/" of "a/b/c.toml"; empty at the top. */
export function folderOf(path: string): string {
  return path.slice(0, path.lastIndexOf('/') + 1);
}

/** Records go beside hits.toml, all else beside the job. By the name alone: the kind is known only after the file was sent. */
export function folderFor(name: string, overview: Overview, recordEndings: string[]): string {
  const hits = stageOf(overview, 'hits')?.file ?? null;
  const isRecord = recordEndings.some((ending) => name.toLowerCase().endsWith(ending));
  return folderOf(hits !== null && isRecord ? hits : overview.file);
}

const structure = ['hits', 'frf', 'modes', 'assembly'];

/** The key of [job] that names such a file, where the job has nothing in its place. */
export function keyFor(kind: FileKind, { names, stages }: Overview): string | null {
  const given = (stage: string) => stages.some((one) => one.stage === stage && one.file !== null);
  if (kind === 'program') return names.includes('program') ? null : 'program';
  if (kind === 'cell') return names.includes('cell') || given('robot') ? null : 'cell';
  if (!structure.includes(kind)) return null;
  return structure.some((key) => names.includes(key)) || given('modes') || given('frfs') ? null : kind;
}

/** The path of a file as the job writes it. */
export function pathFrom(job: string, file: string): string {
  const from = folderOf(job).split('/').slice(0, -1);
  const to = file.split('/');
  let same = 0;
  while (same < from.length && same < to.length - 1 && from[same] === to[same]) ++same;
  return [...from.slice(same).map(() => '..'), ...to.slice(same)].join('/');
}

/** Names a file in the job, over the state that was read. */
export async function nameInJob(api: Api, job: string, key: string, file: string): Promise<void> {
  const { text, etag } = await api.file(job);
  const edited = await api.edit(text, `job.${key}`, pathFrom(job, file));
  await api.write(job, edited.text, etag);
}

/** Where files go that are dropped on a job, and what is done with each once its kind is known. */
export interface Belongs {
  folder: (name: string) => string;
  /** What was done, in words; null: nothing. */
  settle: (path: string, kind: FileKind) => Promise<string | null>;
}

export function belongsTo(api: Api, overview: Overview, recordEndings: string[]): Belongs {
  const named = new Set<string>(); // of several files that are dropped together the first
  return {
    folder: (name) => folderFor(name, overview, recordEndings),
    async settle(path, kind) {
      const key = keyFor(kind, { ...overview, names: [...overview.names, ...named] });
      if (key === null) return null;
      await nameInJob(api, overview.file, key, path);
      named.add(key);
      return `${overview.file} names it now as job.${key}`;
    },
  };
}
