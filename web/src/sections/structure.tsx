// What was measured of the structure, and the modes fitted to it.
import { useState } from 'preact/hooks';
import type { ModesDocument, ModeVector, Num, Owner, Pole, StageFile } from '../documents';
import { convergenceFigure, stabilisationFigure } from '../figures/fit';
import { frfFigure, prefersLogFrequency } from '../figures/frf';
import { Bullets, Details, Section, Table, type Column } from '../parts';
import { Choice, LogChoice, Plot } from '../plot';
import { dash, percent, significant, withDeviation } from '../text';
import type { Frf, Hit, Mode } from '../views';

function FrfPlot({ frfs, modes, predicted }: { frfs: Frf[]; modes: Mode[]; predicted: boolean }) {
  const [shown, setShown] = useState(0);
  const [logarithmic, setLogarithmic] = useState(frfs.some(prefersLogFrequency));
  const shows = predicted
    ? 'Frequency response functions, predicted, measured where known, and fitted: magnitude and phase'
    : 'Frequency response functions, measured and fitted: magnitude, phase and coherence';
  const coherent = !predicted && frfs.some(({ coherence }) => coherence !== null);
  const caption = `A peak is a frequency at which the tool tip is compliant${coherent ? '; coherence near 1 means the hits agree.' : '.'}`;
  return (
    <Plot which="frf" shows={shows} caption={caption} draw={(theme) => frfFigure(frfs[shown]!, modes, logarithmic, theme)}>
      <Choice legend="FRF" names={frfs.map(({ name }) => name)} chosen={shown} choose={setShown} />
      <LogChoice legend="Frequency" logarithmic={logarithmic} choose={setLogarithmic} />
    </Plot>
  );
}

/** How far the modes are from predicted FRFs, and these from a measurement; nothing where there is neither. */
function PredictionTable({ frfs }: { frfs: Frf[] }) {
  if (frfs.every(({ relative_error: fit, prediction_error: prediction }) => fit === null && prediction === null)) return null;
  return (
    <Table
      caption="How far the curves are apart"
      rows={frfs}
      columns={[
        { heading: 'FRF', cell: ({ name }) => name },
        { heading: 'Fit from prediction', number: true, optional: true, cell: (frf) => percent(frf.relative_error, 2) },
        { heading: 'Prediction from measurement', number: true, optional: true, cell: (frf) => percent(frf.prediction_error, 1) },
      ]}
    />
  );
}

/** Nothing where FRFs are neither graded nor fitted. */
function QualityTable({ frfs }: { frfs: Frf[] }) {
  if (frfs.every(({ grade, relative_error: error }) => grade === null && error === null)) return null;
  const graded = frfs.some(({ grade }) => grade !== null);
  const columns: Column<Frf>[] = [{ heading: 'FRF', cell: ({ name }) => name }];
  if (graded) {
    columns.push(
      { heading: 'Grade', cell: ({ grade }) => <span class={`grade ${grade ?? 'unknown'}`}>{grade ?? 'not graded'}</span> },
      { heading: 'What was found', cell: ({ findings }) => findings.join('; ') },
      { heading: 'What to do', cell: ({ remedies }) => remedies.join('; ') },
    );
  }
  columns.push({ heading: 'Fit error', number: true, optional: true, cell: (frf) => percent(frf.relative_error, 2) });
  return <Table caption={graded ? 'Quality before the fit' : 'Error of the fit'} columns={columns} rows={frfs} />;
}

export function FrfSection({ frfs, modes, predicted }: { frfs: Frf[]; modes: Mode[]; predicted: boolean }) {
  const lead = predicted
    ? 'How far the tool tip moves for a force of one newton, as predicted from tool, joint and holder; xx is x due to a force in x.'
    : 'How far the tool tip moves for a force of one newton, at each frequency: xy is x due to a force in y.';
  return (
    <Section id="frf" heading="Frequency response" lead={lead}>
      <FrfPlot frfs={frfs} modes={modes} predicted={predicted} />
      {predicted ? <PredictionTable frfs={frfs} /> : <QualityTable frfs={frfs} />}
    </Section>
  );
}

function size([real, imaginary]: [number, number]): number {
  return Math.hypot(real, imaginary);
}

/** "x 93 %, y 7 %": how a mode's vibration splits over its degrees of freedom. */
function directions(vector: ModeVector): string {
  const total = Object.values(vector).reduce((sum, value) => sum + size(value) ** 2, 0);
  if (total <= 0) return '';
  return Object.entries(vector).map(([dof, value]) => `${dof} ${percent(size(value) ** 2 / total, 0)}`).join(', ');
}

function ShareBar({ share }: { share: number }) {
  return (
    <>
      <span class="bar" aria-hidden="true">
        <span style={{ width: `${(100 * share).toFixed(1)}%` }} />
      </span>
      {percent(share, 0)}
    </>
  );
}

function complexText([real, imaginary]: [number, number]): string {
  return `${(1e4 * real).toFixed(2)} ${imaginary < 0 ? '−' : '+'} ${Math.abs(1e4 * imaginary).toFixed(2)}i`;
}

/** "3", "3 (workpiece)". */
function modeCell({ mode, mode_of: owner }: Mode): string {
  return owner === 'tool' ? `${mode}` : `${mode} (workpiece)`;
}

/** Of one structure: another's vectors may have other directions. */
function Vectors({ modes, owner }: { modes: Mode[]; owner: Owner }) {
  const rows = modes.filter((mode) => mode.mode_of === owner);
  const first = rows[0];
  if (!first) return null;
  const heading = `Mode vectors of the ${owner}`;
  const columns: Column<Mode>[] = [{ heading: 'Mode', number: true, cell: modeCell }];
  for (const side of ['left', 'right'] as const) {
    const title = side === 'left' ? 'Left' : 'Right';
    for (const dof of Object.keys(first[side])) {
      columns.push({ heading: `${title} ${dof}`, number: true, cell: (mode) => complexText(mode[side][dof]!) });
    }
  }
  return (
    <Details summary={heading}>
      <Table caption={`${heading} (10⁻⁴ √(s/kg))`} columns={columns} rows={rows} />
    </Details>
  );
}

function FitSentence({ fit }: { fit: NonNullable<ModesDocument['fit']> }) {
  const [from, to] = fit.band_hz;
  let text = `Fitted from ${significant(from)} to ${significant(to)} Hz; the fit differs from the FRFs by ${percent(fit.relative_error, 2)}`;
  if (fit.mean_relative_error !== null) text += ` (mean over lines ${percent(fit.mean_relative_error, 2)})`;
  return (
    <p>
      {text}.{!fit.converged && <strong> The fit did not converge.</strong>}
    </p>
  );
}

function FitPlots({ best, poles }: { best: Num[]; poles: Pole[] }) {
  return (
    <>
      {best.length > 0 && (
        <Details summary="Convergence of the fit">
          <Plot
            which="convergence"
            shows="Best objective over iterations"
            caption="The fit is done when the curve no longer falls."
            draw={(theme) => convergenceFigure(best, theme)}
          />
        </Details>
      )}
      {poles.length > 0 && (
        <Details summary="Stabilisation diagram">
          <Plot
            which="stabilisation"
            shows="Poles by model order over frequency"
            caption="A pole that stands still while the order grows is a mode of the structure; the others are noise."
            draw={(theme) => stabilisationFigure(poles, theme)}
          />
        </Details>
      )}
    </>
  );
}

export function ModesSection({ modes, document }: { modes: Mode[]; document: ModesDocument | null }) {
  const { fit, convergence, stabilisation = [] } = document ?? {};
  return (
    <Section id="modes" heading="Modes" lead="The vibrations the structure has of its own; ± is one standard deviation.">
      {fit && <FitSentence fit={fit} />}
      {modes.length > 0 && (
        <Table
          caption="Modes"
          quiet
          rows={modes}
          columns={[
            { heading: 'Mode', number: true, cell: modeCell },
            { heading: 'Frequency (Hz)', number: true, cell: (mode) => withDeviation(mode.frequency_hz, mode.std.frequency_hz, 1, 2) },
            { heading: 'Damping (%)', number: true, cell: (mode) => withDeviation(mode.damping_ratio, mode.std.damping_ratio, 100, 2) },
            { heading: 'Stiffness (N/µm)', number: true, optional: true, cell: (mode) => significant(mode.modal_stiffness_n_per_um) },
            { heading: 'Mass (kg)', number: true, optional: true, cell: (mode) => significant(mode.modal_mass_kg) },
            { heading: 'Remark', optional: true, cell: (mode) => (mode.weak ? 'weak: the FRFs hardly show it' : '') },
            { heading: 'Force that drives it', cell: (mode) => directions(mode.left) },
            { heading: 'Motion', cell: (mode) => directions(mode.right) },
            { heading: 'Share in the limit', optional: true, cell: ({ limit_share: share }) => (share === null ? dash : <ShareBar share={share} />) },
          ]}
        />
      )}
      <Vectors modes={modes} owner="tool" />
      <Vectors modes={modes} owner="workpiece" />
      <FitPlots best={convergence?.best ?? []} poles={stabilisation} />
    </Section>
  );
}

export function HitsSection({ hits }: { hits: Hit[] }) {
  const used = hits.filter(({ accepted }) => accepted).length;
  const table = (
    <Table
      caption="Hammer hits"
      quiet
      rows={hits}
      rowClass={({ accepted }) => (accepted ? '' : 'rejected')}
      columns={[
        { heading: 'File', cell: ({ file }) => file },
        { heading: 'Force', optional: true, cell: ({ direction }) => direction },
        { heading: 'Used', cell: ({ accepted }) => (accepted ? 'yes' : <strong>no</strong>) },
        { heading: 'Remarks', cell: ({ reasons }) => reasons.join('; ') },
      ]}
    />
  );
  return (
    <Section id="hits" heading="Hammer hits" lead="A hit that is overloaded or double is left out of the average.">
      <p>
        {used} of {hits.length} hits were used.
      </p>
      {used === hits.length ? <Details summary="All hits">{table}</Details> : table}
    </Section>
  );
}

export function NotesSection({ notes, files }: { notes: string[]; files: StageFile[] }) {
  return (
    <Section id="notes" heading="Notes and files" lead="What else is worth knowing, and where the numbers are.">
      <Bullets texts={notes} />
      {files.length > 0 && (
        <Table
          caption="Files beside this report"
          rows={files}
          columns={[
            { heading: 'Stage', cell: ({ stage }) => stage },
            { heading: 'File', cell: ({ file }) => <code>{file}</code> },
            { heading: 'What it holds', cell: ({ description }) => description },
          ]}
        />
      )}
    </Section>
  );
}
