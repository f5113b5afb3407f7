// The plan of the draft beside that of today: load, largest gap, what is not feasible, and what would fix it.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { duration, percent } from '../format';
import { t } from '../i18n';
import { html } from '../markup';
import { badge } from '../view';
import type { BusPlan, Checked } from './api';
import { planRows, worstOf } from './plan_rows';

const mostNames = 6;

function planCell(plan: BusPlan | undefined, label: string): TemplateResult {
  if (!plan) return html`<td class="muted" colspan="2">${label}</td>`;
  const worst = worstOf(plan);
  const tone = plan.load > 1 ? 'bad' : plan.load > 0.85 ? 'warn' : '';
  return html`<td class=${`number ${tone}`}>${percent(plan.load)}</td>
    <td>${worst ? t('configuration.gap-of', { channel: worst.channel.slice(worst.channel.indexOf('/') + 1), gap: duration(worst.gap_ms), refresh: duration(worst.refresh_ms) }) : '–'}</td>`;
}

function verdict(plan: BusPlan): TemplateResult {
  if (plan.feasible) return badge('good', t('configuration.feasible'));
  const channels = plan.infeasible.slice(0, mostNames).join(', ');
  const more = plan.infeasible.length > mostNames ? ` ${t('configuration.and-more', { n: plan.infeasible.length - mostNames })}` : '';
  return html`${badge('bad', t('configuration.infeasible'))}
    ${channels ? html`<p>${t('configuration.too-slow', { channels: channels + more })}</p>` : nothing}
    ${plan.remedies.length ? html`<ul>${plan.remedies.map((text) => html`<li>${text}</li>`)}</ul>` : nothing}`;
}

export function planView(checked: Checked | undefined): TemplateResult {
  const rows = checked ? planRows(checked) : [];
  return html`<div class="scroll" data-scroll tabindex="0" role="region" aria-label=${t('configuration.plan')}><table class="plain plan-draft">
    <thead><tr><th scope="col" rowspan="2">${t('configuration.plan-bus')}</th><th scope="colgroup" colspan="2">${t('configuration.today')}</th>
      <th scope="colgroup" colspan="2">${t('configuration.draft')}</th><td rowspan="2"></td></tr>
      <tr>${[0, 1].map(() => html`<th scope="col" class="number">${t('configuration.load')}</th><th scope="col">${t('configuration.gap')}</th>`)}</tr></thead>
    <tbody>${rows.map(({ bus, today, draft }) => html`<tr><th scope="row">${bus}</th>
      ${planCell(today, t('configuration.new'))}${planCell(draft, t('configuration.gone'))}<td>${draft ? verdict(draft) : nothing}</td></tr>`)}</tbody></table></div>`;
}
