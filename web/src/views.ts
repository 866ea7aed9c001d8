// What tables and plots need, made of the documents.
import type { AssemblyDocument, Forces, FrfDocument, LimitRow, LobesDocument, ModesDocument, Num, Owner, PartLimits, Plan, Program, Report, Revolution, SegmentDocument, TipPeak } from './documents';

/** `limit_share`: of the speeds whose limit it sets. */
export type Mode = ModesDocument['modes'][number] & { mode: number; mode_of: Owner; limit_share: Num };

/** The tool's modes, then the workpiece's. */
export function modesOf({ modes, workpiece_modes: workpiece, plan }: Pick<Report, 'modes' | 'workpiece_modes' | 'plan'>): Mode[] {
  const named = (document: ModesDocument | null, owner: Owner) =>
    (document?.modes ?? []).map((mode, i) => ({ ...mode, mode: i + 1, mode_of: owner, limit_share: plan?.limit_share[owner][i] ?? null }));
  return [...named(modes, 'tool'), ...named(workpiece, 'workpiece')];
}

/** Limits over spindle speed, of all modes or of some. */
export interface Lobes {
  label: string;
  spindle_speed_rpm: number[];
  limit_mm: Num[]; // null: none up to searched_depth_mm
  searched_depth_mm: Num;
  band: { label: string; spindle_speed_rpm: number[]; low_mm: Num[]; high_mm: Num[] } | null;
  boundary: LimitRow[];
  map: { spindle_speed_rpm: number[]; axial_depth_mm: number[]; spectral_radius: Num[][] } | null;
}

/** What is drawn of lobes.json; while sliders move the limit is all that is known of the boundary. */
type DrawnLobes = Pick<LobesDocument, 'spindle_speed_rpm' | 'axial_depth_mm' | 'spectral_radius' | 'limit' | 'uncertainty'> & Pick<Lobes, 'boundary'>;

export function lobesOf(document: DrawnLobes): Lobes {
  const { spindle_speed_rpm: speed, axial_depth_mm: depth, spectral_radius: radius, boundary, limit, uncertainty } = document;
  return {
    label: 'all modes',
    spindle_speed_rpm: limit.map((row) => row.spindle_speed_rpm),
    limit_mm: limit.map((row) => row.axial_depth_mm),
    searched_depth_mm: depth[depth.length - 1] ?? null,
    band: uncertainty
      ? {
          label: `5 to 95 % of ${uncertainty.samples} samples`,
          spindle_speed_rpm: uncertainty.spindle_speed_rpm,
          low_mm: uncertainty.limit_5_percent_mm,
          high_mm: uncertainty.limit_95_percent_mm,
        }
      : null,
    boundary,
    map: radius ? { spindle_speed_rpm: speed, axial_depth_mm: depth, spectral_radius: radius } : null,
  };
}

export function partOf({ label, spindle_speed_rpm, limit_depth_mm: limit_mm }: PartLimits, { searched_depth_mm }: Lobes): Lobes {
  return { label, spindle_speed_rpm, limit_mm, searched_depth_mm, band: null, boundary: [], map: null };
}

/** The limit over the direction of the feed; that at a speed where one is recommended. */
export function feedOf({ feed_directions: rows = [], feed_direction_deg: used, recommended }: Plan, searched: Num) {
  return {
    direction_deg: rows.map((row) => row.feed_direction_deg),
    lowest_limit_mm: rows.map((row) => row.lowest_limit_mm),
    limit_at_speed_mm: recommended === null ? null : rows.map((row) => row.limit_at_speed_mm ?? null),
    spindle_speed_rpm: recommended?.spindle_speed_rpm ?? null,
    used_direction_deg: used ?? null,
    searched_depth_mm: searched,
  };
}

export type FeedDirections = ReturnType<typeof feedOf>;

/** A curve over its own axis. */
export interface Curve {
  frequency_hz: number[];
  magnitude: Num[];
  phase_deg: Num[];
}

export interface Frf {
  name: string;
  unit: string;
  measured: Curve | null;
  predicted: Curve | null;
  fitted: Curve | null;
  coherence: { frequency_hz: number[]; values: Num[] } | null;
  trusted_from_hz: Num;
  trusted_to_hz: Num;
  suspect_bands_hz: [number, number][];
  unreliable_bands_hz: [number, number][];
  grade: 'good' | 'usable' | 'poor' | null;
  findings: string[];
  remedies: string[];
  relative_error: Num; // of the fit
  prediction_error: Num;
}

/** The unit that an FRF is drawn in, and how many of it one SI unit is: "xx" is displacement by force, "ry:mx" rotation by moment. */
function unitOf(name: string): [string, number] {
  const [response = '', excitation = ''] = name.includes(':') ? name.split(':') : [...name];
  const moment = excitation.includes('m');
  if (response.includes('r')) return [moment ? 'rad/(N m)' : 'rad/N', 1];
  return [moment ? 'µm/(N m)' : 'µm/N', 1e6];
}

function curveOf(document: FrfDocument | null, name: string, scale: number): Curve | null {
  const values = document?.receptance_m_per_n[name];
  if (!document || !values) return null;
  const complex = (f: (re: number, im: number) => number) => values.re.map((re, i) => f(re, values.im[i]!));
  return {
    frequency_hz: document.frequency_hz,
    magnitude: complex((re, im) => scale * Math.hypot(re, im)),
    phase_deg: complex((re, im) => (Math.atan2(im, re) * 180) / Math.PI),
  };
}

/** Lines as bands of an axis, neighbours in one; a band reaches half a step beyond its lines. One between two of the axis counts with the next: a long axis is thinned. */
export function bandsOf(axis: number[], lines: number[]): [number, number][] {
  const bands: [number, number][] = [];
  let next = 0;
  let from: number | null = null;
  axis.forEach((at, i) => {
    const slack = 1e-5 * Math.abs(at); // axes that differ by less are the same, as for files
    const before = next;
    while (next < lines.length && lines[next]! <= at + slack) ++next;
    const marked = next > before;
    const low = i > 0 ? (axis[i - 1]! + at) / 2 : at;
    if (marked) from ??= low;
    else if (from !== null) {
      bands.push([from, low]);
      from = null;
    }
  });
  if (from !== null) bands.push([from, axis[axis.length - 1]!]);
  return bands;
}

export function frfsOf({ frf: document, fitted, measured, modes, assembly }: Pick<Report, 'frf' | 'fitted' | 'measured' | 'modes' | 'assembly'>): Frf[] {
  if (document === null) return [];
  return Object.keys(document.receptance_m_per_n).map((name) => {
    const [unit, scale] = unitOf(name);
    const own = curveOf(document, name, scale);
    const grade = document.grades?.[name];
    const coherence = document.coherence[name];
    const bands = (lines: number[] = []) => bandsOf(document.frequency_hz, lines);
    return {
      name,
      unit,
      measured: assembly ? curveOf(measured, name, scale) : own,
      predicted: assembly ? own : null,
      fitted: curveOf(fitted, name, scale),
      coherence: coherence ? { frequency_hz: document.frequency_hz, values: coherence } : null,
      trusted_from_hz: grade?.lowest_trustworthy_frequency_hz ?? null,
      trusted_to_hz: grade?.excited_band_hz[1] ?? null,
      suspect_bands_hz: bands(assembly?.suspect_hz),
      unreliable_bands_hz: bands(assembly?.unreliable_hz),
      grade: grade?.grade ?? null,
      findings: grade?.faults ?? [],
      remedies: grade?.remedies ?? [],
      relative_error: modes?.fit?.relative_error_by_frf[name] ?? null,
      prediction_error: assembly?.relative_error?.[name] ?? null,
    };
  });
}

export interface Hit {
  file: string;
  direction: string;
  accepted: boolean;
  reasons: string[];
}

export function hitsOf({ frf, plan }: Pick<Report, 'frf' | 'plan'>): Hit[] {
  return (frf?.hits ?? []).map((hit, i) => ({ ...hit, file: hit.file.replace(/^.*\//, ''), direction: plan?.hit_directions?.[i] ?? '' }));
}

export interface Segment extends SegmentDocument {
  part: 'tool' | 'holder' | 'shank';
  count: number; // from 1
}

export type Joint = Omit<NonNullable<AssemblyDocument['joint']>, 'shank'> & { shank: Segment[] };

export interface Assembly {
  tool: Segment[];
  joint: Joint | null; // null: rigid
  holder: { kind: 'measured' | 'wall' | 'segments' | 'free'; segments: Segment[]; file: string };
  peaks: TipPeak[];
  suspect_lines: number;
  unreliable_lines: number;
  notes: string[];
}

export function assemblyOf({ tool, joint, holder, peaks, suspect_hz, unreliable_hz, notes }: AssemblyDocument): Assembly {
  const named = (segments: SegmentDocument[] = [], part: Segment['part']) => segments.map((segment, i) => ({ ...segment, part, count: i + 1 }));
  const segments = named(holder.segments, 'holder');
  return {
    tool: named(tool, 'tool'),
    joint: joint && { ...joint, shank: named(joint.shank, 'shank') },
    holder: { kind: holder.free ? 'free' : holder.receptances ? 'measured' : segments.length > 0 ? 'segments' : 'wall', segments, file: holder.receptances ?? '' },
    peaks,
    suspect_lines: suspect_hz.length,
    unreliable_lines: unreliable_hz.length,
    notes,
  };
}

export function isRevolution(forces: Forces): forces is Revolution {
  return forces.rotation_deg !== undefined;
}

export function isProgram(forces: Forces): forces is Program {
  return forces.blocks !== undefined && forces.blocks.length > 0;
}

/** On straight lines between the points of a curve; null beyond its ends and beside what is missing. */
export function valueAt(x: number[], y: Num[], at: number): Num {
  const above = x.findIndex((value) => value >= at);
  if (above < 0) return null;
  const high = y[above] ?? null;
  if (x[above] === at) return high;
  const low = y[above - 1] ?? null;
  if (low === null || high === null) return null;
  const share = (at - x[above - 1]!) / (x[above]! - x[above - 1]!);
  return (1 - share) * low + share * high;
}
