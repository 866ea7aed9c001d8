// The stream that hits come from: how it stands, and in which direction they go.
import { Bullets } from '../../parts';
import { significant } from '../../text';
import { useAction, useServe } from '../context';
import type { Tap, TapStream } from '../documents';
import { ErrorBox, FaultLine, Panel, Select } from '../pieces';

export const directions = ['x', '-x', 'y', '-y', 'z', '-z'];

/** What to do now. */
export function streamText({ status, recording, address, level_n }: TapStream): string {
  if (status === 'connecting') return `Connecting to ${address}.`;
  if (status === 'silent') return `No samples come from ${address}.`;
  if (status === 'failed') return 'The stream has ended.';
  if (recording) return 'A hit is recorded: keep still.';
  return level_n === null ? 'Samples come; wait a moment.' : `Ready: hit now. A force beyond ${significant(level_n)} N begins a record.`;
}

function remarks({ discarded, notices }: TapStream): string[] {
  const times = (count: number) => (count === 1 ? '' : ` (${count} times)`);
  return [...discarded.map(({ reason, count }) => `Discarded: ${reason}${times(count)}`), ...notices.map(({ what, message, count }) => `${what}: ${message}${times(count)}`)];
}

export function StreamPanel({ tap, stream }: { tap: Tap; stream: TapStream }) {
  const { api, tookTap, announce } = useServe();
  const { busy, error, act } = useAction();
  const now = tap.force_direction ?? 'x';
  const turn = (direction: string) =>
    void act(async () => {
      tookTap(await api.turnTap(direction));
      announce(`Hits are now in ${direction}`);
    });
  return (
    <Panel heading="Stream" name="tap-stream">
      <p role="status" aria-live="polite" class={stream.status === 'receiving' ? 'good' : 'notice'}>
        {streamText(stream)}
      </p>
      {stream.error && <FaultLine fault={stream.error} />}
      <div class="buttons" aria-busy={busy}>
        <Select label="Direction of the hits that come" value={now} options={[...new Set([now, ...directions])]} choose={turn} />
      </div>
      <ErrorBox error={error} />
      <Bullets texts={remarks(stream)} />
    </Panel>
  );
}
