// The keys of a file as a form.
import type { Fault, Field } from '../documents';
import { faultText } from '../pieces';
import type { EditedFile } from './edited_file';
import { groupFields, isAt, nameOf, valueText, type FieldGroup } from './fields';

type Typing = Pick<EditedFile, 'entries' | 'enter' | 'commit' | 'leave'>;

function FieldRow({ field, fault, typing }: { field: Field; fault: Fault | null; typing: Typing }) {
  const { key, value, comment } = field;
  const { name, unit } = nameOf(key);
  const entry = typing.entries.get(key);
  const typed = entry?.typed ?? valueText(value);
  const id = `field-${key}`;
  const wrong = entry?.wrong ?? (fault && faultText(fault));
  const describedBy = [wrong !== null && `${id}-error`, comment !== null && `${id}-help`].filter(Boolean).join(' ') || undefined;
  const control = { id, 'aria-invalid': wrong !== null, 'aria-describedby': describedBy };
  return (
    <div class="field" data-key={key}>
      <label for={id}>
        {name}
        {unit && <span class="unit">, {unit.words}</span>}
      </label>
      {typeof value === 'boolean' ? (
        <input {...control} type="checkbox" checked={typed === 'true'} onChange={({ currentTarget }) => typing.commit(field, String(currentTarget.checked))} />
      ) : (
        <input
          {...control}
          type="text"
          inputMode={typeof value === 'number' ? 'decimal' : undefined}
          autocomplete="off"
          spellcheck={false}
          value={typed}
          onInput={({ currentTarget }) => typing.enter(key, currentTarget.value)}
          onChange={({ currentTarget }) => typing.commit(field, currentTarget.value)}
          onBlur={() => typing.leave(field)}
        />
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

function Group({ group, fault, file, typing }: { group: FieldGroup; fault: Fault | null; file: string; typing: Typing }) {
  return (
    <fieldset>
      <legend>{group.heading}</legend>
      {group.fields.map((field) => (
        <FieldRow key={field.key} field={field} fault={isAt(fault, field.key, file) ? fault : null} typing={typing} />
      ))}
    </fieldset>
  );
}

export function Form({ fields, fault, file, typing }: { fields: Field[]; fault: Fault | null; file: string; typing: Typing }) {
  return (
    <form class="fields" onSubmit={(event) => event.preventDefault()}>
      {groupFields(fields).map((group) => (
        <Group key={group.table} group={group} fault={fault} file={file} typing={typing} />
      ))}
    </form>
  );
}

/** Whether the form shows the error at one of its fields. */
export function showsFault(fields: Field[], fault: Fault | null, file: string): boolean {
  return fields.some(({ key }) => isAt(fault, key, file));
}
