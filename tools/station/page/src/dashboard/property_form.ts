// Fields for the properties of a widget, made from the table of kinds.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { t, word } from '../i18n';
import { html } from '../markup';
import type { PropertyRow } from './document';

type Set = (value: unknown) => void;  // undefined removes the property
type Extra = (row: PropertyRow, index: number) => unknown;  // more for an item of a list

const labelOf = (row: PropertyRow): string => word('property', row.name ?? '');
const textOf = (event: Event): string => (event.target as HTMLInputElement).value;

// "12" and "true" become a number and a boolean; anything else stays a text.
export function valueOf(text: string): string | number | boolean {
  if (text === 'true' || text === 'false') return text === 'true';
  return text.trim() !== '' && Number.isFinite(Number(text)) ? Number(text) : text;
}

function input(row: PropertyRow, value: unknown, set: Set): TemplateResult {
  const optional = (text: string): string | undefined => (text === '' && !row.required ? undefined : text);
  const names = row.type === 'channel' || row.type === 'pattern' ? 'channel-names' : row.name === 'picture' ? 'picture-names' : nothing;
  const shown = value === undefined ? '' : String(value);
  switch (row.type) {
    case 'flag':
      return html`<input type="checkbox" .checked=${value === true} @change=${(event: Event) => set((event.target as HTMLInputElement).checked || undefined)}>`;
    case 'choice':
      return html`<select @change=${(event: Event) => set(optional(textOf(event)))}>${row.required ? nothing : html`<option value=""></option>`}
        ${row.choices!.map((choice) => html`<option value=${choice} ?selected=${choice === value}>${word('choice', choice)}</option>`)}</select>`;
    case 'number':
    case 'integer':
      return html`<input type="number" step=${row.type === 'integer' ? 1 : 'any'} min=${row.min ?? nothing} max=${row.max ?? nothing} .value=${shown}
        @change=${(event: Event) => set(textOf(event) === '' ? undefined : Number(textOf(event)))}>`;
    case 'value':
      return html`<input autocomplete="off" .value=${shown} @change=${(event: Event) => set(valueOf(textOf(event)))}>`;
    default:
      return html`<input autocomplete="off" spellcheck="false" list=${names} .value=${shown} maxlength=${row.max ?? nothing}
        @change=${(event: Event) => set(optional(textOf(event).trim()))}>`;
  }
}

function newItem(row: PropertyRow): unknown {
  if (row.type !== 'object') return '';
  const usual: Record<string, unknown> = { number: 50, integer: 0, value: true };
  return Object.fromEntries((row.of as readonly PropertyRow[]).filter((member) => member.required).map((member) => [member.name!, usual[member.type] ?? '']));
}

function list(row: PropertyRow, value: unknown, set: Set, extra: Extra): TemplateResult {
  const items = Array.isArray(value) ? (value as unknown[]) : [], item = row.of as PropertyRow;
  const replace = (index: number, ...next: unknown[]): void => set(items.toSpliced(index, 1, ...next));
  return html`<fieldset><legend>${labelOf(row)}</legend>
    ${items.map((each, index) => html`<div class=${item.type === 'object' ? 'form-item' : 'form-item short'}>
      ${item.type === 'object' ? fields(item.of as readonly PropertyRow[], each as Record<string, unknown>, (next) => replace(index, next)) :
        html`<label class="field"><span class="unseen">${labelOf(row)} ${index + 1}</span>${input(item, each, (next) => replace(index, next ?? ''))}</label>`}
      <span><button type="button" class="small" aria-label="${t('dashboard.remove')} ${labelOf(row)} ${index + 1}" @click=${() => replace(index)}>✕</button>
        ${extra(row, index)}</span></div>`)}
    <button type="button" class="small" ?disabled=${items.length >= (row.max ?? Infinity)} @click=${() => set([...items, newItem(item)])}>+ ${t('dashboard.add')}</button></fieldset>`;
}

// `set` receives a new object; properties that are not in the form are kept.
export function fields(rows: readonly PropertyRow[], object: Readonly<Record<string, unknown>>, set: (next: Record<string, unknown>) => void,
  extra: Extra = () => nothing): TemplateResult {
  const setMember = (name: string) => (value: unknown): void => {
    const next: Record<string, unknown> = { ...object };
    if (value === undefined || (Array.isArray(value) && !value.length)) delete next[name];
    else next[name] = value;
    set(next);
  };
  return html`${rows.map((row) => (row.type === 'list' ? list(row, object[row.name!], setMember(row.name!), extra) :
    html`<label class="field"><span>${labelOf(row)}${row.required ? ' *' : ''}</span>${input(row, object[row.name!], setMember(row.name!))}</label>`))}`;
}
