// What is recorded for the page alone: a monitored recording, a smoothed program's motion.
import type { Band } from './bands';
import type { Num, Owner, Remarks } from './parts_of_documents';

/** One point after another in the work frame. */
export interface Places {
  x_mm: number[];
  y_mm: number[];
  z_mm: number[];
}

export type MonitorState = 'stable' | 'transition' | 'chatter' | 'blind';

/** A state, and why the monitor could not tell where it is blind: "no-signal", "clipped", "speed-unknown", "gap", "standstill", "overloaded". */
interface Stated {
  state: MonitorState;
  reason: string | null;
}

export interface MonitorStay extends Stated {
  from_s: number;
  to_s: number;
}

/** Why no speed is suggested: a mode of the arm, perhaps one, modes that couple through the force, a line that may be folded, or forced vibration. */
export type NoSpeed = 'arm' | 'unclear' | 'mode-coupling' | 'ambiguous-alias' | 'forced-vibration';

/** What the line of chatter may be that was measured, folded: empty where it is as measured. Why no speed is named. */
export interface Folded {
  line_frequencies_hz: number[];
  no_speed: NoSpeed | null;
}

/** What an alarm and an event say of chatter. */
interface OfChatter extends Folded {
  chatter_frequency_hz: Num;
  chatter_frequency_std_hz: Num;
  hidden: 'locked' | 'period-doubling' | null;
  mode: Num;
  mode_of: Owner | null;
  suggested_spindle_speed_rpm: Num;
}

/** Alarms of about one frequency that follow each other; of their frequencies chatter_frequency_hz is the surest. */
export interface MonitorAlarm extends OfChatter {
  count: number;
  from_s: number;
  to_s: number;
  chatter_s: number;
  low_frequency_hz: Num;
  high_frequency_hz: Num;
  channel: string | null;
}

/** A line of events.jsonl. */
export interface MonitorEvent extends Stated, OfChatter {
  time_s: number;
  event: 'state' | 'window' | 'fault' | 'stream' | 'recording';
  score: Num;
  threshold: Num;
  command: 'spindle-speed' | 'feed' | 'hold' | 'release' | 'none' | null; // that followed by a rule of [act]
  faults: string[];
  what?: string | null; // of a stream
  file?: string | null; // of a recording
  message?: string; // of a stream, or why the command
}

/** A row a frequency, up to the highest that is worth drawing; null in gaps. */
export interface Spectrogram {
  channel: string;
  begin_s: number;
  step_s: number;
  max_frequency_hz: number;
  frequency_hz: number[];
  level_db: Num[][];
}

/** A monitored recording. */
export interface Monitor extends Remarks {
  unit: string;
  wave_run_s: number;
  channels: { name: string; wave: Band }[];
  spectrogram: Spectrogram | null;
  teeth: Num;
  decisions: Record<'score' | 'threshold' | 'energy_entropy' | 'chatter_frequency_hz' | 'spindle_speed_rpm' | 'spindle_speed_std_rpm', Band> & { run_s: number };
  decision_count: number;
  compute_mean_us: Num; // of one decision
  compute_max_us: Num;
  stays: MonitorStay[];
  state_times: (Stated & { duration_s: number })[];
  alarm_count: number;
  alarms: MonitorAlarm[];
  events: MonitorEvent[];
}

/** Joints' bands in their unit by time. */
export interface JointMotion {
  unit: 'deg' | 'mm';
  velocity: Band;
  acceleration: Band;
  jerk: Band;
  tracking_error: Band | null;
}

/** A method's trajectory over time: bands over runs of run_s each. */
export interface Motion {
  run_s: number;
  tip_speed_mm_per_s: Band;
  axis_speed_deg_per_s: Band;
  joints: JointMotion[];
  tip: Places & { speed_mm_per_s: number[] };
  corner_paths: FlatPlaces[]; // one a corner
}

/** In the plane of a corner: x along the way, y to the inside. */
export interface FlatPlaces {
  x_mm: number[];
  y_mm: number[];
}

export interface Corner {
  line: number;
  turn_deg: number;
  radius_mm: number;
  program: FlatPlaces;
}

/** What is recorded of a smoothed program for the page alone. */
export interface MotionDocument {
  program: Places;
  corners: Corner[];
  motions: Motion[]; // one a method, in the order of smooth.json
}
