// A tap test written into the folder, on the user's button alone.
import { useState } from 'preact/hooks';
import { useAction, useServe } from '../context';
import type { Tap } from '../documents';
import { Button, ButtonForm, ErrorBox, Panel, TextBox } from '../pieces';

/** Beside the settings. */
export function besideSettings(hits: string, name: string): string {
  return hits.slice(0, hits.lastIndexOf('/') + 1) + name;
}

/** Names the accepted hits of a test. */
export function acceptedOf({ id, taken }: Pick<Tap, 'id' | 'taken'>): string {
  return [id, ...taken.filter(({ accepted }) => accepted).map(({ number }) => number)].join();
}

/** What would be lost with the test, in words; null: nothing. `saved`: acceptedOf it when it was saved last. */
export function unsavedText(tap: Pick<Tap, 'id' | 'taken'>, saved: string | null): string | null {
  const count = tap.taken.filter(({ accepted }) => accepted).length;
  if (count === 0 || acceptedOf(tap) === saved) return null;
  return `${count === 1 ? 'The accepted hit is' : `The ${count} accepted hits are`} not saved and will be lost.`;
}

/** `wrote` gets acceptedOf what was saved. */
export function SavePanel({ tap, wrote }: { tap: Tap; wrote: (accepted: string) => void }) {
  const { api, announce, refresh } = useServe();
  const { busy, error, act, clear } = useAction();
  const [path, setPath] = useState(besideSettings(tap.hits, 'tip.uff'));
  const [saved, setSaved] = useState<string[]>([]);
  const save = (replace: boolean) =>
    void act(async () => {
      setSaved([]);
      const accepted = acceptedOf(tap);
      const { files } = await api.saveTap(path.trim(), replace);
      setSaved(files);
      wrote(accepted);
      announce(`Saved ${files.join(', ')}`);
      refresh();
    });
  const write = (to: string) => {
    setPath(to);
    setSaved([]);
    clear();
  };
  return (
    <Panel heading="Save" name="tap-save">
      <ButtonForm send={() => save(false)}>
        <TextBox label="File" help=".uff, .csv, .mat, .json: the frequency responses; .toml: the hits themselves, for robomill frf" value={path} required type={write} />
        <button type="submit" disabled={busy || tap.good === 0}>
          Save
        </button>
        {error?.status === 409 && (
          <Button act={() => save(true)} disabled={busy} label={`Replace ${path}`}>
            Replace
          </Button>
        )}
      </ButtonForm>
      <ErrorBox error={error} />
      {saved.length > 0 && <p class="good">Saved {saved.join(', ')}.</p>}
    </Panel>
  );
}
