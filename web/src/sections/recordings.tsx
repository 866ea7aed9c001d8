// Spectra of cuts that were made.
import { useState } from 'preact/hooks';
import type { Recording } from '../documents';
import { spectrumFigure } from '../figures/spectrum';
import { Section, Table } from '../parts';
import { LogChoice, Plot } from '../plot';
import { fixed, significant } from '../text';
import { VerdictBadge } from './lobes';

function Spectrum({ recording, index }: { recording: Recording; index: number }) {
  const [logarithmic, setLogarithmic] = useState(false);
  return (
    <Plot
      which={`recording:${index}`}
      shows={`Spectrum of ${recording.file}`}
      caption="Peaks on the rotation and tooth-passing lines are the cut itself; strong peaks between them are chatter."
      draw={(theme) => spectrumFigure(recording, logarithmic, theme)}
    >
      <LogChoice legend="Amplitude" logarithmic={logarithmic} choose={setLogarithmic} />
    </Plot>
  );
}

function Peaks({ recording }: { recording: Recording }) {
  return (
    <Table
      caption="Peaks"
      rows={recording.peaks}
      rowClass={({ kind }) => (kind === 'chatter' ? 'chatter' : '')}
      columns={[
        { heading: 'Frequency (Hz)', number: true, cell: (peak) => fixed(peak.frequency_hz, 2) },
        { heading: `Amplitude (${recording.amplitude_unit})`, number: true, cell: (peak) => significant(peak.amplitude) },
        { heading: 'What it is', cell: (peak) => peak.text },
      ]}
    />
  );
}

export function RecordingsSection({ recordings }: { recordings: Recording[] }) {
  return (
    <Section id="recordings" heading="Recorded cuts" lead="The spectrum of a recorded vibration says whether that cut chattered.">
      {recordings.map((recording, index) => (
        <article class="recording">
          <h3>
            {recording.file} <VerdictBadge verdict={recording.verdict} />
          </h3>
          <p>
            {fixed(recording.spindle_speed_rpm, 0)} rpm, {recording.teeth} teeth, {significant(recording.axial_depth_mm)} mm deep
            {recording.reason && `. ${recording.reason}`}
          </p>
          {recording.frequency_hz.length > 0 && <Spectrum recording={recording} index={index} />}
          {recording.peaks.length > 0 && <Peaks recording={recording} />}
        </article>
      ))}
    </Section>
  );
}
