// A file as form and text side by side, and the verbs that run it.
import { useState } from 'preact/hooks';
import { useServe } from '../context';
import { Button, ErrorBox, FaultText, Panel, View } from '../pieces';
import { href } from '../route';
import { RunForm } from '../jobs/run_form';
import { Running } from '../jobs/running';
import { isEditable, kindNames, runsOf } from '../verbs';
import { Editor } from './editor';
import { useEdited } from './edited';
import type { EditedFile } from './edited_file';
import { inFile } from './fields';
import { Form, showsFault } from './form';

function Conflict({ edited }: { edited: EditedFile }) {
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
function TextFault({ edited, path, jump }: { edited: EditedFile; path: string; jump: () => void }) {
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

function Sides({ edited, path }: { edited: EditedFile; path: string }) {
  const [jump, setJump] = useState(0);
  const fault = edited.check?.error ?? null;
  const here = fault && fault.line !== null && inFile(fault, path) ? { line: fault.line, text: fault.text } : null;
  return (
    <>
      <TextFault edited={edited} path={path} jump={() => setJump(jump + 1)} />
      <div class="sides">
        <Form fields={edited.fields} fault={fault} file={path} typing={edited} />
        <Editor label={`Text of ${path}`} text={edited.text ?? ''} type={(text) => edited.type(text)} wrong={here} jump={jump} />
      </div>
    </>
  );
}

/** A file that is run, but not edited here. */
function RunView({ path }: { path: string }) {
  const { folder, verbs } = useServe();
  const [started, setStarted] = useState<number | null>(null);
  const file = folder?.files.find((one) => one.path === path);
  const job = folder?.jobs.find(({ id }) => id === started) ?? null;
  const runs = file ? runsOf(verbs, file.kind) : [];
  return (
    <View heading={path} lead={file ? `Listed under ${kindNames[file.kind]}.` : ''}>
      {folder && !file && <p class="notice">There is no such file in the folder.</p>}
      {runs.length > 0 && (
        <Panel heading="Run" name="run-form">
          <RunForm key={path} kind={file!.kind} path={path} save={async () => true} dirty={false} started={setStarted} />
        </Panel>
      )}
      {file && runs.length === 0 && <p class="notice">There is nothing to run on it.</p>}
      {job && <Running key={job.id} job={job} />}
    </View>
  );
}

export function JobView({ path }: { path: string }) {
  return isEditable(path) ? <EditView path={path} /> : <RunView path={path} />;
}

function EditView({ path }: { path: string }) {
  const { api, folder, verbs, announce } = useServe();
  const edited = useEdited(api, path);
  const [started, setStarted] = useState<number | null>(null);
  const kind = edited.check?.kind ?? folder?.files.find((file) => file.path === path)?.kind ?? 'other';
  const job = folder?.jobs.find(({ id }) => id === started) ?? null;
  const save = async () => {
    const { dirty } = edited;
    const saved = await edited.save();
    if (saved && dirty) announce(`${path} saved`);
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
          {(kind === 'lobes' || kind === 'job') && <a href={href('lobes', path)}>Live lobes</a>}
          {kind === 'hits' && <a href={href('tap', path)}>Tap test with it</a>}
        </div>
      </Panel>
      {edited.text !== null && folder && runsOf(verbs, kind).length > 0 && (
        <Panel heading="Run" name="run-form">
          <RunForm key={`${kind} ${path}`} kind={kind} path={path} save={save} dirty={edited.dirty} started={setStarted} />
        </Panel>
      )}
      {job && <Running key={job.id} job={job} />}
    </View>
  );
}
