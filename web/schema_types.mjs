// node schema_types.mjs FROM TO: of each JSON document's schema FROM/NAME.json.schema.json the module TO/NAME.ts, its type and what its keys mean, and a copy of the schema;
// and TO/documents.ts, all of them by name. TO is replaced.
import { copyFileSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { compile } from 'json-schema-to-typescript';

const ending = '.json.schema.json';
const symbols = { um: 'µm', deg: '°' };

/** "N·m" of "N m". */
function shownUnit(unit) {
  return unit.replace(/[a-z]+/gi, (word) => symbols[word] ?? word).replace(/ /g, '·').replace(/\^2/g, '²').replace(/\^3/g, '³');
}

/** "the limit [mm]" as unit and meaning. A unit has no comma: "[re, im]" is none. */
function described(description = '') {
  const [, meaning, unit] = /^(.*) \[([^,\]]+)\]$/.exec(description) ?? [];
  return unit === undefined ? { unit: '', meaning: description } : { unit: shownUnit(unit), meaning };
}

/** With the definition of each table in the places that refer to it. */
function inlined(node, definitions) {
  if (Array.isArray(node)) return node.map((one) => inlined(one, definitions));
  if (typeof node !== 'object' || node === null) return node;
  const { $ref, $defs: _, ...own } = node;
  const whole = $ref === undefined ? own : { ...definitions[$ref.replace('#/$defs/', '')], ...own };
  return Object.fromEntries(Object.entries(whole).map(([key, value]) => [key, inlined(value, definitions)]));
}

/** The keys of a table and of those in it, by their paths: "limit.axial_depth_mm". */
function keysOf(schema, before = '') {
  return Object.entries(schema.properties ?? {}).flatMap(([key, value]) => {
    const path = before + key;
    return [[path, described(value.description)], ...keysOf(value.items ?? value.anyOf?.[0] ?? value, `${path}.`)];
  });
}

function typeName(name) {
  return `${name.replace(/(^|[^a-z0-9])([a-z])/gi, (_, __, letter) => letter.toUpperCase())}Document`;
}

const [from, to] = process.argv.slice(2);
rmSync(to, { recursive: true, force: true });
mkdirSync(to);
const documents = readdirSync(from)
  .filter((file) => file.endsWith(ending))
  .map((file) => {
    const name = file.slice(0, -ending.length);
    const type = typeName(name);
    const written = JSON.parse(readFileSync(join(from, file), 'utf8'));
    return { name, file, type, schema: { ...inlined(written, written.$defs), title: type } };
  });
for (const { name, file, type, schema } of documents) {
  const text = await compile(schema, type, { bannerComment: '', additionalProperties: false });
  writeFileSync(join(to, `${name}.ts`), `${text}\nexport const keys = ${JSON.stringify(Object.fromEntries(keysOf(schema)), null, 2)} as const;\n`);
  copyFileSync(join(from, file), join(to, file));
}
const list = (row) => documents.map(row).join('\n');
writeFileSync(
  join(to, 'documents.ts'),
  `${list(({ name, type }) => `import type { ${type} } from './${name}';`)}

export interface Documents {
${list(({ name, type }) => `  ${name}: ${type};`)}
}

/** What each calls itself. */
export const versions = {
${list(({ name, schema }) => `  ${name}: '${schema.properties.document.const}',`)}
} as const;
`,
);
