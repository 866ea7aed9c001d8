// What the peaks of a recorded cut are.
import type { ExplainedPeak, ExplanationDocument } from '../documents';
import { peaksFigure } from '../figures/peaks';
import { Section, Table } from '../parts';
import { Plot } from '../plot';
import { dash, fixed, modeName, significant } from '../text';
import { readingText } from '../verb_views';

function Outcome({ document }: { document: ExplanationDocument }) {
  const { state, chatter_frequency_hz: frequency } = document;
  if (state === 'named') {
    return (
      <p class="why">
        <strong>Chatter of {modeName(document)}</strong> at {fixed(frequency, 2)} Hz.
      </p>
    );
  }
  if (state === 'no chatter') return <p class="why">No peak is chatter of a known mode.</p>;
  return (
    <p class="why">
      <strong>These peaks do not identify the mode that chatters</strong>, if there is chatter.
    </p>
  );
}

const mechanisms = {
  stable: 'By the model this cut is stable',
  regenerative: 'By the model this chatter is regenerative: the surface wave that the previous tooth cut sustains it',
  'mode coupling': 'By the model this chatter is mode coupling: the modes sustain each other without the surface wave of the previous tooth',
};

function Mechanism({ chatter }: Pick<ExplanationDocument, 'chatter'>) {
  if (chatter === null) return null;
  const { kind, spectral_radius: radius, spectral_radius_without_delay: without } = chatter;
  return (
    <p>
      {mechanisms[kind]}. Spectral radius {significant(radius)}, without the delay {significant(without)}.
    </p>
  );
}

function others({ others: readings }: ExplainedPeak): string {
  return readings.map(readingText).join('; ');
}

export function PeaksSection({ document }: { document: ExplanationDocument }) {
  const { spindle_speed_rpm: speed, speed_from_peaks: fromPeaks, peaks } = document;
  return (
    <Section id="peaks" heading="Peaks of a cut" lead="What each peak of a recorded spectrum is: the cut itself, or a mode that chatters.">
      <Outcome document={document} />
      <Mechanism chatter={document.chatter} />
      <p>
        Spindle at {fixed(speed, 1)} rpm, {fromPeaks ? 'from the peaks that are multiples of the rotation' : 'as given'}.
      </p>
      <Plot
        which="peaks"
        shows="Peaks over frequency by what they are, with the multiples of the rotation"
        caption="A peak on a line of the rotation is the cut; chatter stands between them, or a whole number of rotations from its mode. Open: another way to read the peak."
        draw={(theme) => peaksFigure(document, theme)}
      />
      <Table
        caption="Peaks"
        quiet
        rows={peaks}
        rowClass={({ kind }) => (kind === 'chatter' ? 'chatter' : '')}
        columns={[
          { heading: 'Frequency (Hz)', number: true, cell: (peak) => fixed(peak.frequency_hz, 2) },
          { heading: 'What it is', cell: ({ kind }) => kind },
          { heading: 'Read as', cell: readingText },
          { heading: 'Off by (Hz)', number: true, optional: true, cell: (peak) => fixed(peak.difference_hz ?? null, 2) },
          { heading: 'Tolerance (Hz)', number: true, optional: true, cell: (peak) => fixed(peak.tolerance_hz ?? null, 2) },
          { heading: 'Vibration at (Hz)', number: true, optional: true, cell: (peak) => fixed(peak.chatter_frequency_hz, 2) },
          { heading: 'Or', long: true, optional: true, cell: (peak) => others(peak) || dash },
        ]}
      />
    </Section>
  );
}
