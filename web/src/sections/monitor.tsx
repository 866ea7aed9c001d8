// What the chatter monitor detected, and how it was calibrated.
import type { CalibratedHalf, Calibration, CalibrationRecording, Fact, Monitor, MonitorAlarm, MonitorEvent, Num } from '../documents';
import { rocFigure, scoreFigure, spectrogramFigure, waveFigure } from '../figures/monitor';
import { chatterNotes, inputFaultText, findings, frequencyText, reasonText } from '../monitor_views';
import { Bullets, DetailsTable, Facts, Section, Table, WarningBox } from '../parts';
import { narrow, Plot } from '../plot';
import { dash, fixed, general, modeName, percent, significant, withDeviation } from '../text';
import { Why } from './why';

function frequencyOf(event: MonitorEvent): string {
  return withDeviation(event.chatter_frequency_hz, event.chatter_frequency_std_hz, 1, 1);
}

function isState({ event }: MonitorEvent): boolean {
  return event === 'state';
}

/** What an event says beside numbers. Where no command is possible the message says why there is no speed. */
function noteOf(of: MonitorEvent): string {
  const { event, state, reason, command, faults, what, file, message } = of;
  if (event === 'fault') return faults.length === 0 ? 'the input is well again' : `input: ${faults.map(inputFaultText).join(', ')}`;
  if (event === 'stream') return message ?? what ?? '';
  if (event === 'recording') return `recorded ${file ?? ''}`;
  const explained = command === 'none' ? { ...of, no_speed: null, line_frequencies_hz: [] } : of;
  const own = state === 'blind' ? [reasonText(reason)] : chatterNotes(explained);
  return [...own, ...(message === undefined ? [] : [message])].join('; ');
}

function commandOf({ command }: MonitorEvent): string {
  if (command === null) return '';
  return command === 'none' ? 'none is possible' : command.replace('-', ' ');
}

function Findings({ monitor }: { monitor: Monitor }) {
  return (
    <>
      {findings(monitor).map(({ head, text }) => (
        <p class="why">
          <strong>{head}</strong>
          {text}
        </p>
      ))}
    </>
  );
}

function spectrogramCaption({ spectrogram, teeth }: Monitor): string {
  const lines = teeth === null ? 'rotation' : 'rotation and tooth passing';
  return `Synchrosqueezed spectrogram of channel ${spectrogram!.channel}, up to the highest frequency worth drawing. Lines: ${lines}, where the speed is known; circles: the frequency of chatter.`;
}

function Plots({ monitor }: { monitor: Monitor }) {
  return (
    <>
      <Plot
        which="monitor-wave"
        shows="The samples over time, shaded by the monitor's state"
        caption="What was recorded, shaded by the monitor's state where that is not stable."
        draw={(theme, width) => waveFigure(monitor, theme, width < narrow)}
      />
      {monitor.spectrogram && (
        <Plot
          which="monitor-spectrogram"
          shows="Synchrosqueezed spectrogram of the recording over time"
          caption={spectrogramCaption(monitor)}
          draw={(theme) => spectrogramFigure(monitor, theme)}
        />
      )}
      <Plot
        which="monitor-score"
        shows="Score against its threshold, energy entropy and spindle speed over time"
        caption="The score against its threshold over the monitor's state, and what else was followed. Where a curve has a gap, nothing is known."
        draw={(theme) => scoreFigure(monitor, theme)}
      />
    </>
  );
}

function AlarmsTable({ alarms }: { alarms: MonitorAlarm[] }) {
  return (
    <Table
      caption="Alarms by frequency"
      columns={[
        { heading: 'Times', number: true, cell: ({ count }) => fixed(count, 0) },
        { heading: 'From (s)', number: true, cell: ({ from_s }) => fixed(from_s, 2) },
        { heading: 'To (s)', number: true, cell: ({ to_s }) => fixed(to_s, 2) },
        { heading: 'In chatter (s)', number: true, cell: ({ chatter_s }) => fixed(chatter_s, 2) },
        { heading: 'Frequency (Hz)', number: true, cell: frequencyText },
        { heading: 'Strongest in', cell: ({ channel }) => channel ?? dash },
        { heading: 'Mode', optional: true, cell: (alarm) => modeName(alarm) || dash },
        { heading: 'Quiet speed (rpm)', number: true, cell: ({ suggested_spindle_speed_rpm: speed }) => fixed(speed, 0) },
        { heading: 'Note', optional: true, cell: (alarm) => chatterNotes(alarm).join('; ') },
        { heading: 'Why', optional: true, cell: ({ why }) => (why ? <Why why={why} alarm /> : '') },
      ]}
      rows={alarms}
    />
  );
}

function EventsTable({ events }: { events: MonitorEvent[] }) {
  return (
    <DetailsTable
      summary={`${events.length} ${events.length === 1 ? 'event' : 'events'}, one by one`}
      caption="Events"
      columns={[
        { heading: 'At (s)', number: true, cell: (event) => fixed(event.time_s, 3) },
        { heading: 'State', cell: ({ state }) => (state === 'blind' ? 'cannot\u00a0tell' : state) },
        { heading: 'Score', number: true, cell: (event) => (isState(event) && event.state !== 'blind' ? significant(event.score) : dash) },
        { heading: 'Threshold', number: true, cell: (event) => (isState(event) ? significant(event.threshold) : dash) },
        { heading: 'Frequency (Hz)', number: true, cell: (event) => (isState(event) ? frequencyOf(event) : dash) },
        { heading: 'Mode', optional: true, cell: (event) => (isState(event) ? modeName(event) : '') },
        { heading: 'Quiet speed (rpm)', number: true, cell: (event) => fixed(isState(event) ? event.suggested_spindle_speed_rpm : null, 0) },
        { heading: 'Command', optional: true, cell: commandOf },
        { heading: 'Note', optional: true, cell: noteOf },
        { heading: 'Why', optional: true, cell: ({ why, state }) => (why ? <Why why={why} alarm={state === 'chatter'} /> : '') },
      ]}
      rows={events}
      rowClass={(event) => (event.state === 'chatter' ? 'chatter' : '')}
    />
  );
}

function ComputeTime({ monitor }: { monitor: Monitor }) {
  const { decision_count: count, compute_mean_us: mean, compute_max_us: most } = monitor;
  if (mean === null) return null;
  return <p>{`${count} decisions, each in ${significant(mean)} µs on average and ${significant(most)} µs at most.`}</p>;
}

export function MonitorSection({ monitor }: { monitor: Monitor }) {
  return (
    <Section id="monitor" heading="Chatter monitor" lead="What the monitor detected, and when.">
      <Facts facts={monitor.facts} />
      <WarningBox heading="Before you trust it" texts={monitor.warnings} />
      <Findings monitor={monitor} />
      {monitor.decisions.score.low.length > 0 && <Plots monitor={monitor} />}
      <AlarmsTable alarms={monitor.alarms} />
      <EventsTable events={monitor.events} />
      <ComputeTime monitor={monitor} />
      <Bullets texts={monitor.notes} />
    </Section>
  );
}

function isFound({ alarm_s: alarm, early }: CalibrationRecording): boolean {
  return alarm !== null && !early;
}

function isWrong(recording: CalibrationRecording): boolean {
  return isFound(recording) !== (recording.label === 'chatter');
}

function alarmOf(recording: CalibrationRecording) {
  const found = isFound(recording);
  if (isWrong(recording)) return <strong>{found ? 'false' : 'missed'}</strong>;
  return found ? 'yes' : 'no';
}

function delayOf({ alarm_s: alarm, onset_s: onset }: CalibrationRecording): Num {
  return alarm === null || onset === null ? null : 1e3 * (alarm - onset);
}

function RecordingsTable({ recordings }: { recordings: CalibrationRecording[] }) {
  return (
    <DetailsTable
      summary={`${recordings.length} recordings, ${recordings.filter(isWrong).length} classified wrongly`}
      caption="Recordings and what became of them"
      columns={[
        { heading: 'Recording', cell: ({ name }) => name },
        { heading: 'Label', cell: ({ label }) => label },
        { heading: 'Used to', cell: ({ half }) => (half === 'verifying' ? 'verify' : 'set') },
        { heading: 'Alarm', cell: alarmOf },
        { heading: "After chatter's begin (ms)", number: true, optional: true, cell: (recording) => fixed(delayOf(recording), 0) },
        { heading: 'Before it is visible (ms)', number: true, optional: true, cell: ({ lead_s: lead }) => fixed(lead === null ? null : 1e3 * lead, 0) },
      ]}
      rows={recordings}
      rowClass={(recording) => (isWrong(recording) ? 'chatter' : '')}
    />
  );
}

function halfText({ stable, chatter, chosen }: CalibratedHalf): string {
  const { false_alarm_rate: wrong, detection_rate: found, median_delay_s: delay } = chosen;
  const after = delay === null ? '' : `, ${fixed(1e3 * delay, 0)} ms after onset`;
  return `${stable} stable, ${chatter} with chatter: ${percent(wrong, 1)} false, ${percent(found, 1)} found${after}`;
}

function calibrationFacts({ status, entropy, alarm, threshold, setting, verifying, median_lead_s: lead }: Calibration): Fact[] {
  const facts = [
    { label: status === 'found' ? 'Chatter is' : 'Best that was tried', value: `${entropy} entropy ${alarm} ${threshold === null ? dash : general(threshold, 6)}` },
    { label: 'The half that sets it', value: halfText(setting) },
    { label: 'The half that verifies it', value: halfText(verifying) },
  ];
  if (lead !== null) facts.push({ label: 'Lead over the spectrogram', value: `${fixed(1e3 * lead, 0)} ms (median)` });
  return facts;
}

export function CalibrationSection({ calibration }: { calibration: Calibration }) {
  const found = calibration.status === 'found';
  const lead = found ? 'How the threshold was set, and how it did on the other half.' : 'What was tried as a threshold on one half, and how it did on the other.';
  return (
    <Section id="calibration" heading="Calibration" lead={lead}>
      {!found && (
        <p class="why">
          <strong>Not calibrated</strong>: {calibration.reason}. The numbers below are those of the best threshold that was tried; it is no detector.
        </p>
      )}
      <Facts facts={calibrationFacts(calibration)} />
      <Plot
        which="calibration-roc"
        shows="Share of chatter found against share of false alarms"
        caption={`Share of chatter found against share of false alarms, threshold by threshold; the mark is the ${found ? 'chosen' : 'best'} one, on the recordings that verify it.`}
        draw={(theme, width) => rocFigure(calibration, theme, width < narrow)}
      />
      <RecordingsTable recordings={calibration.recordings} />
    </Section>
  );
}
