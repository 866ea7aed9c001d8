// What is said and drawn of a monitored recording, made of its document.
import type { Monitor, MonitorAlarm, MonitorStay, NoSpeed, Num } from './documents';
import { fixed, modeName, withDeviation } from './text';

/** What the line of chatter may be that was measured, folded: empty where it is as measured. Why no speed is named. */
type Folded = Pick<MonitorAlarm, 'line_frequencies_hz' | 'no_speed'>;

const reasonTexts: Record<string, string> = {
  'no-signal': 'no usable signal',
  clipped: 'signal at the limit of its converter',
  'speed-unknown': 'spindle speed unknown',
  gap: 'samples lost',
  standstill: 'the spindle stands still',
  overloaded: 'the monitor was too slow for the samples',
  learning: 'the monitor has not seen a calm yet',
  none: 'reason unknown',
};

/** Why the monitor could not tell, in words. */
export function reasonText(reason: string | null): string {
  return reasonTexts[reason ?? 'none'] ?? reason ?? '';
}

const faultTexts: Record<string, string> = {
  'not-finite': 'samples that are no number',
  stuck: 'a channel is stuck',
  clipped: 'signal at the limit of its converter',
  'dead-channel': 'a channel is dead',
  'wrong-sample-rate': 'the sample rate is another one',
  'speed-unknown': 'spindle speed unknown',
};

/** What is wrong with the input, in words. */
export function inputFaultText(fault: string): string {
  return faultTexts[fault] ?? fault;
}

const noSpeedTexts: Record<NoSpeed, string> = {
  arm: 'no spindle speed avoids it: a mode of the arm',
  unclear: 'no spindle speed is suggested: it may be a mode of the arm',
  'mode-coupling': 'no spindle speed avoids it: modes couple through the force',
  'forced-vibration': 'no spindle speed is suggested: the tip would vibrate by more than the feed per tooth',
  'ambiguous-alias': '', // aliasText says it
};

/** Why no speed is suggested, in words; empty where one is, or nothing is known. */
export function noSpeedText(reason: NoSpeed | null): string {
  return reason === null ? '' : noSpeedTexts[reason];
}

const hiddenTexts = { locked: 'locked to the rotation', 'period-doubling': 'period doubling' };

/** How chatter hides in what repeats with the spindle, what a folded line is, and why no speed is suggested. */
export function chatterNotes(of: Pick<MonitorAlarm, 'hidden' | keyof Folded>): string[] {
  return [of.hidden === null ? '' : hiddenTexts[of.hidden], aliasText(of), noSpeedText(of.no_speed)].filter((text) => text !== '');
}

/** "0.63 s", "12.4 s", "5 min 20 s", "2 h 5 min" */
export function duration(seconds: number): string {
  if (seconds < 99.95) return `${seconds < 9.995 ? seconds.toFixed(2) : seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${whole % 60} s`;
  const minutes = Math.round(seconds / 60);
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** "683.20 ± 0.60" of one frequency, "682 to 696" of a range. */
export function frequencyText({ low_frequency_hz: low, high_frequency_hz: high, chatter_frequency_hz: surest, chatter_frequency_std_hz: deviation }: MonitorAlarm): string {
  const decimals = high !== null && high < 100 ? 1 : 0;
  if (low !== null && high !== null && fixed(low, decimals) !== fixed(high, decimals) && high - low > 4 * (deviation ?? 0)) {
    return `${fixed(low, decimals)} to ${fixed(high, decimals)}`;
  }
  return withDeviation(surest, deviation, 1, 1);
}

function listed(parts: string[], last = 'and'): string {
  return parts.length < 2 ? parts.join('') : `${parts.slice(0, -1).join(', ')} ${last} ${parts[parts.length - 1]}`;
}

/** "989.0 Hz folded", or why neither mode nor speed is named; empty of a line that is as measured. */
export function aliasText({ line_frequencies_hz: lines, no_speed: reason }: Folded): string {
  if (lines.length === 0) return '';
  const text = `${listed(lines.map((line) => fixed(line, 1)), 'or')} Hz`;
  return reason === 'ambiguous-alias' ? `no mode, no speed: no anti-alias filter is stated, it may be ${text}` : `${text} folded`;
}

/** " at 683.20 ± 0.60 Hz (mode 8; quiet near 3416 rpm)"; of many rows the longest three. */
function placesText(alarms: MonitorAlarm[]): string {
  const heard = alarms.filter(({ chatter_frequency_hz: frequency }) => frequency !== null);
  const longest = [...heard].sort((a, b) => b.chatter_s - a.chatter_s).slice(0, 3);
  if (longest.length === 0) return '';
  const texts = longest.map((alarm) => {
    const quiet = alarm.suggested_spindle_speed_rpm;
    const more = [modeName(alarm), aliasText(alarm), quiet === null ? noSpeedText(alarm.no_speed) : `quiet near ${fixed(quiet, 0)} rpm`].filter((text) => text !== '');
    return `${frequencyText(alarm)} Hz${more.length > 0 ? ` (${more.join('; ')})` : ''}`;
  });
  return `, at ${listed(texts)}${heard.length > longest.length ? ' and others' : ''}`;
}

/** A finding: what it is, and the rest of its sentence. */
export interface Finding {
  head: string;
  text: string;
}

/** What was found, in plain words: alarms first, then what could not be judged, then what was. */
export function findings({ state_times: times, alarm_count: count, alarms }: Monitor): Finding[] {
  const lasted = (wanted: string) => times.filter(({ state }) => state === wanted).reduce((sum, { duration_s }) => sum + duration_s, 0);
  const [chatter, blind, stable, transition] = [lasted('chatter'), lasted('blind'), lasted('stable'), lasted('transition')];
  const out: Finding[] = [];
  if (count > 0) {
    const from = Math.min(...alarms.map(({ from_s }) => from_s));
    const to = Math.max(...alarms.map(({ to_s }) => to_s));
    const when = alarms.length > 0 ? `, between ${fixed(from, 2)} s and ${fixed(to, 2)} s` : '';
    out.push({ head: 'Chatter', text: ` for ${duration(chatter)} in ${count} ${count === 1 ? 'alarm' : 'alarms'}${when}${placesText(alarms)}.` });
  } else if (stable + transition > 0) {
    out.push({ head: 'No alarm', text: ` in the ${duration(stable + transition)} that ${blind > 0 ? 'could be' : 'were'} judged.` });
  }
  if (blind > 0) {
    const reasons = times
      .filter(({ state }) => state === 'blind')
      .sort((a, b) => b.duration_s - a.duration_s)
      .map(({ reason, duration_s }) => `${reasonText(reason)}, for ${duration(duration_s)}`);
    out.push({ head: 'Cannot tell', text: `: ${reasons.join('; ')}. Whether it chattered then is not known.` });
  }
  if (times.length === 0) out.push({ head: 'Cannot tell', text: ': no decision was made.' });
  const between = transition > 0 ? `; on the way to an alarm or back for ${duration(transition)}` : '';
  if (stable > 0) out.push({ head: 'Stable', text: ` for ${duration(stable)}${between}.` });
  return out;
}

const severity = ['stable', 'transition', 'blind', 'chatter'];

/** The stays that are not stable; of very many those that would touch on the screen as one, in the worst of their states. */
export function shadedStays(stays: MonitorStay[], most = 400): MonitorStay[] {
  const shaded = stays.filter(({ state }) => state !== 'stable');
  if (shaded.length <= most) return shaded;
  const apart = (shaded[shaded.length - 1]!.to_s - shaded[0]!.from_s) / most;
  const out: MonitorStay[] = [];
  for (const stay of shaded) {
    const last = out[out.length - 1];
    if (last === undefined || stay.to_s - last.from_s > apart) {
      out.push({ ...stay });
    } else {
      last.to_s = stay.to_s;
      if (severity.indexOf(stay.state) > severity.indexOf(last.state)) Object.assign(last, { state: stay.state, reason: stay.reason });
    }
  }
  return out;
}

/** Where marks of chatter's frequency go: at each run's lowest and highest one that is not near a mark before, in time (a fiftieth of the span) and frequency. */
export function chatterMarks({ decisions: { run_s, chatter_frequency_hz: of } }: Monitor, span_s: number): { time_s: number[]; frequency_hz: number[] } {
  const time_s: number[] = [];
  const frequency_hz: number[] = [];
  const isMarked = (time: number, frequency: number) => {
    for (let i = time_s.length - 1; i >= 0 && time - time_s[i]! < span_s / 50; --i) {
      if (Math.abs(frequency_hz[i]! / frequency - 1) < 0.02) return true;
    }
    return false;
  };
  of.low.forEach((low, run) => {
    for (const frequency of [low, of.high[run] ?? null]) {
      if (frequency === null || isMarked(run * run_s, frequency)) continue;
      time_s.push(run * run_s);
      frequency_hz.push(frequency);
    }
  });
  return { time_s, frequency_hz };
}

/** A stretch over which the speed is known. */
export interface SpeedStretch {
  time_s: number[];
  speed_rpm: number[];
  low_rpm: number[]; // with the standard deviation, where it is known
  high_rpm: number[];
}

/** The tracked speed, each run's from its begin to the next one's: a stretch for each time that it is known without a break. */
export function speedStretches({ decisions: { run_s, spindle_speed_rpm: speed, spindle_speed_std_rpm: deviation } }: Monitor): SpeedStretch[] {
  const out: SpeedStretch[] = [];
  let open: SpeedStretch | null = null;
  const put = (stretch: SpeedStretch, run: number, from: number) => {
    const low = speed.low[from]!;
    const high = speed.high[from]!;
    const spread = deviation.high[from] ?? 0;
    stretch.time_s.push(run * run_s);
    stretch.speed_rpm.push(0.5 * (low + high));
    stretch.low_rpm.push(low - spread);
    stretch.high_rpm.push(high + spread);
  };
  speed.low.forEach((low: Num, run) => {
    if (low !== null) {
      if (open === null) out.push((open = { time_s: [], speed_rpm: [], low_rpm: [], high_rpm: [] }));
      put(open, run, run);
    }
    if (open !== null && (speed.low[run + 1] ?? null) === null) {
      put(open, run + 1, run);
      open = null;
    }
  });
  return out;
}

/** A line with gaps. */
export interface GappedLine {
  x: Num[];
  y: Num[];
}

/** The multiples of a frequency that follows the speed, all in one line with gaps. */
export function multiplesOver(stretches: SpeedStretch[], perTurn: number, multiples: number[], highest_hz: number): GappedLine {
  const out: GappedLine = { x: [], y: [] };
  for (const multiple of multiples) {
    for (const { time_s, speed_rpm } of stretches) {
      const y = speed_rpm.map((speed) => (multiple * perTurn * speed) / 60);
      if (!y.some((frequency) => frequency <= highest_hz)) continue;
      out.x.push(...time_s, null);
      out.y.push(...y, null);
    }
  }
  return out;
}
