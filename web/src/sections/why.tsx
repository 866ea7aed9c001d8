// Why the monitor alarmed or kept silent: the test and its conditions.
import type { MonitorWhy, Num } from '../documents';
import { DetailsTable } from '../parts';
import { dash, fixed, significant } from '../text';

type Condition = MonitorWhy['conditions'][number];

/** Ratios of energies in dB where the condition is shown so. */
function shownValue(value: Num, { shown_in: unit }: Condition): string {
  if (value === null || (unit === 'dB' && value <= 0)) return dash;
  if (unit === 'dB') return `${fixed(10 * Math.log10(value), 1)} dB`;
  return unit === null ? significant(value) : `${significant(value)} ${unit}`;
}

function thresholdOf(condition: Condition): string {
  const { at_least: least, at_most: most } = condition;
  return most === undefined ? `at least ${shownValue(least ?? null, condition)}` : `at most ${shownValue(most, condition)}`;
}

/** "by ratio, 6 of 6 hops", "by ratio, 6 of 6 hops of sensor 2"; of no alarm the test that came closest, with how much of it holds. */
export function whyText({ test, sensor, hops, of, conditions }: MonitorWhy, alarm: boolean): string {
  const held = conditions.filter(({ holds }) => holds).length;
  const counted = `${test}, ${hops} of ${of} hops${sensor === null ? '' : ` of sensor ${sensor}`}`;
  return alarm ? `by ${counted}` : `closest: ${counted}, ${held} of ${conditions.length} conditions hold`;
}

/** Opens on a click. `alarm`: it explains one, else silence. */
export function Why({ why, alarm }: { why: MonitorWhy; alarm: boolean }) {
  return (
    <DetailsTable
      summary={whyText(why, alarm)}
      caption={`What the test “${why.test}” asks for; belief in the speed ${significant(why.speed_belief)}`}
      columns={[
        { heading: 'Quantity', cell: ({ meaning }) => meaning },
        { heading: 'Value', number: true, cell: (condition) => shownValue(condition.value, condition) },
        { heading: 'Threshold', number: true, cell: thresholdOf },
        { heading: 'Holds', cell: ({ holds }) => (holds ? 'yes' : <strong>no</strong>) },
      ]}
      rows={why.conditions}
    />
  );
}
