/// <reference types="vite/types/importMeta.d.ts" />
// Every sample of a document, in files *_sample.ts and in the sample report, fits its schema.
import { Ajv2020 } from 'ajv/dist/2020';
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { versions, type Documents } from '#schema/documents';
import { members } from './documents';
import { lobesSample } from './lobes_sample';
import { sampleReport } from './report_sample';

const ajv = new Ajv2020({ allErrors: true, allowUnionTypes: true });
const schemas = new Map<string, ReturnType<typeof ajv.compile>>(
  Object.entries(versions).map(([name, version]) => [version, ajv.compile(JSON.parse(readFileSync(`schema/${name}.json.schema.json`, 'utf8')))]),
);

function named(value: unknown): value is { document: string } {
  return typeof value === 'object' && value !== null && 'document' in value && typeof value.document === 'string';
}

const files = import.meta.glob<Record<string, unknown>>('./**/*_sample.ts', { eager: true });
const samples = [...Object.values(files), { ...sampleReport() }].flatMap((values) => Object.entries(values).map(([name, value]) => ({ name, value }))).filter(({ value }) => named(value));

/** What a report leaves out of documents: the places of those keys. */
const leftOut: { [Name in keyof Documents]?: RegExp } = {
  blocks: /^\/blocks \w+$/,
  forces: /^(\/blocks\/\d+ \w+| skipped)$/,
  frf: /^ deviation_m_per_n$/,
};

/** What does not fit the schema. */
function faults(value: unknown): string[] {
  const fits = named(value) ? schemas.get(value.document) : undefined;
  if (!named(value) || !fits) return ['names no known document'];
  const out = Object.entries(leftOut).find(([name]) => value.document.startsWith(`${name}/`))?.[1];
  const all = fits(value) ? [] : fits.errors!.filter(({ instancePath, params }) => !out?.test(`${instancePath} ${params['missingProperty']}`));
  return all.map(({ instancePath, message }) => `${instancePath} ${message}`);
}

describe('samples', () => {
  it.each(samples)('$name fits', ({ value }) => expect(faults(value)).toEqual([]));
  it('are there of every document that is read', () => {
    const found = samples.map(({ value }) => named(value) && value.document);
    for (const name of Object.values(members)) expect(found).toContain(versions[name]);
  });
  it('that do not fit are found', () => {
    const { seconds: _, ...without } = lobesSample;
    const limit = lobesSample.limit.map((row) => ({ ...row, kind: 'other' }));
    expect(faults({ ...lobesSample, limit })).toContain('/limit/0/kind must be equal to one of the allowed values');
    expect(faults({ ...lobesSample, extra: 1 })).toEqual([' must NOT have additional properties']);
    expect(faults(without)).toEqual([" must have required property 'seconds'"]);
    expect(faults({ ...lobesSample, document: 'lobes/0' })).toEqual(['names no known document']);
  });
});
