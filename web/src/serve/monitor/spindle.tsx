// One spindle that is monitored: what it says now, its spectrogram, and its history.
import { useEffect, useMemo, useState } from 'preact/hooks';
import { duration, inputFaultText, noSpeedText, reasonText } from '../../monitor_views';
import { Facts, KeyFigures, Table, WarningBox, type KeyFigure } from '../../parts';
import { Choice } from '../../plot';
import { AssumedBox } from '../../sections/assumed';
import { Why } from '../../sections/why';
import { dash, fixed, modeName, significant } from '../../text';
import type { Fact } from '../../documents';
import { useAnswer, useServe } from '../context';
import { ErrorBox, FaultLine, Panel, Select } from '../pieces';
import { LiveSpectrogram } from './canvas';
import type { MonitorFrame, MonitorRow, MonitorSession, MonitorSummary } from './documents';
import type { MonitorFeed } from './feed';
import { FrameRing } from './ring';
import { beganText, chatterText, highestChoices, highestFor, isOver, lastedText, rowNote, rowState, stateText, statusText, timeText, withRows } from './text';

export function StateBadge({ summary }: { summary: Pick<MonitorSummary, 'status' | 'frame'> }) {
  const status = statusText(summary);
  const { frame } = summary;
  if (status !== null || frame === null) return <span class="state-badge over">{status}</span>;
  return <span class={`state-badge ${frame.state}`}>{stateText(frame)}</span>;
}

function keyFigures(frame: MonitorFrame): KeyFigure[] {
  const speed = (label: string, rpm: number | null, note = ''): KeyFigure => ({
    label,
    value: rpm === null ? dash : fixed(rpm, 0),
    unit: 'rpm',
    note,
    state: rpm === null ? 'unknown' : undefined,
  });
  const chatters = frame.chatter_frequency_hz !== null;
  return [
    speed('Spindle speed', frame.spindle_speed_rpm),
    speed('Suggested speed', frame.suggested_spindle_speed_rpm, noSpeedText(frame.no_speed)),
    { label: 'Chatter at', value: chatters ? fixed(frame.chatter_frequency_hz, 1) : dash, unit: 'Hz', note: modeName(frame), state: chatters ? undefined : 'unknown' },
    { label: 'Score', value: significant(frame.score), unit: `of ${significant(frame.threshold)}`, state: frame.score === null ? 'unknown' : undefined },
  ];
}

/** What went by, and what was lost. */
export function factsOf(summary: MonitorSummary): Fact[] {
  const { frame } = summary;
  const facts: Fact[] = [{ label: 'Samples', value: `${summary.channels.join(', ')} at ${fixed(summary.sample_rate_hz, 0)} Hz` }];
  if (frame === null) return facts;
  facts.push({ label: summary.speed === null ? 'Monitored for' : 'Time in the recording', value: timeText(frame.time_s) });
  if (summary.speed !== null && frame.pace !== null) facts.push({ label: 'Pace', value: `${fixed(frame.pace, 1)} of ${fixed(summary.speed, 1)} ×` });
  facts.push({ label: 'Alarms', value: fixed(summary.alarm_count, 0) });
  if (frame.compute_us !== null) facts.push({ label: 'A decision takes', value: `${significant(frame.compute_us)} µs` });
  const blind = Object.entries(summary.blind_s).map(([reason, seconds]) => `${reasonText(reason)}, ${duration(seconds)}`);
  if (blind.length > 0) facts.push({ label: 'Undetermined', value: blind.join('; ') });
  const lost = [
    [summary.lost_blocks, 'blocks of the stream'],
    [summary.dropped_hops, 'hops (samples came faster than they are processed)'],
  ] as const;
  const losses = lost.filter(([count]) => count > 0).map(([count, of]) => `${count} ${of}`);
  if (losses.length > 0) facts.push({ label: 'Lost', value: losses.join(', ') });
  if (frame.faults.length > 0) facts.push({ label: 'Input', value: frame.faults.map(inputFaultText).join(', ') });
  return facts;
}

export function Now({ summary }: { summary: MonitorSummary }) {
  const { error, frame, why } = summary;
  return (
    <section aria-label="Now" data-panel="monitor-now">
      <h2>
        Now <StateBadge summary={summary} />
      </h2>
      {error !== null && <FaultLine fault={error} alert />}
      {frame !== null && !isOver(summary) && <KeyFigures figures={keyFigures(frame)} />}
      <Facts facts={factsOf(summary)} />
      {why && frame && <Why why={why} alarm={frame.state === 'chatter'} />}
    </section>
  );
}

export function HistoryTable({ rows, summary }: { rows: MonitorRow[]; summary: Pick<MonitorSummary, 'speed' | 'started'> }) {
  return (
    <Table
      caption={`Alarms and notices about the input, the newest first${rows.length === 500 ? ' (the last 500)' : ''}`}
      rows={rows}
      rowClass={({ kind }) => (kind === 'chatter' ? 'chatter' : '')}
      rowKey={({ number }) => number}
      columns={[
        { heading: 'At', number: true, cell: (row) => beganText(row, summary) },
        { heading: 'For (s)', number: true, cell: lastedText },
        { heading: 'State', cell: rowState },
        { heading: 'Frequency', number: true, optional: true, cell: chatterText },
        { heading: 'Strongest in', optional: true, cell: ({ channel }) => channel ?? '' },
        { heading: 'Mode', optional: true, cell: (row) => modeName(row).replaceAll(' ', '\u00a0') },
        { heading: 'Suggested speed (rpm)', number: true, optional: true, cell: ({ suggested_spindle_speed_rpm: speed }) => fixed(speed, 0) },
        { heading: 'Highest score', number: true, optional: true, cell: ({ score }) => significant(score) },
        { heading: 'Note', long: true, optional: true, cell: rowNote },
        { heading: 'Why', optional: true, cell: ({ why }) => (why ? <Why why={why} alarm /> : '') },
      ]}
    />
  );
}

const spans = [
  { name: 'a minute', span_s: 60 },
  { name: 'ten minutes', span_s: 600 },
];

function Shown({ session, feed, chatter_hz }: { session: MonitorSession; feed: MonitorFeed; chatter_hz: number | null }) {
  const ring = useMemo(() => new FrameRing(session.edges_hz.length - 1), [session]);
  const [span, setSpan] = useState(0);
  const choices = useMemo(() => highestChoices(session.edges_hz), [session]);
  const [chosen, choose] = useState<number | null>(null);
  const [highest, widen] = useState(() => highestFor(choices, chatter_hz));
  useEffect(() => {
    for (const frame of session.frames) ring.push(frame);
    return feed.messages.listen(({ id, frame }) => id === session.id && ring.push(frame));
  }, [ring]);
  // It grows where chatter is higher than what is shown, and stays.
  useEffect(() => widen((now) => Math.max(now, highestFor(choices, chatter_hz))), [chatter_hz]);
  const shown_hz = chosen ?? highest;
  return (
    <Panel heading="Spectrogram">
      <div class="controls">
        <Choice legend="Shown" names={spans.map(({ name }) => name)} chosen={span} choose={setSpan} />
        <Select label="Up to" value={String(shown_hz)} options={choices.map((choice) => ({ value: String(choice), name: `${fixed(choice, 0)} Hz` }))} choose={(value) => choose(Number(value))} />
      </div>
      <LiveSpectrogram ring={ring} id={session.id} feed={feed} edges_hz={session.edges_hz} teeth={session.teeth} highest_hz={shown_hz} span_s={spans[span]!.span_s} />
    </Panel>
  );
}

const rows_ms = 1000;

/** The history, with what is said of it, at most once a second. */
function useRows(session: MonitorSession, feed: MonitorFeed): MonitorRow[] {
  const [rows, setRows] = useState(session.alarms);
  useEffect(() => {
    let newest = session.alarms;
    let timer: ReturnType<typeof setTimeout> | undefined;
    setRows(newest);
    const end = feed.messages.listen(({ id, alarms }) => {
      if (id !== session.id || alarms.length === 0) return;
      newest = withRows(newest, alarms);
      timer ??= setTimeout(() => {
        timer = undefined;
        setRows(newest);
      }, rows_ms);
    });
    return () => {
      clearTimeout(timer);
      end();
    };
  }, [session]);
  return rows;
}

function History({ session, feed }: { session: MonitorSession; feed: MonitorFeed }) {
  const rows = useRows(session, feed);
  const table = useMemo(() => <HistoryTable rows={rows} summary={session} />, [rows]);
  return (
    <Panel heading="History">{rows.length === 0 ? <p>No alarm yet.</p> : table}</Panel>
  );
}

/** What its files leave open or say unusually, as a report of the same shows it. */
export function Basis({ assumed, warnings }: Pick<MonitorSession, 'assumed' | 'warnings'>) {
  return (
    <>
      <WarningBox heading="Before you trust it" texts={warnings} />
      <AssumedBox assumed={assumed} />
    </>
  );
}

/** `since`: what asks for the session anew when it changes. */
export function Spindle({ summary, feed, since }: { summary: MonitorSummary; feed: MonitorFeed; since: string }) {
  const { api } = useServe();
  const [connection, setConnection] = useState(0);
  useEffect(() => feed.reconnected.listen(() => setConnection((count) => count + 1)), [feed]);
  const { answer, error } = useAnswer((signal) => api.monitor(summary.id, signal), [summary.id, since, connection]);
  return (
    <>
      <Now summary={summary} />
      <ErrorBox error={error} />
      {answer && <Basis assumed={answer.assumed} warnings={answer.warnings} />}
      {answer && <Shown session={answer} feed={feed} chatter_hz={summary.frame?.chatter_frequency_hz ?? null} />}
      {answer && <History session={answer} feed={feed} />}
    </>
  );
}
