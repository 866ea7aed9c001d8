// What to cut, and what keeps it from being faster.
import type { ComponentChildren } from 'preact';
import type { Agreement, Finishing, Plan, Recommendation } from '../documents';
import { KeyFigures, Table, type KeyFigure } from '../parts';
import { fixed, modeName, percent, significant } from '../text';

function limitedBy(cut: Recommendation): string {
  return cut.limited_by || modeName(cut);
}

/** The cuts that were made say that the model is wrong: nothing below is worth more than that. */
export function Disagreement({ agree, disagree }: Agreement) {
  if (disagree === 0) return null;
  return (
    <p class="why none">
      <strong>
        {disagree} of {disagree + agree} test cuts disagree
      </strong>{' '}
      with the prediction. Find out why before you use these numbers: measure again, or check cutter, cut and coefficients.
    </p>
  );
}

function figuresOf(cut: Recommendation): KeyFigure[] {
  return [
    { label: 'Spindle speed', value: fixed(cut.spindle_speed_rpm, 0), unit: 'rpm' },
    { label: 'Axial depth', value: fixed(cut.axial_depth_mm, 2), unit: 'mm' },
    { label: 'Feed', value: significant(cut.feed_mm_per_min), unit: 'mm/min' },
    { label: 'Feed per tooth', value: significant(cut.feed_per_tooth_mm), unit: 'mm' },
    { label: 'Cutting speed', value: significant(cut.cutting_speed_m_per_min), unit: 'm/min' },
    { label: 'Removal rate', value: significant(cut.removal_rate_mm3_per_s), unit: 'mm³/s' },
    { label: 'Mean torque', value: significant(cut.torque_n_m), unit: 'N·m' },
    { label: 'Mean power', value: significant(cut.power_w), unit: 'W' },
    { label: 'Surface error', value: significant(cut.surface_error_um), unit: 'µm' },
    { label: 'Forced vibration, amplitude', value: significant(cut.forced_vibration?.amplitude_um ?? null), unit: 'µm' },
    { label: 'Peak deflection', value: significant(cut.peak_deflection_um), unit: 'µm' },
  ];
}

/** What forced vibration leaves, and whether anything limits it. */
function surfaceSentence({ surface_error_um: error, peak_deflection_um: deflection }: Recommendation, permitted: Finishing): string {
  if (deflection === null) return 'The surface that forced vibration leaves is not known.';
  const wall =
    error === null
      ? 'No tooth finishes a wall'
      : `Forced vibration leaves ${significant(Math.abs(error))} µm of ${error < 0 ? 'overcut' : 'material'} at the wall`;
  const limits: string[] = [];
  if (permitted.max_surface_error_um !== null) limits.push(`surface error ${significant(permitted.max_surface_error_um)} µm`);
  if (permitted.max_deflection_um !== null) limits.push(`deflection ${significant(permitted.max_deflection_um)} µm`);
  const limited = limits.length > 0 ? `Permitted: ${limits.join(', ')}.` : 'Neither is limited: this is a roughing cut.';
  return `${wall}; the tip moves by up to ${significant(deflection)} µm. ${limited}`;
}

function Why({ cut }: { cut: Recommendation }) {
  const why = limitedBy(cut);
  const chatters = cut.mode !== null || cut.window_chatter_frequency_hz !== null;
  const sentences: ComponentChildren[] = [];
  if (why !== '') sentences.push(<>Limited by <strong>{why}</strong>. </>);
  if (cut.window_chatter_frequency_hz !== null && !why.includes(' Hz')) {
    sentences.push(`Chatter would be at ${fixed(cut.window_chatter_frequency_hz, 0)} Hz. `);
  }
  if (cut.margin !== null) {
    const depth = percent(cut.margin, 0);
    sentences.push(
      chatters
        ? `The depth stays ${depth} below the chatter limit near this speed.`
        : `No chatter limit was found near this speed: the depth stays ${depth} below the deepest cut that was looked at.`,
    );
  }
  return <p class="why">{sentences}</p>;
}

function Alternatives({ cuts }: { cuts: Recommendation[] }) {
  return (
    <Table
      caption="Alternatives"
      rows={cuts}
      columns={[
        { heading: '', cell: (_, index) => <span class="tag">{index + 1}</span> },
        { heading: 'Spindle speed (rpm)', number: true, cell: (cut) => fixed(cut.spindle_speed_rpm, 0) },
        { heading: 'Axial depth (mm)', number: true, cell: (cut) => fixed(cut.axial_depth_mm, 2) },
        { heading: 'Feed (mm/min)', number: true, cell: (cut) => significant(cut.feed_mm_per_min) },
        { heading: 'Removal rate (mm³/s)', number: true, cell: (cut) => significant(cut.removal_rate_mm3_per_s) },
        { heading: 'Surface error (µm)', number: true, cell: (cut) => significant(cut.surface_error_um) },
        { heading: 'Margin', number: true, cell: (cut) => percent(cut.margin, 0) },
        { heading: 'Limited by', cell: limitedBy },
      ]}
    />
  );
}

/** Test cuts that disagree are said here unless a decision above says so. */
export function RecommendationSection({ plan, hasLobes }: { plan: Plan; hasLobes: boolean }) {
  const { recommended: cut, reason = '', alternatives, agreement } = plan;
  const answered = cut !== null || reason !== '' || alternatives.length > 0;
  const saidAbove = Boolean(plan.decision);
  if (!answered && (saidAbove || agreement.disagree === 0)) return null;
  return (
    <section id="recommendation" class="hero">
      <h2>{answered ? 'Recommended cut' : 'Test cuts'}</h2>
      {!saidAbove && <Disagreement {...agreement} />}
      {cut !== null && (
        <>
          <KeyFigures figures={figuresOf(cut)} />
          <Why cut={cut} />
          <p class="why">{surfaceSentence(cut, plan.finishing)}</p>
        </>
      )}
      {cut === null && answered && (
        <p class="why none">
          <strong>{hasLobes ? 'No safe depth.' : 'No answer.'}</strong> {reason}
        </p>
      )}
      <Alternatives cuts={alternatives} />
    </section>
  );
}
