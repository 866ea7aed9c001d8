// The keys of a file as a form.
import { useState } from 'preact/hooks';
import type { Fault, Field, Value } from './documents';
import { groupFields, isAt, nameOf, parseValue, valueText, type FieldGroup } from './fields';
import { faultText } from './pieces';

type Change = (key: string, value: Value) => Promise<void>;

interface ControlProps {
  field: Field;
  id: string;
  wrong: boolean;
  describedBy: string | undefined;
  change: Change;
  complain: (text: string | null) => void;
}

/** Keeps what is typed until it has gone into the text. */
function Typed({ field, id, wrong, describedBy, change, complain }: ControlProps) {
  const [draft, setDraft] = useState<string | null>(null);
  const { key, value } = field;
  const commit = async (typed: string) => {
    const parsed = parseValue(typed, value);
    complain('wrong' in parsed ? parsed.wrong : null);
    if ('wrong' in parsed) return;
    await change(key, parsed.value);
    setDraft(null);
  };
  return (
    <input
      id={id}
      type="text"
      inputMode={typeof value === 'number' ? 'decimal' : undefined}
      autocomplete="off"
      spellcheck={false}
      aria-invalid={wrong}
      aria-describedby={describedBy}
      value={draft ?? valueText(value)}
      onInput={({ currentTarget }) => setDraft(currentTarget.value)}
      onChange={({ currentTarget }) => void commit(currentTarget.value)}
    />
  );
}

function FieldRow({ field, fault, change }: { field: Field; fault: Fault | null; change: Change }) {
  const [complaint, complain] = useState<string | null>(null);
  const { key, value, comment } = field;
  const { name, unit } = nameOf(key);
  const id = `field-${key}`;
  const wrong = complaint ?? (fault && faultText(fault));
  const describedBy = [wrong !== null && `${id}-error`, comment !== null && `${id}-help`].filter(Boolean).join(' ') || undefined;
  const control = { field, id, wrong: wrong !== null, describedBy, change, complain };
  return (
    <div class="field" data-key={key}>
      <label for={id}>
        {name}
        {unit && <span class="unit">, {unit.words}</span>}
      </label>
      {typeof value === 'boolean' ? (
        <input id={id} type="checkbox" checked={value} aria-describedby={describedBy} onChange={({ currentTarget }) => void change(key, currentTarget.checked)} />
      ) : (
        <Typed {...control} />
      )}
      {wrong !== null && (
        <p class="error" id={`${id}-error`}>
          {wrong}
        </p>
      )}
      {comment !== null && <small id={`${id}-help`}>{comment}</small>}
    </div>
  );
}

function Group({ group, fault, file, change }: { group: FieldGroup; fault: Fault | null; file: string; change: Change }) {
  return (
    <fieldset>
      <legend>{group.heading}</legend>
      {group.fields.map((field) => (
        <FieldRow key={field.key} field={field} fault={isAt(fault, field.key, file) ? fault : null} change={change} />
      ))}
    </fieldset>
  );
}

export function Form({ fields, fault, file, change }: { fields: Field[]; fault: Fault | null; file: string; change: Change }) {
  return (
    <form class="fields" onSubmit={(event) => event.preventDefault()}>
      {groupFields(fields).map((group) => (
        <Group key={group.table} group={group} fault={fault} file={file} change={change} />
      ))}
    </form>
  );
}

/** Whether the form shows the error at one of its fields. */
export function showsFault(fields: Field[], fault: Fault | null, file: string): boolean {
  return fields.some(({ key }) => isAt(fault, key, file));
}
