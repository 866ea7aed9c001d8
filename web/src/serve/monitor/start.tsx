// Which recording or stream is to be monitored, and how.
import { useState } from 'preact/hooks';
import { useAction, useServe } from '../context';
import type { FileEntry } from '../documents';
import { ButtonForm, ErrorBox, Labelled, Panel, Select, TextBox } from '../pieces';
import { goTo, href } from '../route';
import { isRecording } from '../verbs';

const stream = 'a stream';
const fastest = 50;

/** Recordings that can be played, of a folder's files. */
export function playable(files: FileEntry[]): FileEntry[] {
  return files.filter((file) => isRecording(file) && !file.path.endsWith('.jsonl'));
}

export function StartMonitor({ path }: { path: string }) {
  const { api, folder, announce } = useServe();
  const { busy, error, act } = useAction();
  const files = folder?.files ?? [];
  const listed = files.filter(({ kind }) => kind === 'monitor').map((file) => file.path);
  const configs = path === '' || listed.includes(path) ? listed : [path, ...listed]; // a job may have its tables
  const recordings = playable(files);
  const [chosenConfig, chooseConfig] = useState(path);
  const [chosenInput, chooseInput] = useState('');
  const [address, setAddress] = useState('');
  const [speed, setSpeed] = useState('1');
  const config = chosenConfig || configs[0] || '';
  const input = chosenInput || recordings[0]?.path || stream;
  const start = async () => {
    const { id } = await api.startMonitor(config, input === stream ? address.trim() : input, input === stream ? 1 : Number(speed));
    announce('The spindle is monitored');
    goTo('monitor', String(id));
  };
  if (folder !== null && configs.length === 0) {
    return (
      <p class="notice">
        The monitor needs a monitor.toml that says how the samples are read. <code>robomill init monitor</code> writes one; then it stands among the <a href={href('files')}>files</a>.
      </p>
    );
  }
  return (
    <Panel heading="Monitor a spindle" name="monitor-start">
      <ButtonForm send={() => void act(start)}>
        <Select label="Settings" value={config} options={configs} choose={chooseConfig} />
        <Select label="Samples from" value={input} options={[...recordings.map((file) => file.path), { value: stream, name: 'a stream of a broker (MQTT)' }]} choose={chooseInput} />
        {input === stream ? (
          <TextBox label="Address (empty: mqtt.topic of the settings)" value={address} placeholder="mqtt://HOST/TOPIC" type={setAddress} />
        ) : (
          <Labelled label="Speed, times its own">
            <input type="number" min={1} max={fastest} step="any" required value={speed} onInput={({ currentTarget }) => setSpeed(currentTarget.value)} />
          </Labelled>
        )}
        <button type="submit" class="main" disabled={busy || config === ''}>
          Start
        </button>
      </ButtonForm>
      <ErrorBox error={error} />
    </Panel>
  );
}
