// The server's answers, one function a path.
import type { CheckAnswer, Fault, FolderState, Inspection, Job, JobRequest, LobesAnswer, LobesRequest, ServeConfig, Tap, TapHitCurves, TapRequest, Value, Verb } from './documents';
import type { Report } from '../documents';
import { requireDocument, requireReport } from '../parse';
import type { MonitorSession, MonitorSummary } from './monitor/documents';
import { sayOutdated } from './outdated';
import type { Overview } from './overview/documents';
import type { ProgramAnswer, ProgramRequest } from './program/documents';

/** The server's no: its status, and what was wrong. Status 0: no answer at all. */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly fault: Fault,
    readonly superseded = false, // a newer question took its place
  ) {
    super(fault.text);
  }
}

export const most_bytes = 32e6; // of a file that is sent

export function faultOf(text: string): Fault {
  return { text, file: null, line: null, field: null, value: null, unit: null, rule: null, hint: null };
}

/** With all keys of its error: the server may send the text alone. */
export function wholeFault<T extends { error: Fault | null }>(got: T): T {
  return got.error ? { ...got, error: { ...faultOf(''), ...got.error } } : got;
}

/** The same of a tap test, whose stream has the error. */
export function wholeTap<T extends Tap | null>(tap: T): T {
  return tap?.stream ? { ...tap, stream: wholeFault(tap.stream) } : tap;
}

async function errorOf(response: Response): Promise<ApiError> {
  const { status } = response;
  const body = (await response.json().catch(() => null)) as { error?: Partial<Fault>; superseded?: boolean } | null;
  const plain = faultOf(`The server answered ${status} ${response.statusText}`.trim() + '.');
  return new ApiError(status, { ...plain, ...body?.error }, body?.superseded === true);
}

export function isAborted(error: unknown): boolean {
  return error instanceof DOMException && error.name === 'AbortError';
}

/** Whatever went wrong as an ApiError. */
export function asApiError(error: unknown): ApiError {
  if (error instanceof ApiError) return error;
  return new ApiError(0, faultOf(error instanceof Error ? error.message : String(error)));
}

export type Api = ReturnType<typeof openApi>;

export function openApi({ token }: Pick<ServeConfig, 'token'>, send: (path: string, options: RequestInit) => Promise<Response> = (path, options) => fetch(path, options)) {
  async function ask(method: string, path: string, options: RequestInit = {}): Promise<Response> {
    // Of GET too: where connections are few the server answers those of its page.
    const headers = { 'X-Robomill-Token': token, ...(options.headers as Record<string, string> | undefined) };
    let response: Response;
    try {
      response = await send(path, { ...options, method, headers, cache: 'no-store', credentials: 'same-origin' });
    } catch (error) {
      if (isAborted(error)) throw error;
      throw new ApiError(0, faultOf('robomill does not answer. Is `robomill serve` still running?'));
    }
    if (response.status === 403 && method !== 'GET') sayOutdated();
    if (!response.ok) throw await errorOf(response);
    return response;
  }
  async function get<T>(path: string, signal?: AbortSignal): Promise<T> {
    return (await ask('GET', path, signal ? { signal } : {})).json() as Promise<T>;
  }
  async function give<T>(method: string, path: string, body: unknown, signal?: AbortSignal): Promise<T> {
    const options = { body: JSON.stringify(body), headers: { 'Content-Type': 'application/json' }, ...(signal ? { signal } : {}) };
    return (await ask(method, path, options)).json() as Promise<T>;
  }
  const post = <T>(path: string, body: unknown, signal?: AbortSignal) => give<T>('POST', path, body, signal);
  const filePath = (path: string) => `/api/file?path=${encodeURIComponent(path)}`;

  return {
    async state(signal?: AbortSignal): Promise<FolderState> {
      const state = await get<FolderState>('/api/state', signal);
      return { ...state, jobs: state.jobs.map(wholeFault) };
    },
    /** The text of a file and the tag that stands for this state of it. */
    async file(path: string, signal?: AbortSignal): Promise<{ text: string; etag: string }> {
      const response = await ask('GET', filePath(path), signal ? { signal } : {});
      return { text: await response.text(), etag: response.headers.get('ETag') ?? '' };
    },
    /** Writes a file: over the state that `etag` stands for, null: a new one. ApiError 409 where another state, or a file, is there. */
    async write(path: string, body: string | Blob, etag: string | null): Promise<{ etag: string }> {
      const match = etag === null ? { 'If-None-Match': '*' } : { 'If-Match': etag };
      const response = await ask('PUT', filePath(path), { body, headers: { 'Content-Type': 'application/octet-stream', ...match } });
      return response.json() as Promise<{ etag: string }>;
    },
    check: async (path: string, text: string, signal?: AbortSignal) => wholeFault(await post<CheckAnswer>('/api/check', { path, text }, signal)),
    edit: (text: string, key: string, value: Value, signal?: AbortSignal) => post<{ text: string }>('/api/edit', { text, key, value }, signal),
    async inspect(path: string, signal?: AbortSignal): Promise<Inspection> {
      const nothing = { columns: [], rows: null, sample_rate_hz: null, direction_guess: null, questions: [], files: [], time: null };
      return { ...nothing, ...(await post<Pick<Inspection, 'kind'> & Partial<Inspection>>('/api/inspect', { path }, signal)) };
    },
    /** Of a job. */
    overview: (file: string, signal?: AbortSignal) => get<Overview>(`/api/overview?file=${encodeURIComponent(file)}`, signal),
    verbs: (signal?: AbortSignal) => get<Verb[]>('/api/verbs', signal),
    run: (request: JobRequest) => post<{ id: number }>('/api/jobs', request),
    job: async (id: number, signal?: AbortSignal) => wholeFault(await get<Job>(`/api/jobs/${id}`, signal)),
    cancel: (id: number) => ask('DELETE', `/api/jobs/${id}`),
    async report(id: number, signal?: AbortSignal): Promise<Report> {
      const report = await get<unknown>(`/api/jobs/${id}/report`, signal);
      requireReport(report);
      return report;
    },
    async lobes(request: LobesRequest, signal?: AbortSignal): Promise<LobesAnswer> {
      const answer = await post<LobesAnswer>('/api/lobes', request, signal);
      requireDocument(['lobes', 'sweep'], answer.lobes);
      return answer;
    },
    async program(request: ProgramRequest, signal?: AbortSignal): Promise<ProgramAnswer> {
      const answer = await post<ProgramAnswer>('/api/program', request, signal);
      requireDocument(['blocks'], answer.blocks);
      return answer;
    },
    tap: async (signal?: AbortSignal) => wholeTap(await get<Tap | null>('/api/tap', signal)),
    startTap: async (request: TapRequest) => ({ state: wholeTap((await post<{ state: Tap }>('/api/tap', request)).state) }),
    /** Of a stream's hits from now on. */
    turnTap: async (force_direction: string) => wholeTap(await give<Tap>('PUT', '/api/tap', { force_direction })),
    tapHit: (number: number, signal?: AbortSignal) => get<TapHitCurves>(`/api/tap/${number}`, signal),
    acceptHit: (number: number, accepted: boolean) => give<TapHitCurves>('PUT', `/api/tap/${number}`, { accepted }),
    /** By the ending of the path: .toml the hits, else their FRFs. ApiError 409 where a file is there that may not be replaced. */
    saveTap: (path: string, replace: boolean) => post<{ files: string[] }>('/api/tap/save', { path, replace }),
    endTap: () => ask('DELETE', '/api/tap'),
    monitors: async (signal?: AbortSignal) => (await get<MonitorSummary[]>('/api/monitors', signal)).map(wholeFault),
    monitor: async (id: number, signal?: AbortSignal) => wholeFault(await get<MonitorSession>(`/api/monitors/${id}`, signal)),
    /** `input`: a recording, "mqtt://HOST/TOPIC", or empty: the topic of the settings. `speed`: of a recording, times its own. */
    startMonitor: (config: string, input: string, speed: number) => post<{ id: number }>('/api/monitors', { config, input, speed }),
    endMonitor: (id: number) => ask('DELETE', `/api/monitors/${id}`),
  };
}
