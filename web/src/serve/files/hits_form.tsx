// What dropped recordings are asked about, and the hits.toml made of the answers.
import { useState } from 'preact/hooks';
import { Bullets } from '../../parts';
import { fixed } from '../../text';
import { useAction, useServe } from '../context';
import { Button, ErrorBox, Panel, Select, TextBox } from '../pieces';
import { href } from '../route';
import { columnsOf, directionOf, filesOf, firstAnswers, force_units, hitsToml, isVoltage, missingAnswers, needsRate, response_units, sensorUnit, type Answers, type Recording, type ResponseKind, type Role } from './hits_text';

const roles: { value: Role; name: string }[] = [
  { value: 'unused', name: 'not used' },
  { value: 'time', name: 'time' },
  { value: 'force', name: 'force' },
  ...(['x', 'y', 'z', '-x', '-y', '-z'] as const).map((axis) => ({ value: axis, name: `response in ${axis}` })),
];
const directions = ['x', 'y', 'z', '-x', '-y', '-z'].map((axis) => ({ value: axis, name: axis.startsWith('-') ? `${axis} (against the axis)` : axis }));
const kinds = (Object.keys(response_units) as ResponseKind[]).map((kind) => ({ value: kind, name: kind }));
const named = (units: { unit: string }[]) => units.map(({ unit }) => ({ value: unit, name: isVoltage(unit) ? `${unit} (state the sensor)` : unit }));

interface QuestionsProps {
  recordings: Recording[];
  answers: Answers;
  answer: (some: Partial<Answers>) => void;
}

function Columns({ recordings, answers, answer }: QuestionsProps) {
  const { columns } = recordings[0]!.inspection;
  return (
    <fieldset>
      <legend>What each column is</legend>
      {columns.map(({ name, unit }, i) => (
        <Select
          label={`Column ${i + 1}: ${name}${unit ? ` (${unit})` : ''}`}
          value={answers.roles[i]!}
          options={roles}
          choose={(role) => answer({ roles: answers.roles.map((one, k) => (k === i ? (role as Role) : one)) })}
        />
      ))}
    </fieldset>
  );
}

function Directions({ recordings, answers, answer }: QuestionsProps) {
  return (
    <fieldset>
      <legend>Direction of the hammer's force</legend>
      {recordings.map((recording) => (
        <Select
          key={recording.path}
          label={filesOf(recording).join(' + ')}
          value={directionOf(answers, recording)}
          options={directions}
          choose={(direction) => answer({ directions: { ...answers.directions, [recording.path]: direction } })}
        />
      ))}
    </fieldset>
  );
}

function Units({ answers, answer }: QuestionsProps) {
  const { response } = answers;
  const sheet = 'Stands on the calibration sheet.';
  return (
    <fieldset>
      <legend>Units</legend>
      <Select label="The response is a" value={response} options={kinds} choose={(kind) => answer({ response: kind as ResponseKind, response_unit: response_units[kind as ResponseKind][0]!.unit })} />
      <Select label="Unit of the response" value={answers.response_unit} options={named(response_units[response])} choose={(response_unit) => answer({ response_unit })} />
      {isVoltage(answers.response_unit) && (
        <TextBox inputMode="decimal" label={`Sensitivity of the response (mV per ${sensorUnit(response)})`} help={sheet} value={answers.response_mv_per_unit} type={(text) => answer({ response_mv_per_unit: text })} />
      )}
      <Select label="Unit of the force" value={answers.force_unit} options={named(force_units)} choose={(force_unit) => answer({ force_unit })} />
      {isVoltage(answers.force_unit) && <TextBox inputMode="decimal" label="Sensitivity of the hammer (mV per N)" help={sheet} value={answers.force_mv_per_n} type={(text) => answer({ force_mv_per_n: text })} />}
      {needsRate(answers) && <TextBox inputMode="decimal" label="Sampling rate (Hz)" value={answers.sample_rate_hz} type={(text) => answer({ sample_rate_hz: text })} />}
    </fieldset>
  );
}

function rowsText({ inspection: { columns, rows, sample_rate_hz: rate } }: Recording): string {
  const parts = [`${columns.length} columns`, ...(rows === null ? [] : [`${fixed(rows, 0)} rows`]), ...(rate === null ? [] : [`${fixed(rate, 0)} Hz`])];
  return parts.join(', ');
}

/** What was answered, and the file that is made of it. */
export interface HitsAnswers {
  answers: Answers;
  path: string;
  written: { path: string; etag: string } | null;
}

interface HitsFormProps {
  recordings: Recording[]; // with the same columns; more may come
  forms: Map<string, HitsAnswers>; // where it keeps its answers
  taken: string[];
}

export function HitsForm({ recordings, forms, taken }: HitsFormProps) {
  const { api, refresh, announce } = useServe();
  const { busy, error, act } = useAction();
  const columns = columnsOf(recordings[0]!);
  const [form, setForm] = useState<HitsAnswers>(() => forms.get(columns) ?? { answers: firstAnswers(recordings), path: freeName('hits.toml', taken), written: null });
  forms.set(columns, form);
  const { answers, path, written } = form;
  const change = (some: Partial<HitsAnswers>) => setForm((now) => ({ ...now, ...some }));
  const answer = (some: Partial<Answers>) => change({ answers: { ...answers, ...some } });
  const missing = missingAnswers(answers);
  const text = missing.length === 0 ? hitsToml(path, recordings, answers) : '';
  const write = async () => {
    // With more recordings it is written once more, over what this form wrote.
    const { etag } = await api.write(path, text, written?.path === path ? written.etag : null);
    change({ written: { path, etag } });
    announce(`${path} was written`);
    refresh();
  };
  const asked = { recordings, answers, answer };
  return (
    <Panel heading={recordings.length === 1 ? `A recording: ${filesOf(recordings[0]!).join(' + ')}` : `${recordings.length} recordings with the same columns`} name="hits-form">
      <p class="lead">{rowsText(recordings[0]!)}. Are these hammer hits? Then say what robomill cannot know.</p>
      <Bullets texts={[...new Set(recordings.flatMap(({ inspection }) => inspection.questions))]} />
      <div class="questions">
        <Columns {...asked} />
        <Directions {...asked} />
        <Units {...asked} />
      </div>
      {missing.length > 0 && <Bullets texts={missing} />}
      {text !== '' && (
        <details open>
          <summary>What will be written</summary>
          <pre>{text}</pre>
        </details>
      )}
      <div class="buttons">
        <TextBox label="File" value={path} type={(text) => change({ path: text })} />
        <Button main act={() => void act(write)} disabled={busy || text === '' || path.trim() === ''}>
          Write it
        </Button>
        {written !== null && (
          <span>
            <a href={href('job', written.path)}>Open {written.path}</a> · <a href={href('tap', written.path)}>Tap test with it</a>
          </span>
        )}
      </div>
      <ErrorBox error={error} />
    </Panel>
  );
}

/** "hits.toml", or "hits-2.toml" where that is taken. */
export function freeName(name: string, taken: string[]): string {
  const dot = name.lastIndexOf('.') > name.lastIndexOf('/') + 1 ? name.lastIndexOf('.') : name.length;
  for (let i = 1; ; ++i) {
    const free = i === 1 ? name : `${name.slice(0, dot)}-${i}${name.slice(dot)}`;
    if (!taken.includes(free)) return free;
  }
}
