// What tables and plots need, made of the documents.
import type { BoundaryPoint, LobesDocument, ModesDocument, ModeVector, Num, Owner, PartLimits, Plan, Report } from './documents';

export interface Mode {
  mode: number;
  mode_of: Owner;
  frequency_hz: number;
  damping_ratio: number;
  std: { frequency_hz: Num; damping_ratio: Num };
  left: ModeVector;
  right: ModeVector;
  limit_share: Num; // of the speeds whose limit it sets
}

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
  boundary: BoundaryPoint[];
  map: { spindle_speed_rpm: number[]; axial_depth_mm: number[]; spectral_radius: Num[][] } | null;
}

export function lobesOf(document: LobesDocument): Lobes {
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

export function partOf({ label, spindle_speed_rpm, limit_mm }: PartLimits, { searched_depth_mm }: Lobes): Lobes {
  return { label, spindle_speed_rpm, limit_mm, searched_depth_mm, band: null, boundary: [], map: null };
}

/** The limit over the direction of the feed. */
export interface FeedDirections {
  direction_deg: number[];
  lowest_limit_mm: Num[]; // over all speeds
  limit_at_speed_mm: Num[] | null; // where a speed is recommended
  spindle_speed_rpm: Num; // the recommended
  used_direction_deg: Num;
  searched_depth_mm: Num;
}

export function feedOf({ feed_directions: rows = [], feed_direction_deg: used = null, recommended }: Plan, searched: Num): FeedDirections {
  return {
    direction_deg: rows.map((row) => row.feed_direction_deg),
    lowest_limit_mm: rows.map((row) => row.lowest_limit_mm),
    limit_at_speed_mm: recommended === null ? null : rows.map((row) => row.limit_at_speed_mm ?? null),
    spindle_speed_rpm: recommended?.spindle_speed_rpm ?? null,
    used_direction_deg: used,
    searched_depth_mm: searched,
  };
}
