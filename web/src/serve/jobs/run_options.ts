// The options of a verb as they are typed, and the request made of them.
import type { JobRequest, Verb, VerbOption } from '../documents';

/** Of each option: its text, a switch, or the files that were chosen. Nothing: as the verb has it. */
export type Typed = Record<string, string | boolean | string[]>;

type Parsed = { value: unknown } | { wrong: string } | null; // null: not given

function numbersIn(text: string): number[] | null {
  const numbers = text.trim().split(/\s*[,;]\s*|\s+/).map((part) => (part === '' ? NaN : Number(part)));
  return numbers.every(Number.isFinite) ? numbers : null;
}

function numbersOf({ count }: VerbOption, text: string): Parsed {
  const numbers = numbersIn(text);
  if (numbers === null) return { wrong: 'Numbers are needed, with commas between them.' };
  return count && numbers.length !== count ? { wrong: `${count} numbers are needed.` } : { value: numbers };
}

function pointOf(text: string): number[] | null {
  const numbers = numbersIn(text);
  return numbers?.length === 2 && numbers[0]! > 0 ? numbers : null;
}

/** What the request has for an option. */
export function parseOption(option: VerbOption, typed: Typed[string] | undefined): Parsed {
  const given = typeof typed === 'string' ? typed.trim() : typed;
  if (given === undefined || given === '' || given === false || (Array.isArray(given) && given.length === 0)) {
    return option.required ? { wrong: 'Needed.' } : null;
  }
  if (typeof given !== 'string') return { value: given };
  switch (option.takes) {
    case 'whole':
      return /^\d+$/.test(given) ? { value: Number(given) } : { wrong: 'A whole number is needed.' };
    case 'number':
      return Number.isFinite(Number(given)) ? { value: Number(given) } : { wrong: 'A number is needed.' };
    case 'numbers':
      return numbersOf(option, given);
    case 'texts':
      return { value: given.split(/\s*[,;]\s*|\s+/).filter((part) => part !== '') };
    case 'point': {
      const point = pointOf(given);
      return point ? { value: point } : { wrong: 'A spindle speed and a depth are needed, for example 6500, 0.8.' };
    }
    case 'points': {
      const points = given.split(';').filter((part) => part.trim() !== '').map(pointOf);
      return points.includes(null) ? { wrong: 'Pairs of spindle speed and depth are needed, for example 6500, 0.8; 8000, 1.' } : { value: points };
    }
    default:
      return { value: given };
  }
}

/** What is wrong with each option, by its name. */
export function wrongOptions({ options }: Verb, typed: Typed): Record<string, string> {
  const wrong: Record<string, string> = {};
  for (const option of options) {
    const parsed = parseOption(option, typed[option.name]);
    if (parsed && 'wrong' in parsed) wrong[option.name] = parsed.wrong;
  }
  return wrong;
}

/** The request, of options that are all right. */
export function jobRequest(verb: Verb, inputs: string[], output: string, typed: Typed): JobRequest {
  const options: Record<string, unknown> = {};
  for (const option of verb.options) {
    const parsed = parseOption(option, typed[option.name]);
    if (parsed && 'value' in parsed) options[option.name] = parsed.value;
  }
  return { verb: verb.verb, input: verb.several ? inputs : inputs[0]!, output: output.trim(), options };
}
