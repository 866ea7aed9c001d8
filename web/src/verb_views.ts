// What tables and plots need of the documents of single verbs.
import { keys as keysOfJoint } from '#schema/joint';
import { keys } from '#schema/sweep';
import type { ChartPoint, CoefficientsDocument, ExplainedPeak, ExplanationDocument, JointDocument, Num, Reading, Slot, SweepDocument } from './documents';
import { capital, fixed, modeName, significant } from './text';

type SweptKey = Extract<keyof SweepDocument, `${SweepDocument['sweep']}_${string}`>;

/** What a sweep varies beside the speed: the key of the document that is its name and a unit. */
export function sweptOf(sweep: SweepDocument) {
  const isKey = (key: string): key is SweptKey => key.startsWith(`${sweep.sweep}_`);
  const key = Object.keys(keys).find(isKey)!;
  return { key, name: capital(sweep.sweep.replace('_', ' ')), unit: keys[key].unit, values: sweep[key] ?? [], valueOf: (point: ChartPoint): Num => point[key] ?? null };
}

/** "0.5 to 1.2, 2 to 3"; empty: at no value. */
export function intervalsText(intervals: [number, number][]): string {
  return intervals.map(([from, to]) => `${significant(from)} to ${significant(to)}`).join(', ');
}

function turnsText(rotations: number): string {
  return `${Math.abs(rotations)} × rotation`;
}

/** What a peak is read as: "12 × rotation", "mode 3 at 433.0 Hz + 2 × rotation"; its kind alone where nothing more is known. */
export function readingText(reading: Pick<ExplainedPeak, 'kind'> & Partial<Reading>): string {
  const { kind, rotations, mode = null, mode_of = null, mode_frequency_hz: own = null, mirrored = false } = reading;
  if (rotations === undefined) return kind === 'chatter' ? 'chatter of an ambiguous mode' : kind === 'cut or chatter' ? 'the cut, or chatter' : 'nothing known';
  if (kind === 'rotation' || kind === 'tooth passing') return turnsText(rotations);
  if (kind !== 'chatter') return 'nothing known';
  const name = `${modeName({ mode, mode_of })}${own === null ? '' : ` at ${own.toFixed(2)} Hz`}`;
  if (rotations === 0) return name;
  if (rotations > 0) return `${name} + ${turnsText(rotations)}`;
  return mirrored ? `${turnsText(rotations)} − ${name}` : `${name} − ${turnsText(rotations)}`;
}

/** Up to where a plot of the peaks goes. */
export function reachOf({ peaks, spindle_speed_rpm: speed }: ExplanationDocument): number {
  return 1.06 * peaks.reduce((most, peak) => Math.max(most, peak.frequency_hz), 2 * speed / 60);
}

/** Slots of one depth and speed, by feed. */
export function slotGroups(slots: Slot[]): { label: string; slots: Slot[] }[] {
  const groups = new Map<string, Slot[]>();
  for (const slot of slots) {
    const speed = slot.spindle_speed_rpm === null ? '' : `, ${fixed(slot.spindle_speed_rpm, 0)} rpm`;
    const label = `${significant(slot.axial_depth_mm)} mm deep${speed}`;
    groups.set(label, [...(groups.get(label) ?? []), slot]);
  }
  return [...groups].map(([label, own]) => ({ label, slots: [...own].sort((a, b) => a.feed_per_tooth_mm - b.feed_per_tooth_mm) }));
}

type Identification = CoefficientsDocument['identification'];
type Fitted = Pick<Identification, 'std'> & Pick<CoefficientsDocument, 'coefficients'>;

/** A row a direction: its cutting and its edge coefficient. */
export function coefficientRows({ coefficients, std }: Fitted, quality?: Identification) {
  return (['tangential', 'radial', 'axial'] as const).flatMap((direction) => {
    const pair = (key: keyof typeof std) => ({ value: coefficients[key], std: std[key] });
    const row = {
      direction,
      cutting: pair(`${direction}_n_per_mm2`),
      edge: pair(`${direction}_edge_n_per_mm`),
      r_squared: quality?.r_squared[direction] ?? null,
      noise_n: quality?.noise_n[direction] ?? null,
    };
    return row.cutting.value === null && row.edge.value === null ? [] : row;
  });
}

export type CoefficientRow = ReturnType<typeof coefficientRows>[number];

const jointKeys: Record<string, { unit: string; meaning: string }> = keysOfJoint;

/** The values of a joint as they are shown. */
export function jointRows({ joint, std, identifiable, visible_up_to }: JointDocument) {
  const deviations: Record<string, Num> = std;
  const known: Record<string, boolean> = identifiable;
  const visible: Record<string, Num> = visible_up_to;
  return Object.entries(joint).map(([key, value]) => {
    const { meaning = key, unit = '' } = jointKeys[`joint.${key}`] ?? {};
    return { name: capital(meaning), unit, value, std: deviations[key] ?? null, identifiable: known[key] ?? false, visible_up_to: visible[key] ?? null };
  });
}
