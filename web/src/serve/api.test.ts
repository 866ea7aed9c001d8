import { describe, expect, it } from 'vitest';
import { ApiError, asApiError, faultOf, isAborted, openApi } from './api';
import { isOutdated } from './outdated';

interface Sent {
  path: string;
  options: RequestInit;
}

/** An api whose server answers with these, one after the other. */
function serverWith(...answers: (Response | Error)[]) {
  const sent: Sent[] = [];
  const api = openApi({ token: 'secret' }, (path, options) => {
    sent.push({ path, options });
    const answer = answers[sent.length - 1]!;
    return answer instanceof Error ? Promise.reject(answer) : Promise.resolve(answer);
  });
  return { api, sent };
}

function json(body: unknown, status = 200): Response {
  return new Response(JSON.stringify(body), { status });
}

async function failure(promise: Promise<unknown>): Promise<ApiError> {
  return promise.then(
    () => Promise.reject(new Error('no error')),
    (error: unknown) => error as ApiError,
  );
}

function headers({ options }: Sent): Record<string, string> {
  return options.headers as Record<string, string>;
}

describe('what is sent', () => {
  it('carries the token where something is written, and only there', async () => {
    const { api, sent } = serverWith(json({ jobs: [] }), json({ id: 3 }), new Response(), json({ etag: '"b"' }));
    await api.state();
    expect(await api.run({ verb: 'plan', input: 'job.toml', output: 'out', options: { seed: 3 } })).toEqual({ id: 3 });
    await api.cancel(3);
    await api.write('a.toml', 'x', '"a"');
    expect(sent.map(({ path, options }) => `${options.method} ${path}`)).toEqual(['GET /api/state', 'POST /api/jobs', 'DELETE /api/jobs/3', 'PUT /api/file?path=a.toml']);
    expect(sent.map((one) => headers(one)['X-Robomill-Token'])).toEqual(['secret', 'secret', 'secret', 'secret']);
    expect(JSON.parse(sent[1]!.options.body as string)).toEqual({ verb: 'plan', input: 'job.toml', output: 'out', options: { seed: 3 } });
  });
  it('says which state of a file it was made from', async () => {
    const { api, sent } = serverWith(new Response('teeth = 3', { headers: { ETag: '"a"' } }), json({ etag: '"b"' }), json({ etag: '"c"' }));
    expect(await api.file('a b/ä.toml')).toEqual({ text: 'teeth = 3', etag: '"a"' });
    expect(sent[0]!.path).toBe('/api/file?path=a%20b%2F%C3%A4.toml');
    await api.write('lobes.toml', 'teeth = 4', '"a"');
    await api.write('new.toml', '', null);
    expect(headers(sent[1]!)['If-Match']).toBe('"a"');
    expect(headers(sent[2]!)['If-None-Match']).toBe('*');
    expect(headers(sent[2]!)['If-Match']).toBeUndefined();
  });
});

it('fills in what a file that is no recording has not', async () => {
  const { api } = serverWith(json({ kind: 'program' }));
  expect(await api.inspect('part.ngc')).toEqual({ kind: 'program', columns: [], rows: null, sample_rate_hz: null, direction_guess: null, questions: [], files: [], time: null });
});

describe('what goes wrong', () => {
  it('is the fault that the server names', async () => {
    const { api } = serverWith(json({ error: { text: 'lobes.toml:14: tool.teeth = 0', line: 14, field: 'tool.teeth' } }, 400));
    const error = await failure(api.check('lobes.toml', ''));
    expect(error.status).toBe(400);
    expect(error.fault).toEqual({ text: 'lobes.toml:14: tool.teeth = 0', file: null, line: 14, field: 'tool.teeth', value: null, unit: null, rule: null, hint: null });
    expect(error.message).toBe(error.fault.text);
  });
  it('may be a text alone', async () => {
    const error = { text: 'not enough memory for this input' };
    const { api } = serverWith(json({ error }, 400), json({ id: 1, error }), json({ jobs: [{ id: 1, error }, { id: 2, error: null }] }), json({ id: 1, stream: { error } }), json([{ id: 1, error }]));
    const whole = faultOf(error.text);
    expect((await failure(api.verbs())).fault).toEqual(whole);
    expect((await api.job(1)).error).toEqual(whole);
    expect((await api.state()).jobs.map((job) => job.error)).toEqual([whole, null]);
    expect((await api.tap())!.stream!.error).toEqual(whole);
    expect((await api.monitors())[0]!.error).toEqual(whole);
  });
  it('is said where the answer is no JSON', async () => {
    const { api } = serverWith(new Response('<html>', { status: 503, statusText: 'Service Unavailable' }));
    const error = await failure(api.state());
    expect(error.status).toBe(503);
    expect(error.fault.text).toBe('The server answered 503 Service Unavailable.');
  });
  it('is that a newer question was asked', async () => {
    const { api } = serverWith(json({ superseded: true }, 409), json({ error: { text: 'conflict' } }, 409));
    const request = { file: 'lobes.toml', set: {}, answer: 'limit' as const, at: [], client: 'c', channel: 'a', sequence: 1 };
    expect((await failure(api.lobes(request))).superseded).toBe(true);
    expect((await failure(api.lobes(request))).superseded).toBe(false);
  });
  it('is that the server was started anew, for what is sent alone', async () => {
    const rejected = () => json({ error: { text: 'load the page again' } }, 403);
    const { api } = serverWith(rejected(), rejected());
    await failure(api.state());
    expect(isOutdated()).toBe(false);
    await failure(api.edit('', 'a', 1));
    expect(isOutdated()).toBe(true);
  });
  it('is that nothing answers', async () => {
    const { api } = serverWith(new TypeError('Failed to fetch'));
    const error = await failure(api.state());
    expect(error.status).toBe(0);
    expect(error.fault.text).toContain('robomill serve');
  });
  it('is not what was given up', async () => {
    const { api, sent } = serverWith(new DOMException('aborted', 'AbortError'));
    const controller = new AbortController();
    const error = await failure(api.state(controller.signal));
    expect(isAborted(error)).toBe(true);
    expect(error).not.toBeInstanceOf(ApiError);
    expect(sent[0]!.options.signal).toBe(controller.signal);
  });
  it('becomes one kind of error', () => {
    expect(asApiError(new Error('x')).fault.text).toBe('x');
    expect(asApiError('y').status).toBe(0);
    const error = asApiError('z');
    expect(asApiError(error)).toBe(error);
  });
});
