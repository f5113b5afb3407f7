// Reads the JSON schema of the configuration, which the station makes from the table of keys. A new key needs no change here. Pure.

import type { Path } from './yaml_tree';

export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  type?: string | string[];
  properties?: Record<string, Schema>;
  additionalProperties?: boolean | Schema;
  required?: string[];
  items?: Schema;
  anyOf?: Schema[];
  oneOf?: { required?: string[] }[];
  enum?: (string | number)[];
  pattern?: string;
  minimum?: number;
  maximum?: number;
  minLength?: number;
  maxLength?: number;
  description?: string;
}

export type Kind = 'choice' | 'switch' | 'number' | 'text' | 'map' | 'yaml';

// A key as a form shows it.
export interface Field {
  key: string;
  kind: Kind;
  required: boolean;
  description: string;
  choices: string[];  // of a choice; of a text: proposals
  bare: boolean;  // numbers, true and false are written without quotes
  schema: Schema;
}

export function resolve(root: Schema, schema: Schema | undefined): Schema | undefined {
  const name = schema?.$ref?.match(/^#\/\$defs\/(.+)$/)?.[1];
  if (!schema || !name) return schema;
  const { $ref, ...own } = schema;
  return { ...resolve(root, root.$defs?.[name]), ...own };
}

const typesOf = ({ type }: Schema): string[] => (Array.isArray(type) ? type : type ? [type] : []);

// Alternatives of a value, for instance of a name or a map with it.
const formsOf = (root: Schema, schema: Schema): Schema[] => (schema.anyOf ?? [schema]).map((each) => resolve(root, each)!);

// The schema of the map or value at a path of the configuration.
export function schemaAt(root: Schema, path: Path): Schema | undefined {
  let at = resolve(root, root);
  for (const key of path) {
    const forms: Schema[] = at ? formsOf(root, at) : [];
    const next = forms.map((form) => {
      if (typeof key === 'number') return form.items;
      return form.properties?.[key] ?? (typeof form.additionalProperties === 'object' ? form.additionalProperties : undefined);
    }).find((each) => each);
    at = resolve(root, next);
  }
  return at;
}

const isScalar = (schema: Schema): boolean => schema.enum !== undefined || typesOf(schema).every((type) => type !== 'object' && type !== 'array');

function kindOf(root: Schema, schema: Schema): Kind {
  const forms = formsOf(root, schema);
  if (forms.some(({ properties }) => properties) && !forms.some(isScalar)) return 'map';
  if (!forms.every(isScalar)) return forms.some(isScalar) && forms.some(({ properties }) => properties) ? 'text' : 'yaml';
  if (forms.length > 1) return 'text';
  const types = typesOf(schema);
  if (schema.enum) return 'choice';
  if (types.length === 1 && types[0] === 'boolean') return 'switch';
  return types.length === 1 && (types[0] === 'number' || types[0] === 'integer') ? 'number' : 'text';
}

// Lists of maps are objects of their own: buses, devices, channels.
const isListOfMaps = (root: Schema, schema: Schema): boolean => formsOf(root, schema).some(({ items }) => !!resolve(root, items)?.properties);

export function fieldsOf(root: Schema, schema: Schema | undefined): Field[] {
  const form = schema && formsOf(root, schema).find(({ properties }) => properties);
  return Object.entries(form?.properties ?? {}).flatMap(([key, each]) => {
    const found = resolve(root, each)!;
    if (isListOfMaps(root, found)) return [];
    const forms = formsOf(root, found);
    return [{
      key, kind: kindOf(root, found), required: form!.required?.includes(key) ?? false, description: found.description ?? '',
      choices: forms.flatMap((one) => one.enum ?? []).map(String),
      bare: forms.some((one) => one.enum !== undefined || typesOf(one).some((type) => ['number', 'integer', 'boolean'].includes(type))), schema: found,
    }];
  });
}

// A map needs exactly one of these keys.
export const alternativesOf = (schema: Schema | undefined): string[] => (schema?.oneOf ?? []).flatMap(({ required }) => required ?? []);

// Proposes the names of the known templates for the key `template`; other names stay allowed.
export function withTemplates(root: Schema, names: readonly string[]): Schema {
  const device = root.$defs?.['device'], template = device?.properties?.['template'];
  if (!template) return root;
  const { $ref, ...own } = template, proposed: Schema = { ...own, anyOf: [{ enum: [...names] }, $ref ? { $ref } : {}] };
  return { ...root, $defs: { ...root.$defs, device: { ...device, properties: { ...device.properties, template: proposed } } } };
}

// Returns what may be written at a place: the keys of a map that are still free, or the choices of a value.
export interface Proposal {
  text: string;
  description: string;
}

export function keysAt(root: Schema, path: Path, taken: ReadonlySet<string>): Proposal[] {
  const schema = schemaAt(root, path);
  const forms = schema ? formsOf(root, schema) : [];
  return forms.flatMap(({ properties }) => Object.entries(properties ?? {})).filter(([key]) => !taken.has(key))
    .map(([text, each]) => ({ text, description: resolve(root, each)!.description ?? '' }));
}

export function valuesAt(root: Schema, path: Path): Proposal[] {
  const schema = schemaAt(root, path);
  const forms = schema ? formsOf(root, schema) : [];
  const choices = forms.flatMap((form) => form.enum?.map(String) ?? (typesOf(form).join() === 'boolean' ? ['true', 'false'] : []));
  return choices.map((text) => ({ text, description: schema?.description ?? '' }));
}
