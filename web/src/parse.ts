// Where data becomes documents: each names itself, as "lobes/1", and is read by that name alone.
import { versions, type Documents } from '#schema/documents';
import { members, type Report } from './documents';
import type { ServeConfig } from './serve/documents';

function isObject(value: unknown): value is object {
  return typeof value === 'object' && value !== null;
}

/** What the application has in place of a report. */
export function isConfig(data: unknown): data is ServeConfig {
  return isObject(data) && 'token' in data;
}

/** One of these documents. @throws Error where it is another, or of another version than this page reads */
export function requireDocument<Name extends keyof Documents>(names: Name[], value: unknown): asserts value is Documents[Name] {
  const known = names.map((name) => versions[name] as string);
  const own = isObject(value) && 'document' in value ? `is ${String(value.document)}` : 'does not name itself';
  if (!known.some((name) => own === `is ${name}`)) throw new Error(`This page reads ${known.join(' or ')}, but the data ${own}.`);
}

/** A report; null in the place of a document: it has none. @throws Error as requireDocument */
export function requireReport(data: unknown): asserts data is Report {
  if (!isObject(data) || !('title' in data)) throw new Error('The data is no report.');
  const parts = new Map<string, unknown>(Object.entries(data));
  for (const [member, name] of Object.entries(members)) {
    const part = parts.get(member) ?? null;
    if (part !== null) requireDocument([name], part);
  }
}
