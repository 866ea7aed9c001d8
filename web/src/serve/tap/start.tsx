// Where the hits of a tap test come from.
import { useState } from 'preact/hooks';
import { Bullets } from '../../parts';
import { useAction, useServe } from '../context';
import type { TapRequest } from '../documents';
import { ButtonForm, ErrorBox, Labelled, Panel, Select, TextBox } from '../pieces';
import { directions } from './stream';

const sources = [
  { value: 'files', name: 'files that appear in a folder' },
  { value: 'stream', name: 'a stream of a broker (MQTT)' },
];

interface Form {
  hits: string;
  source: string;
  watch: string;
  stream: string;
  direction: string;
  level: string;
  wanted: string;
}

/** What is asked for: fields of the other source are left out. */
export function requestOf({ hits, source, watch, stream, direction, level, wanted }: Form): TapRequest {
  const common = { hits, wanted: Number(wanted) || 0 };
  if (source === 'files') return { ...common, watch: watch.trim() };
  return { ...common, stream: stream.trim(), force_direction: direction, trigger_level_n: Number(level) || 0 };
}

const remarks: Record<string, string[]> = {
  files: ['Each file that appears there is one hit.'],
  stream: [
    'A force beyond the trigger level begins a record; its length is that of frequency_resolution_hz in the settings, or 1 s.',
    'Channels have no names in a stream: names in the settings stand for them in their order, force first; or write their numbers.',
  ],
};
const always = 'A hit that is double, overloaded or too weak is rejected, with the reason.';

export function Start({ path }: { path: string }) {
  const { api, folder, tookTap, announce } = useServe();
  const { busy, error, act } = useAction();
  const files = (folder?.files ?? []).filter(({ kind }) => kind === 'hits');
  const [form, setForm] = useState<Form>({ hits: path, source: 'files', watch: '', stream: '', direction: '', level: '', wanted: '' });
  const set = (key: keyof Form) => (value: string) => setForm((now) => ({ ...now, [key]: value }));
  const typed = (key: keyof Form) => ({ value: form[key], onInput: ({ currentTarget }: { currentTarget: HTMLInputElement }) => set(key)(currentTarget.value) });
  const hits = form.hits || files[0]?.path || '';
  const start = async () => {
    tookTap((await api.startTap(requestOf({ ...form, hits }))).state);
    announce('The tap test has begun');
  };
  if (files.length === 0) return <p class="notice">A tap test needs a hits.toml with the columns and sensors of your recordings. Drop one of them on the page: robomill asks and writes it.</p>;
  return (
    <Panel heading="Begin" name="tap-start">
      <ButtonForm send={() => void act(start)}>
        <Select label="Settings" value={hits} options={files.map((file) => file.path)} choose={set('hits')} />
        <Select label="Hits from" value={form.source} options={sources} choose={set('source')} />
        {form.source === 'files' ? (
          <TextBox label="Folder to watch (empty: that of the settings)" value={form.watch} type={set('watch')} />
        ) : (
          <>
            <TextBox label="Address" required placeholder="mqtt://HOST/TOPIC" value={form.stream} type={set('stream')} />
            <Select label="Direction of the hits" value={form.direction} options={[{ value: '', name: 'that of the settings' }, ...directions]} choose={set('direction')} />
            <Labelled label="Trigger level in N (empty: from the noise)">
              <input type="number" min={0} step="any" {...typed('level')} />
            </Labelled>
          </>
        )}
        <Labelled label="Good hits (empty: five a direction)">
          <input type="number" min={1} max={200} step={1} {...typed('wanted')} />
        </Labelled>
        <button type="submit" class="main" disabled={busy || hits === ''}>
          Start
        </button>
      </ButtonForm>
      <Bullets texts={[...(remarks[form.source] ?? []), always]} />
      <ErrorBox error={error} />
    </Panel>
  );
}
