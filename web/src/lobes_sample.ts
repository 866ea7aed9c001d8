// A lobes.json with all of its parts, for tests.
import type { LobesDocument, LobesPoint } from './documents';

const limit: LobesDocument['limit'] = [
  { spindle_speed_rpm: 4000, axial_depth_mm: 0.5, chatter_frequency_hz: 540, kind: 'hopf', mode: 2, mode_of: 'tool', error_estimate: 1e-6 },
  { spindle_speed_rpm: 6000, axial_depth_mm: 1.5, chatter_frequency_hz: 922, kind: 'flip', mode: 3, mode_of: 'workpiece', error_estimate: null },
  { spindle_speed_rpm: 8000, axial_depth_mm: null },
];

/** Unstable, with a limit. */
export const pointSample: LobesPoint = {
  spindle_speed_rpm: 5800,
  axial_depth_mm: 1.2,
  spectral_radius: 1.02,
  stable: false,
  error_estimate: null,
  multiplier: [-1.02, 0],
  dominant_frequency_hz: 918,
  kind: 'flip',
  mode: 3,
  mode_of: 'tool',
  gain_margin: 0.96,
  limit_depth_mm: 1.15,
  margin: -0.043,
};

export const lobesSample: LobesDocument = {
  document: 'lobes/1',
  spindle_speed_rpm: [4000, 6000, 8000],
  axial_depth_mm: [0, 3],
  spectral_radius: [[0.4, 0.5, 0.3], [1.6, 1.2, null]],
  boundary: [
    { spindle_speed_rpm: 4000, axial_depth_mm: 0.6, chatter_frequency_hz: 541, kind: 'hopf', mode: 2, mode_of: 'tool', curve: 1, error_estimate: 1e-6 },
    { spindle_speed_rpm: 6100, axial_depth_mm: 1.6, chatter_frequency_hz: null, kind: 'fold', mode: null, mode_of: null, curve: 0, error_estimate: null },
  ],
  limit,
  points: [pointSample],
  method: 'collocation',
  period: 'tooth',
  evaluations: 120,
  unsettled: 0,
  uncertain: 1,
  seconds: 0.2,
  uncertainty: {
    samples: 50,
    spindle_speed_rpm: [4000, 8000],
    axial_depth_mm: [0, 3],
    limit_5_percent_mm: [0.45, null],
    limit_50_percent_mm: [0.5, null],
    limit_95_percent_mm: [0.55, null],
    chatter_probability: [[0, 0], [1, 0.1]],
    seconds: 0.4,
  },
  surface: { spindle_speed_rpm: [4000, 6000], axial_depth_mm: [1], surface_location_error_um: [[-3, null]], peak_to_peak_um: [[8, null]] },
};
