// A file as form and text side by side, and the verb that runs it.
import { useState } from 'preact/hooks';
import { useAction, useServe } from './context';
import type { FileKind } from './documents';
import { Editor } from './editor';
import { useEdited, type Edited } from './edited';
import { inFile } from './fields';
import { Form, showsFault } from './form';
import { Button, ErrorBox, FaultText, Labelled, Panel, View } from './pieces';
import { href } from './route';
import { Running } from './running';
import { runOf } from './verbs';

function Conflict({ edited }: { edited: Edited }) {
  return (
    <div class="warnings" role="alert">
      <p>The file was changed by someone else since it was opened here. Nothing was written.</p>
      <div class="buttons">
        <Button act={() => void edited.reload()}>Load their text, drop mine</Button>
        <Button act={() => void edited.overwrite()}>Write mine over theirs</Button>
      </div>
    </div>
  );
}

/** An error of the text that no field of the form shows. */
function TextFault({ edited, path, jump }: { edited: Edited; path: string; jump: () => void }) {
  const fault = edited.check?.error ?? null;
  const line = fault && inFile(fault, path) ? fault.line : null;
  return (
    <div role="status" id="editor-error">
      {fault === null ? (
        edited.check && <p class="good">This file can be read.</p>
      ) : (
        <p class="error">
          {line === null ? <FaultText fault={fault} /> : showsFault(edited.fields, fault, path) ? `Line ${line}: see the form.` : <FaultText fault={{ ...fault, file: null }} />}{' '}
          {line !== null && <Button act={jump}>Go to line {line}</Button>}
        </p>
      )}
    </div>
  );
}

function Sides({ edited, path }: { edited: Edited; path: string }) {
  const [jump, setJump] = useState(0);
  const fault = edited.check?.error ?? null;
  const here = fault && fault.line !== null && inFile(fault, path) ? { line: fault.line, text: fault.text } : null;
  return (
    <>
      <TextFault edited={edited} path={path} jump={() => setJump(jump + 1)} />
      <div class="sides">
        <Form fields={edited.fields} fault={fault} file={path} change={edited.change} />
        <Editor label={`Text of ${path}`} text={edited.text ?? ''} type={edited.type} wrong={here} jump={jump} />
      </div>
    </>
  );
}

interface RunFormProps {
  kind: FileKind;
  path: string;
  save: () => Promise<boolean>;
  dirty: boolean;
  started: (id: number) => void;
}

/** Starts the verb of this kind of file. */
export function RunForm({ kind, path, save, dirty, started }: RunFormProps) {
  const { api, refresh } = useServe();
  const { busy, error, act } = useAction();
  const run = runOf(kind, path);
  const [output, setOutput] = useState<string | null>(null);
  if (!run) return null;
  const to = output ?? run.output;
  const start = async () => {
    if (dirty && !(await save())) return;
    const { id } = await api.run(run.verb, path, to.trim());
    refresh();
    started(id);
  };
  return (
    <div class="buttons run">
      <Labelled label="Results to (empty: nothing is written)">
        <input type="text" value={to} spellcheck={false} autocomplete="off" onInput={({ currentTarget }) => setOutput(currentTarget.value)} />
      </Labelled>
      <Button main act={() => void act(start)} disabled={busy}>
        {dirty ? `Save; ${run.does.toLowerCase()}` : run.does}
      </Button>
      <ErrorBox error={error} />
    </div>
  );
}

export function JobView({ path }: { path: string }) {
  const { api, folder, announce } = useServe();
  const edited = useEdited(api, path);
  const [started, setStarted] = useState<number | null>(null);
  const kind = edited.check?.kind ?? folder?.files.find((file) => file.path === path)?.kind ?? 'other';
  const job = folder?.jobs.find(({ id }) => id === started) ?? null;
  const save = async () => {
    const saved = await edited.save();
    if (saved) announce(`${path} saved`);
    return saved;
  };
  return (
    <View heading={path} lead="Form and text show the same file: what is changed in one stands in the other.">
      <Panel heading="Edit" name="edit">
        <ErrorBox error={edited.error} />
        {edited.conflict && <Conflict edited={edited} />}
        {edited.text === null ? <p class="notice">{edited.error ? 'There is nothing to edit.' : 'The file is loading.'}</p> : <Sides edited={edited} path={path} />}
        <div class="buttons">
          <Button act={() => void save()} disabled={!edited.dirty}>
            Save
          </Button>
          <span class="muted">{edited.dirty ? 'Not saved yet' : edited.text === null ? '' : 'Saved'}</span>
          {kind === 'lobes' && <a href={href('lobes', path)}>Move it live</a>}
          {kind === 'hits' && <a href={href('tap', path)}>Tap test with it</a>}
        </div>
        {edited.text !== null && <RunForm key={`${kind} ${path}`} kind={kind} path={path} save={save} dirty={edited.dirty} started={setStarted} />}
      </Panel>
      {job && <Running key={job.id} job={job} />}
    </View>
  );
}
