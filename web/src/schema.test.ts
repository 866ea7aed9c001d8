/// <reference types="vite/types/importMeta.d.ts" />
// Every sample of a document whose type comes from its schema, in files *_sample.ts and in the sample report, fits that schema.
import { Ajv2020 } from 'ajv/dist/2020';
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { versions } from '#schema/documents';
import { lobesSample } from './lobes_sample';
import { read } from './parse';
import { sampleReport } from './report_sample';

const ajv = new Ajv2020({ allErrors: true, allowUnionTypes: true });
const schemas = new Map(
  Object.entries(versions).map(([name, version]) => [version, ajv.compile(JSON.parse(readFileSync(`schema/${name}.json.schema.json`, 'utf8')))]),
);

function named(value: unknown): value is { document: (typeof versions)[keyof typeof versions] } {
  return typeof value === 'object' && value !== null && 'document' in value;
}

const files = import.meta.glob<Record<string, unknown>>('./**/*_sample.ts', { eager: true });
const samples = [...Object.values(files), { ...sampleReport() }].flatMap((values) => Object.entries(values).map(([name, value]) => ({ name, value }))).filter(({ value }) => named(value) && read.some((name) => versions[name] === value.document));

/** What does not fit the schema. A report leaves out columns of blocks that say nothing. */
function faults(value: unknown): string[] {
  const fits = named(value) && schemas.get(value.document);
  if (!fits) return ['names no known document'];
  const all = fits(value) ? [] : fits.errors!.filter(({ instancePath, keyword }) => instancePath !== '/blocks' || keyword !== 'required');
  return all.map(({ instancePath, message }) => `${instancePath} ${message}`);
}

describe('samples', () => {
  it.each(samples)('$name fits', ({ value }) => expect(faults(value)).toEqual([]));
  it('are there of every document that is read', () => {
    const found = samples.map(({ value }) => named(value) && value.document);
    for (const name of read) expect(found).toContain(versions[name]);
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
