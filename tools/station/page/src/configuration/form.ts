// The form of one map of the configuration, made from its keys in the schema.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { live } from 'lit-html/directives/live.js';
import { t } from '../i18n';
import { html } from '../markup';
import { alternativesOf, fieldsOf } from './schema';
import type { Field, Schema } from './schema';
import { childOf, lineOf, nodeAt } from './yaml_tree';
import type { Child, Node, Path } from './yaml_tree';

export interface Form {
  root: Schema;
  schema: Schema | undefined;
  text: string;
  tree: Node | undefined;
  path: Path;
  faults: ReadonlyMap<string, string>;  // by path
  kept: ReadonlyMap<number, string>;  // lines that must not change, and why
  set(path: Path, value: string, field: Field): void;
  show(child: Child): void;
}

const idOf = (path: Path): string => `key-${path.join('-').replace(/[^\w-]/g, '_')}`;
export const keyOf = (path: Path): string => path.join('\n');

// Inputs with text that is not part of the draft yet. A new view keeps this text: results arrive while somebody types.
const typed = new WeakSet<Element>();
const typing = (event: Event): void => { typed.add(event.target as Element); };
const left = (event: Event): void => { typed.delete(event.target as Element); };

function shownIn(id: string, value: string): string {
  const element = document.getElementById(id);
  return element && typed.has(element) ? (element as HTMLInputElement).value : value;
}

// The value of a field; undefined if its text has several lines.
function valueOf(text: string, child: Child | undefined, field: Field): string | undefined {
  const { node } = child ?? {};
  if (!node) return '';
  if (node.kind === 'scalar') return node.value.includes('\n') ? undefined : node.value;
  const source = text.slice(node.start, node.end);
  return source.includes('\n') || field.kind !== 'yaml' ? undefined : source;
}

function input(form: Form, field: Field, path: Path, value: string, why: string | undefined): TemplateResult {
  const id = idOf(path), { schema } = field;
  const change = (event: Event): void => {
    left(event);
    form.set(path, (event.target as HTMLInputElement).value.trim(), field);
  };
  const about = `${id}-about`, off = why !== undefined;
  if (field.kind === 'choice' || field.kind === 'switch') {
    const choices = field.kind === 'switch' ? ['true', 'false'] : field.choices;
    return html`<select id=${id} aria-describedby=${about} .value=${live(value)} ?disabled=${off} @change=${change}>
      <option value="">${t('configuration.default')}</option>
      ${[...choices, ...(value && !choices.includes(value) ? [value] : [])].map((each) => html`<option value=${each} ?selected=${each === value}>${each}</option>`)}</select>`;
  }
  return html`<input id=${id} aria-describedby=${about} aria-required=${field.required} autocomplete="off" spellcheck="false"
      type=${field.kind === 'number' ? 'number' : 'text'} step="any" min=${schema.minimum ?? nothing} max=${schema.maximum ?? nothing}
      maxlength=${field.kind === 'text' && schema.maxLength ? schema.maxLength : nothing} list=${field.choices.length ? `${id}-list` : nothing}
      .value=${live(shownIn(id, value))} ?disabled=${off} @input=${typing} @change=${change} @blur=${left}>
    ${field.choices.length ? html`<datalist id=${`${id}-list`}>${field.choices.map((each) => html`<option value=${each}></option>`)}</datalist>` : nothing}`;
}

function fieldRow(form: Form, field: Field, path: Path, child: Child | undefined): TemplateResult {
  const id = idOf(path), fault = form.faults.get(keyOf(path));
  const value = valueOf(form.text, child, field), line = child ? lineOf(form.text, child.start) : 0;
  const why = child && form.kept.get(line);
  return html`<div class=${fault ? 'field faulty' : 'field'}>
    <label for=${id}>${field.key}${field.required ? html` <span class="muted">${t('configuration.required')}</span>` : nothing}</label>
    ${value === undefined ? html`<button type="button" id=${id} @click=${() => form.show(child!)}>${t('configuration.in-text', { line })}</button>` : input(form, field, path, value, why)}
    <p id=${`${id}-about`} class="muted">${fault ? html`<strong class="bad">▲ ${fault}</strong> ` : nothing}${
      why ? `${t('configuration.protected-line', { why })} ` : nothing}${field.description}</p></div>`;
}

function mapRow(form: Form, field: Field, path: Path, child: Child | undefined): TemplateResult {
  if (child?.node?.kind === 'scalar') return fieldRow(form, { ...field, kind: 'text' }, path, child);
  return html`<details class="map" ?open=${child !== undefined}><summary>${field.key}</summary>
    ${field.description ? html`<p class="muted">${field.description}</p>` : nothing}${formFields({ ...form, path, schema: field.schema })}</details>`;
}

// Keys that are set or needed first, the others in a part that opens.
export function formFields(form: Form): TemplateResult {
  const map = nodeAt(form.tree, form.path), alternatives = alternativesOf(form.schema);
  const open = alternatives.every((key) => !childOf(map, key));
  const rows = fieldsOf(form.root, form.schema).map((field) => {
    const path = [...form.path, field.key], child = childOf(map, field.key);
    return { first: field.required || child !== undefined || (open && alternatives.includes(field.key)), row: field.kind === 'map' ? mapRow(form, field, path, child) : fieldRow(form, field, path, child) };
  });
  const more = rows.filter(({ first }) => !first);
  return html`${rows.filter(({ first }) => first).map(({ row }) => row)}
    ${more.length ? html`<details class="more"><summary>${t('configuration.more', { n: more.length })}</summary>${more.map(({ row }) => row)}</details>` : nothing}`;
}
