// The time range that a page requests from the station: a length before now, or from and to. It is in the address, so that a
// link shows the same range.

import type { TemplateResult } from 'lit-html';
import type { Context } from './context';
import { t } from './i18n';
import { html } from './markup';
import { link } from './router';
import { labelOf, spanOf, spans } from './spans';

const shortest_ms = 1000;
const long = spans.filter((span) => span.ms >= 3_600_000);

export interface Range {
  from_ms: number;
  to_ms: number;
  span: string;  // name of its length; empty: from and to are fixed
}

export function rangeOf(context: Context, otherwise: string): Range {
  const { query } = context.route;
  const from_ms = Number(query.get('from')), to_ms = Number(query.get('to'));
  if (from_ms > 0 && to_ms >= from_ms + shortest_ms) return { from_ms, to_ms, span: '' };
  const span = query.get('span') ?? otherwise;
  const now = Math.ceil(context.now());
  return { from_ms: now - spanOf(span, spanOf(otherwise, 86_400_000)), to_ms: now, span };
}

// A text field: the browser's own field for times may show a 12-hour clock beside the page's 24-hour clock.
const timeShape = '\\d{4}-\\d{2}-\\d{2}[ T]\\d{2}:\\d{2}(:\\d{2})?';
const localText = (ms: number): string => new Date(ms - new Date(ms).getTimezoneOffset() * 60_000).toISOString().slice(0, 19).replace('T', ' ');

export const timeField = (name: 'from' | 'to', ms: number): TemplateResult => html`<label>${t(`range.${name}`)} <input class="time" name=${name} required
  pattern=${timeShape} title="YYYY-MM-DD HH:MM:SS" autocomplete="off" spellcheck="false" .value=${localText(ms)}></label>`;

// Returns the range of a form with two time fields; undefined if the end is not behind the start.
export function typedRange(form: FormData): { from_ms: number; to_ms: number } | undefined {
  const [from_ms, to_ms] = ['from', 'to'].map((name) => new Date(String(form.get(name)).trim().replace(' ', 'T')).getTime()) as [number, number];
  return from_ms > 0 && to_ms >= from_ms + shortest_ms ? { from_ms, to_ms } : undefined;
}

// keep: further parameters of the address.
export function rangeTools(context: Context, range: Range, parts: readonly string[], keep: Record<string, string | readonly string[]> = {},
  offered: readonly { key: string }[] = long): TemplateResult {
  const { name } = context.route;
  const submit = (event: Event): void => {
    event.preventDefault();
    const typed = typedRange(new FormData(event.target as HTMLFormElement));
    if (typed) context.go(link(name, parts, { ...keep, from: String(typed.from_ms), to: String(typed.to_ms) }));
    else context.say(t('range.wrong'), true);
  };
  return html`<span class="choice-row" role="group" aria-label=${t('range.span')}>${offered.map((span) => html`<button type="button" class="choice"
      aria-pressed=${span.key === range.span} @click=${() => context.go(link(name, parts, { ...keep, span: span.key }))}>${labelOf(span.key)}</button>`)}</span>
    <form class="range" @submit=${submit}>
      ${timeField('from', range.from_ms)}${timeField('to', range.to_ms)}
      <button>${t('range.show')}</button>
    </form>`;
}
