// lobes.json with all of its parts, of a sweep and of methods, for tests.
import type { ComparisonDocument, LobesDocument, LobesPoint, PosturesDocument, SweepDocument } from './documents';

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

const effort = { method: 'collocation', period: 'tooth', evaluations: 120, unsettled: 0, uncertain: 1, seconds: 0.2 } as const;

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
  ...effort,
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

const { axial_depth_mm: _, limit_depth_mm: __, margin: ___, ...swept } = pointSample;

export const sweepSample: SweepDocument = {
  document: 'sweep/1',
  sweep: 'lead',
  spindle_speed_rpm: [4000, 6000, 8000],
  lead_deg: [-10, 0, 10],
  spectral_radius: [
    [1.2, 1.1, 1.3],
    [0.9, 1.05, 0.8],
    [0.7, 0.8, 0.6],
  ],
  boundary: [],
  stable: [
    { spindle_speed_rpm: 4000, intervals: [[-3, 10]] },
    { spindle_speed_rpm: 6000, intervals: [[2, 10]] },
    { spindle_speed_rpm: 8000, intervals: [] },
  ],
  points: [{ ...swept, spindle_speed_rpm: 5900, lead_deg: 1 }],
  ...effort,
};

export const comparisonSample: ComparisonDocument = {
  document: 'comparison/1',
  spindle_speed_rpm: [4000, 6000],
  methods: [
    { method: 'collocation', limit_mm: [0.5, null], median_error: 0, worst_error: 0, differ: 0, rejection: '', seconds: 1 },
    { method: 'zeroth-order', limit_mm: [], median_error: null, worst_error: null, differ: 0, rejection: 'a ball end', seconds: 0 },
    { method: 'multi-frequency', limit_mm: [0.55, 1.5], median_error: 0.1, worst_error: 0.1, differ: 1, rejection: '', seconds: 2 },
  ],
};

const axis: [number, number, number] = [0, 0, 1];
const posture = { joints_deg: [0, 10, 20, 0, 60, 0], axis, gamma_deg: 90 };

export const posturesSample: PosturesDocument = {
  document: 'postures/1',
  spindle_speed_rpm: [4000, 6000],
  postures: [
    { ...posture, number: 1, tip_mm: [1270, 0, 776], limit_mm: [0.5, null] },
    { ...posture, number: 2, tip_mm: [1670, 0, 776], limit_mm: [0.4, 1.5] },
    { ...posture, number: 3, tip_mm: [1270, 0, 776], gamma_deg: 150, limit_mm: [0.45, 1.25] },
  ],
  directions: [
    { direction: 'x', postures: [1, 2], spread: 0.22, speeds: 1 },
    { direction: 'gamma', postures: [1, 3], spread: null, speeds: 0 },
  ],
};
