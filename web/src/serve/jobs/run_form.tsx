// Starts a verb on a file: what it reads, its options, where the results go.
import { useEffect, useRef, useState } from 'preact/hooks';
import { useAction, useServe } from '../context';
import type { FileEntry, FileKind, VerbOption } from '../documents';
import { ErrorBox, Select, TextBox } from '../pieces';
import { filesOf, proposedOutput, runsOf, type Run } from '../verbs';
import { jobRequest, wrongOptions, type Typed } from './run_options';

interface FilesProps {
  legend: string;
  files: FileEntry[];
  chosen: string[];
  choose: (paths: string[]) => void;
  id: string;
  wrong: string | null;
}

/** Several files, each with a box to tick. */
function FileBoxes({ legend, files, chosen, choose, id, wrong }: FilesProps) {
  return (
    <fieldset class="files-to-choose" aria-describedby={wrong === null ? undefined : `${id}-error`}>
      <legend>{legend}</legend>
      {files.length === 0 && <p class="notice">The folder has none.</p>}
      {files.map(({ path }) => (
        <label class="tick">
          <input type="checkbox" checked={chosen.includes(path)} onChange={({ currentTarget }) => choose(currentTarget.checked ? [...chosen, path] : chosen.filter((one) => one !== path))} /> {path}
        </label>
      ))}
      <Wrong id={id} text={wrong} />
    </fieldset>
  );
}

function Wrong({ id, text }: { id: string; text: string | null }) {
  if (text === null) return null;
  return (
    <p class="error" id={`${id}-error`}>
      {text}
    </p>
  );
}

interface OptionProps {
  option: VerbOption;
  typed: Typed[string] | undefined;
  type: (value: Typed[string]) => void;
  files: FileEntry[];
  id: string;
  wrong: string | null; // not said before the first try
}

function OptionControl({ option, typed, type, files, id, wrong }: OptionProps) {
  const { takes, does, words = [], kinds = [] } = option;
  if (takes === 'files') return <FileBoxes legend={does} files={filesOf(files, kinds)} chosen={Array.isArray(typed) ? typed : []} choose={type} id={id} wrong={wrong} />;
  if (takes === 'flag') {
    return (
      <label class="tick">
        <input type="checkbox" checked={typed === true} onChange={({ currentTarget }) => type(currentTarget.checked)} /> {does}
      </label>
    );
  }
  const text = typeof typed === 'string' ? typed : '';
  const names = takes === 'word' ? words : takes === 'file' ? filesOf(files, kinds).map(({ path }) => path) : null;
  const control = { id, 'aria-required': option.required, 'aria-invalid': wrong !== null, 'aria-describedby': wrong === null ? undefined : `${id}-error`, value: text };
  return (
    <div class="labelled">
      <label for={id}>{does}</label>
      {names ? (
        <select {...control} onChange={({ currentTarget }) => type(currentTarget.value)}>
          {['', ...names].map((name) => (
            <option value={name} selected={name === text}>
              {name === '' ? (option.required ? 'choose' : 'not given') : name}
            </option>
          ))}
        </select>
      ) : (
        <input type="text" autocomplete="off" spellcheck={false} {...control} onInput={({ currentTarget }) => type(currentTarget.value)} />
      )}
      <Wrong id={id} text={wrong} />
    </div>
  );
}

interface RunFormProps {
  kind: FileKind;
  path: string;
  save: () => Promise<boolean>;
  dirty: boolean;
  started: (id: number) => void;
}

/** What one of these options is before anything was chosen: the file itself, or the only one that there is. */
function firstTyped({ verb, as }: Run, path: string, files: FileEntry[]): Typed {
  const typed: Typed = {};
  for (const { name, takes, required, kinds = [] } of verb.options) {
    if (name === as?.name) typed[name] = takes === 'files' ? [path] : path;
    else if (required && takes === 'file') {
      const some = filesOf(files, kinds);
      if (some.length === 1) typed[name] = some[0]!.path;
    }
  }
  return typed;
}

function firstInputs({ verb, as }: Run, path: string, files: FileEntry[]): string[] {
  if (as === null) return [path];
  const some = filesOf(files, verb.inputs);
  return some.length === 1 ? [some[0]!.path] : [];
}

function OneRun({ run, path, save, dirty, started }: Omit<RunFormProps, 'kind'> & { run: Run }) {
  const { api, folder, refresh } = useServe();
  const { busy, error, act } = useAction();
  const files = folder?.files ?? [];
  const { verb, as } = run;
  const [inputs, setInputs] = useState(() => firstInputs(run, path, files));
  const [typed, setTyped] = useState<Typed>(() => firstTyped(run, path, files));
  const [output, setOutput] = useState<string | null>(null);
  const [tries, setTries] = useState(0);
  const form = useRef<HTMLFormElement>(null);
  const open = useRef(false); // the options: they stay open once one was wrong
  const tried = tries > 0;
  const to = output ?? proposedOutput(verb, inputs[0] ?? path);
  const wrong = wrongOptions(verb, typed);
  // What is missing takes the focus, out of options that were closed by hand, too.
  useEffect(() => {
    const missing = form.current?.querySelector<HTMLElement>('[aria-invalid="true"], fieldset[aria-describedby] input');
    missing?.closest('details')?.setAttribute('open', '');
    missing?.focus();
  }, [tries]);
  const start = async () => {
    setTries(tries + 1);
    if (inputs.length === 0 || Object.keys(wrong).length > 0) return;
    if (!(await save())) throw new Error('Not started: the file could not be saved. The reason stands above.'); // also where nothing seems to be: an edit may be under way
    const { id } = await api.run(jobRequest(verb, inputs, to, typed));
    refresh();
    started(id);
  };
  const control = (option: VerbOption) => (
    <OptionControl
      key={option.name}
      option={option}
      typed={typed[option.name]}
      type={(value) => setTyped({ ...typed, [option.name]: value })}
      files={files}
      id={`run-${option.name}`}
      wrong={tried || (!option.required && typed[option.name]) ? (wrong[option.name] ?? null) : null}
    />
  );
  const [needed, others] = [verb.options.filter(({ required }) => required), verb.options.filter(({ required }) => !required)];
  open.current ||= others.some(({ name }) => wrong[name] !== undefined);
  const noInput = tried && inputs.length === 0 ? 'Needed.' : null;
  return (
    <form ref={form} onSubmit={(event) => (event.preventDefault(), void act(start))}>
      <div class="questions">
        {verb.several && <FileBoxes legend="Files" files={withFile(filesOf(files, verb.inputs), path, verb.inputs[0]!)} chosen={inputs} choose={setInputs} id="run-inputs" wrong={noInput} />}
        {!verb.several && as !== null && (
          <OptionControl
            option={{ name: 'input', does: 'File that it reads', takes: 'file', required: true, kinds: verb.inputs }}
            typed={inputs[0]}
            type={(one) => setInputs(one === '' ? [] : [one as string])}
            files={files}
            id="run-input"
            wrong={noInput}
          />
        )}
        {needed.map(control)}
      </div>
      {others.length > 0 && (
        <details open={open.current || undefined}>
          <summary>Options</summary>
          <div class="questions">{others.map(control)}</div>
        </details>
      )}
      <div class="buttons run">
        <TextBox label="Results to (empty: nothing is written)" value={to} type={setOutput} />
        <button type="submit" class="main" disabled={busy}>
          {dirty ? `Save; ${verb.does.charAt(0).toLowerCase()}${verb.does.slice(1)}` : verb.does}
        </button>
        {files.some((file) => file.path === to.trim()) && <span class="muted">It replaces {to.trim()}</span>}
      </div>
      <ErrorBox error={error} />
    </form>
  );
}

/** With the file itself, which may not be listed. */
function withFile(files: FileEntry[], path: string, kind: FileKind): FileEntry[] {
  return files.some((file) => file.path === path) ? files : [{ path, kind, bytes: 0, modified: '' }, ...files];
}

/** What can be run on a file of this kind, and the form that does so; nothing where there is no verb. */
export function RunForm({ kind, path, ...rest }: RunFormProps) {
  const { verbs } = useServe();
  const [chosen, choose] = useState(0);
  const runs = runsOf(verbs, kind);
  const run = runs[chosen] ?? runs[0];
  if (!run) return null;
  return (
    <div class="run-form">
      {runs.length > 1 && (
        <Select label="What to do" value={String(chosen)} options={runs.map(({ verb }, i) => ({ value: String(i), name: `${verb.does} (${verb.verb})` }))} choose={(value) => choose(Number(value))} />
      )}
      <OneRun key={run.verb.verb} run={run} path={path} {...rest} />
    </div>
  );
}
