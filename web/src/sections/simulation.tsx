// A cut, simulated in the time domain.
import { useState } from 'preact/hooks';
import type { SimulationDocument, VibrationDocument } from '../documents';
import { timeFigure, vibrationSpectrumFigure } from '../figures/simulation';
import { Facts, Section, Table } from '../parts';
import { LogChoice, Plot } from '../plot';
import { fixed, percent, significant } from '../text';

function Outcome({ simulation }: { simulation: SimulationDocument }) {
  const { verdict, chatter_frequency_hz: frequency, chatter_amplitude_um: amplitude, small_vibration: small } = simulation;
  const look = verdict === 'undecided' ? 'unknown' : verdict;
  return (
    <p class="why">
      <span class={`verdict ${look}`}>{verdict}</span>
      {frequency !== null && ` Chatter at ${fixed(frequency, 1)} Hz${amplitude === null ? '' : `, ${significant(amplitude)} µm`}.`}
      {verdict === 'undecided' && ' Simulated for longer it would show.'}
      {small !== null && small.spectral_radius !== null && ` A small vibration ${small.spectral_radius < 1 ? 'dies out' : 'grows'}: spectral radius ${fixed(small.spectral_radius, 4)} a period.`}
    </p>
  );
}

function Walls({ walls }: Pick<SimulationDocument, 'walls'>) {
  return (
    <Table
      caption="Surface left on the walls (positive: material left)"
      rows={walls}
      columns={[
        { heading: 'Wall where teeth', cell: ({ angle_deg: angle }) => (angle < 90 ? 'enter' : 'leave') },
        { heading: 'Error (µm)', number: true, cell: (wall) => significant(wall.location_error_um) },
        { heading: 'Least over the height (µm)', number: true, cell: (wall) => significant(wall.least_location_error_um) },
        { heading: 'Greatest (µm)', number: true, cell: (wall) => significant(wall.greatest_location_error_um) },
        { heading: 'Ra (µm)', number: true, cell: (wall) => significant(wall.ra_um) },
        { heading: 'Rz (µm)', number: true, cell: (wall) => significant(wall.rz_um) },
      ]}
    />
  );
}

function Spectrum({ simulation, spectrum }: { simulation: SimulationDocument; spectrum: NonNullable<VibrationDocument['spectrum']> }) {
  const [logarithmic, setLogarithmic] = useState(true);
  return (
    <Plot
      which="simulated-spectrum"
      shows="Spectrum of the simulated displacement"
      caption={`From ${significant(spectrum.from_s)} s on. Lines on the multiples of the rotation are the cut itself; strong lines between them are chatter.`}
      draw={(theme) => vibrationSpectrumFigure(simulation, spectrum, logarithmic, theme)}
    >
      <LogChoice legend="Amplitude" logarithmic={logarithmic} choose={setLogarithmic} />
    </Plot>
  );
}

export function SimulationSection({ simulation, vibration }: { simulation: SimulationDocument; vibration: VibrationDocument | null }) {
  const { vibrating_peak_n: peak, mean_force_n: mean } = simulation;
  const accuracy = `${significant(simulation.error_estimate)}${simulation.resolved ? '' : ', above the tolerance'}`;
  return (
    <Section id="simulation" heading="Cut in time" lead="The vibration of tool and part as it builds up, with teeth that may leave the cut.">
      <Outcome simulation={simulation} />
      <Facts
        facts={[
          { label: 'Spindle speed', value: `${fixed(simulation.spindle_speed_rpm, 0)} rpm` },
          { label: 'Axial depth', value: `${significant(simulation.axial_depth_mm)} mm` },
          { label: 'Out of contact', value: `${percent(simulation.missed_share, 1)} of the time` },
          { label: 'Steps a revolution', value: `${simulation.steps_per_revolution}` },
          { label: 'Estimated error', value: accuracy },
        ]}
      />
      {simulation.diverged && (
        <p>
          <strong>The motion grew beyond every bound</strong>; the curves end there.
        </p>
      )}
      {vibration && (
        <Plot
          which="simulated"
          shows="Displacement of the tool and force over time"
          caption="Where a curve is a band, it oscillates within it."
          draw={(theme) => timeFigure(vibration, theme)}
        />
      )}
      {vibration?.spectrum && <Spectrum simulation={simulation} spectrum={vibration.spectrum} />}
      <Table
        caption="Force on the tool"
        rows={['x', 'y', 'z']}
        columns={[
          { heading: 'Direction', cell: (name) => name },
          { heading: 'Peak (N)', number: true, cell: (_, i) => significant(peak[i] ?? null) },
          { heading: 'Mean (N)', number: true, cell: (_, i) => significant(mean[i] ?? null) },
        ]}
      />
      <Walls walls={simulation.walls} />
    </Section>
  );
}
