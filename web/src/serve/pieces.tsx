// What the views are made of.
import type { ComponentChildren } from 'preact';
import type { ApiError } from './api';
import { reloadPage } from './files/drafts';
import type { Fault } from './documents';
import { useOutdated } from './outdated';
import { isEditable } from './verbs';
import { href } from './route';

interface ViewProps {
  heading: string;
  lead: string;
  children: ComponentChildren;
}

function Outdated() {
  if (!useOutdated()) return null;
  return (
    <div class="warnings" role="alert">
      <p>The server was started anew since this page was loaded, and takes nothing from it. Texts that are not saved are kept.</p>
      <Button act={reloadPage}>Load the page again</Button>
    </div>
  );
}

/** A view: its heading takes the focus when it opens. */
export function View({ heading, lead, children }: ViewProps) {
  return (
    <>
      <h1 tabIndex={-1}>{heading}</h1>
      <Outdated />
      {lead !== '' && <p class="lead">{lead}</p>}
      {children}
    </>
  );
}

export function Panel({ heading, children, name }: { heading: string; children: ComponentChildren; name?: string }) {
  return (
    <section aria-label={heading} data-panel={name}>
      <h2>{heading}</h2>
      {children}
    </section>
  );
}

interface ButtonProps {
  act: () => void;
  main?: boolean; // what one came for
  disabled?: boolean;
  label?: string; // where the words on it do not say enough
  children: ComponentChildren;
}

export function Button({ act, main, disabled, label, children }: ButtonProps) {
  return (
    <button type="button" class={main ? 'main' : undefined} disabled={disabled} aria-label={label} onClick={act}>
      {children}
    </button>
  );
}

/** The message, and the hint where it does not stand in it. */
export function faultText({ text, hint }: Fault): string {
  if (!hint || text.includes(hint)) return text;
  return `${text}${/[.?!]$/.test(text) ? '' : '.'} ${hint}`;
}

/** What was wrong; names the file where it is another than the one that is shown. */
export function FaultText({ fault }: { fault: Fault }) {
  const { file } = fault;
  return (
    <>
      {faultText(fault)}
      {file && isEditable(file) && !file.startsWith('/') && (
        <>
          {' '}
          <a href={href('job', file)}>Open {file}</a>
        </>
      )}
    </>
  );
}

/** The same as a paragraph. */
export function FaultLine({ fault, alert }: { fault: Fault; alert?: boolean }) {
  return (
    <p class="error" role={alert ? 'alert' : undefined}>
      <FaultText fault={fault} />
    </p>
  );
}

export function ErrorBox({ error }: { error: ApiError | null }) {
  return <div role="alert">{error && <FaultLine fault={error.fault} />}</div>;
}

/** A row of controls; what is done when it is sent. */
export function ButtonForm({ send, children }: { send: () => void; children: ComponentChildren }) {
  return (
    <form class="buttons" onSubmit={(event) => (event.preventDefault(), send())}>
      {children}
    </form>
  );
}

/** A labelled control in a column of such. */
export function Labelled({ label, children, help }: { label: string; children: ComponentChildren; help?: ComponentChildren | undefined }) {
  return (
    <label class="labelled">
      <span>{label}</span>
      {children}
      {help !== undefined && <small>{help}</small>}
    </label>
  );
}

interface TextBoxProps {
  inputMode?: 'decimal';
  placeholder?: string;
  required?: boolean;
  label: string;
  help?: string;
  value: string;
  type: (text: string) => void;
}

/** A labelled line of text. */
export function TextBox({ label, help, type, ...input }: TextBoxProps) {
  return (
    <Labelled label={label} help={help}>
      <input type="text" spellcheck={false} autocomplete="off" {...input} onInput={({ currentTarget }) => type(currentTarget.value)} />
    </Labelled>
  );
}

interface SelectProps {
  label: string;
  value: string;
  options: readonly (string | { value: string; name: string })[]; // a text: its own name
  choose: (value: string) => void;
  quiet?: boolean; // the label is only for who cannot see the heading above it
}

export function Select({ label, value, options, choose, quiet }: SelectProps) {
  const control = (
    <select aria-label={quiet ? label : undefined} value={value} onChange={({ currentTarget }) => choose(currentTarget.value)}>
      {options
        .map((option) => (typeof option === 'string' ? { value: option, name: option } : option))
        .map((option) => (
          <option value={option.value} selected={option.value === value}>
            {option.name}
          </option>
        ))}
    </select>
  );
  return quiet ? control : <Labelled label={label}>{control}</Labelled>;
}

/** "1.2 MB". */
export function bytesText(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  const [size, unit] = bytes < 1e6 ? [bytes / 1e3, 'kB'] : [bytes / 1e6, 'MB'];
  return `${size < 10 ? size.toFixed(1) : size.toFixed(0)} ${unit}`;
}

/** A time of the server, as it is written here. */
export function timeText(time: string): string {
  const date = new Date(time);
  return Number.isNaN(date.getTime()) ? time : date.toLocaleString(undefined, { dateStyle: 'medium', timeStyle: 'short' });
}
