// Where data becomes documents: one that has a schema names itself, as "lobes/1", and is read by that name alone.
import { versions, type Documents } from '#schema/documents';
import type { Report } from './documents';
import type { ServeConfig } from './serve/documents';

function isObject(value: unknown): value is object {
  return typeof value === 'object' && value !== null;
}

/** What the application has in place of a report. */
export function isConfig(data: unknown): data is ServeConfig {
  return isObject(data) && 'token' in data;
}

function requireName(known: string[], value: unknown): void {
  const own = isObject(value) && 'document' in value ? `is ${String(value.document)}` : 'does not name itself';
  if (!known.some((name) => own === `is ${name}`)) throw new Error(`This page reads ${known.join(' or ')}, but the data ${own}.`);
}

/** One of these documents. @throws Error where it is another, or of another version than this page reads */
export function requireDocument<Name extends keyof Documents>(names: Name[], value: unknown): asserts value is Documents[Name] {
  requireName(names.map((name) => versions[name]), value);
}

/** Those of a report, under their names, whose types come from their schemas. */
export const read = ['blocks', 'comparison', 'lobes', 'sweep'] as const;

/** A report; null in the place of a document: it has none. @throws Error as requireDocument */
export function requireReport(data: unknown): asserts data is Report {
  if (!isObject(data) || !('title' in data)) throw new Error('The data is no report.');
  const parts = new Map<string, unknown>(Object.entries(data));
  for (const name of read) {
    const part = parts.get(name) ?? null;
    if (part !== null) requireName([versions[name]], part);
  }
}
