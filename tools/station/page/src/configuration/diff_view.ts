// Shows the changed lines of two texts.

import type { TemplateResult } from 'lit-html';
import { t } from '../i18n';
import { html } from '../markup';
import { changedLines, diffLines } from './line_diff';

const signs = { same: ' ', removed: '−', added: '+' } as const;
const mostLines = 2000;

export function diffView(before: string, after: string, label: string): TemplateResult {
  const lines = changedLines(diffLines(before, after)).slice(0, mostLines);
  if (!lines.length) return html`<p class="muted">${t('configuration.no-changes')}</p>`;
  return html`<div class="diff" data-scroll tabindex="0" role="region" aria-label=${label}>${lines.map((line) => (line ?
    html`<div class=${line.kind}><span class="muted">${line.new || line.old}</span><span>${signs[line.kind]}</span><code>${line.text}</code></div>` :
    html`<div class="muted"><span></span><span></span>${t('configuration.left-out')}</div>`))}</div>`;
}
