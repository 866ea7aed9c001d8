// A range, a number, a lock and a reset for each key that can be moved.
import { fixed, percent } from '../../text';
import type { ListedMode, Movable } from '../documents';
import { nameOf } from '../files/fields';
import { NumberBox } from '../number_box';
import { Button } from '../pieces';

interface SliderProps extends Movable {
  name: string; // of the key, "tool.teeth"
  first: number; // what reset goes back to
  locked: boolean;
  wrong: string | null;
  lock: (locked: boolean) => void;
  move: (value: number, started: number | null) => void;
  rest: () => void;
}

export function Slider({ name: key, value, min, max, step, first, locked, wrong, lock, move, rest }: SliderProps) {
  const { name, unit } = nameOf(key);
  const id = `slider-${key}`;
  const set = (number: number) => {
    move(number, null);
    rest();
  };
  return (
    <div class="slider" data-key={key}>
      <label for={id}>
        {name}
        {unit && <span class="unit"> ({unit.symbol})</span>}
      </label>
      <input
        id={id}
        type="range"
        min={min}
        max={max}
        step={step}
        value={value}
        disabled={locked}
        onInput={(event) => move(event.currentTarget.valueAsNumber, event.timeStamp)}
        onChange={rest}
      />
      <NumberBox label={`${name}, number${unit ? `, ${unit.words}` : ''}`} shown={String(Number(value.toPrecision(6)))} range={[min, max]} disabled={locked} wrong={wrong !== null} set={set} />
      <label class="lock">
        <input type="checkbox" checked={locked} aria-label={`Lock ${name}`} onChange={({ currentTarget }) => lock(currentTarget.checked)} />
        lock
      </label>
      <Button label={`Reset ${name}`} disabled={locked} act={() => set(Math.min(max, Math.max(min, first)))}>
        reset
      </Button>
      {wrong !== null && <p class="error">{wrong}</p>}
    </div>
  );
}

interface ModesProps {
  modes: ListedMode[];
  kept: number[];
  keep: (numbers: number[]) => void;
}

/** At least one mode stays on. */
export function ModeSwitches({ modes, kept, keep }: ModesProps) {
  if (modes.length === 0) return null;
  const change = (number: number, on: boolean) => keep(modes.map((mode) => mode.number).filter((one) => (one === number ? on : kept.includes(one))));
  const last = kept.length === 1;
  return (
    <fieldset class="modes">
      <legend>Modes</legend>
      {modes.map(({ number, frequency_hz, damping_ratio }) => {
        const on = kept.includes(number);
        return (
          <label>
            <input type="checkbox" checked={on} disabled={on && last} onChange={({ currentTarget }) => change(number, currentTarget.checked)} />
            {number}: {fixed(frequency_hz, 1)} Hz, {percent(damping_ratio, 2)}
          </label>
        );
      })}
      {last && <small>One mode at least stays on.</small>}
    </fieldset>
  );
}
