// What the sliders changed, written into the file after it was shown.
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks';
import { Table } from '../../parts';
import type { Api } from '../api';
import { focusBack } from '../confirm';
import { useAction, useServe } from '../context';
import { labelOf, valueText } from '../files/fields';
import { Button, ErrorBox, Panel } from '../pieces';
import type { Change } from './settings';

/** One key after the other, over the state of the file that was read. */
export async function writeChanges(api: Api, path: string, changes: Change[]): Promise<void> {
  const { text: before, etag } = await api.file(path);
  let text = before;
  for (const { key, after } of changes) ({ text } = await api.edit(text, key, after));
  await api.write(path, text, etag);
}

export function WriteBack({ path, changes, written }: { path: string; changes: Change[]; written: () => void }) {
  const { api, announce } = useServe();
  const { busy, error, act } = useAction();
  const [open, setOpen] = useState(false);
  const panel = useRef<HTMLDivElement>(null);
  const opener = useRef<HTMLButtonElement>(null);
  const pressed = useRef(false); // what had the focus is replaced
  const show = (now: boolean) => {
    pressed.current = true;
    setOpen(now);
  };
  useLayoutEffect(() => {
    if (!pressed.current) return;
    pressed.current = false;
    if (open) panel.current?.querySelector('button')?.focus();
    else focusBack(opener.current);
  }, [open]);
  useEffect(() => {
    if (changes.length === 0) setOpen(false); // they were undone
  }, [changes.length]);
  const write = async () => {
    await writeChanges(api, path, changes);
    written();
    show(false);
    announce(`${path} was written`);
  };
  if (!open || changes.length === 0) {
    return (
      <button ref={opener} type="button" onClick={() => show(true)} disabled={changes.length === 0}>
        Write into {path}…
      </button>
    );
  }
  return (
    <Panel heading={`Changes of ${path}`} name="changes">
      <Table
        caption="Changes"
        quiet
        rows={changes}
        columns={[
          { heading: 'Key', cell: ({ key }) => <code>{key}</code> },
          { heading: 'Meaning', cell: ({ key }) => labelOf(key) },
          { heading: 'In the file', number: true, cell: ({ before }) => valueText(before) },
          { heading: 'New', number: true, cell: ({ after }) => valueText(after) },
        ]}
      />
      <div class="buttons" ref={panel}>
        <Button main act={() => void act(write)} disabled={busy}>
          Write
        </Button>
        <Button act={() => show(false)}>Leave the file as it is</Button>
      </div>
      <ErrorBox error={error} />
    </Panel>
  );
}
