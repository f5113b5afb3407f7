// The time range that a page requests from the station: a length before now, or from and to. It is in the address, so that a
// link shows the same range.

import type { TemplateResult } from 'lit-html';
import type { Context } from './context';
import { t } from './i18n';
import { html } from './markup';
import { link } from './router';
import { labelOf, spanOf, spans } from './spans';

const shortest_ms = 1000;
const offered = spans.filter((span) => span.ms >= 3_600_000);

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

// Format of <input type="datetime-local">.
function localText(ms: number): string {
  return new Date(ms - new Date(ms).getTimezoneOffset() * 60_000).toISOString().slice(0, 19);
}

export function rangeTools(context: Context, range: Range, parts: readonly string[]): TemplateResult {
  const { name } = context.route;
  const submit = (event: Event): void => {
    event.preventDefault();
    const form = new FormData(event.target as HTMLFormElement);
    const from = new Date(String(form.get('from'))).getTime(), to = new Date(String(form.get('to'))).getTime();
    if (from > 0 && to >= from + shortest_ms) context.go(link(name, parts, { from: String(from), to: String(to) }));
    else context.say(t('range.wrong'), true);
  };
  return html`<span class="choice-row" role="group" aria-label=${t('range.span')}>${offered.map((span) => html`<button type="button" class="choice"
      aria-pressed=${span.key === range.span} @click=${() => context.go(link(name, parts, { span: span.key }))}>${labelOf(span.key)}</button>`)}</span>
    <form class="range" @submit=${submit}>
      <label>${t('range.from')}<input type="datetime-local" name="from" step="1" required .value=${localText(range.from_ms)}></label>
      <label>${t('range.to')}<input type="datetime-local" name="to" step="1" required .value=${localText(range.to_ms)}></label>
      <button>${t('range.show')}</button>
    </form>`;
}
