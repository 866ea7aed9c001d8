import { describe, expect, it } from 'vitest';
import { lobesSample } from './lobes_sample';
import { requireDocument, requireReport } from './parse';

describe('a document', () => {
  it('is read by the name that it gives itself', () => {
    expect(() => requireDocument(['lobes'], lobesSample)).not.toThrow();
    expect(() => requireDocument(['lobes'], { ...lobesSample, document: 'lobes/99' })).toThrow('This page reads lobes/1, but the data is lobes/99.');
    const { document: _, ...unnamed } = lobesSample;
    for (const data of [unnamed, null, 'lobes/1']) expect(() => requireDocument(['lobes'], data)).toThrow('This page reads lobes/1, but the data does not name itself.');
  });
  it('may be one of several', () => {
    expect(() => requireDocument(['lobes', 'sweep'], lobesSample)).not.toThrow();
    expect(() => requireDocument(['comparison', 'sweep'], lobesSample)).toThrow('This page reads comparison/1 or sweep/1, but the data is lobes/1.');
  });
  it('of a report too', () => {
    expect(() => requireReport({ title: 'a', lobes: lobesSample, files: [] })).not.toThrow();
    expect(() => requireReport({ title: 'a', lobes: null })).not.toThrow();
    expect(() => requireReport({ title: 'a', lobes: {} })).toThrow('This page reads lobes/1');
    for (const data of [null, {}, 'x']) expect(() => requireReport(data)).toThrow('The data is no report.');
  });
});
