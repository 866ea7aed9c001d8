// A number that is taken when it was typed.
import { useState } from 'preact/hooks';

interface NumberBoxProps {
  label: string;
  shown: string; // the value, while nobody types
  range: [min: number, max: number];
  disabled?: boolean;
  wrong?: boolean;
  set: (value: number) => void; // inside the range
}

/** What typed text stands for: a number inside the range, or nothing. */
export function typedNumber(typed: string, [min, max]: [number, number]): number | null {
  const value = typed.trim() === '' ? NaN : Number(typed);
  return Number.isFinite(value) ? Math.min(max, Math.max(min, value)) : null;
}

export function NumberBox({ label, shown, range, disabled, wrong, set }: NumberBoxProps) {
  const [draft, setDraft] = useState<string | null>(null);
  const commit = (typed: string) => {
    setDraft(null);
    const value = typedNumber(typed, range);
    if (value !== null) set(value);
  };
  return (
    <input
      type="number"
      aria-label={label}
      aria-invalid={wrong}
      min={range[0]}
      max={range[1]}
      step="any"
      value={draft ?? shown}
      disabled={disabled}
      onInput={({ currentTarget }) => setDraft(currentTarget.value)}
      onChange={({ currentTarget }) => commit(currentTarget.value)}
      onBlur={() => setDraft(null)} // a browser says nothing of a text that is again what it was
    />
  );
}
