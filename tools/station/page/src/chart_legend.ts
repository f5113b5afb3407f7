// The legend below a trend, and the sample of a line beside the name of its channel.

import type { TemplateResult } from 'lit-html';
import { dashOf } from './chart';
import { t } from './i18n';
import { html } from './markup';

// The number, colour and dash of a line, as the trend draws them.
export const swatch = (index: number): TemplateResult => html`<span class="swatch s${index + 1}">${index + 1}
  <svg width="40" height="6" aria-hidden="true"><path d="M0 3H40" stroke-dasharray=${dashOf(index).join(' ')}></path></svg></span>`;

// `several`: bad times of each line are in a strip of their own, in its colour.
export const chartLegend = (several: boolean): TemplateResult => html`<p class="legend muted">
  <span><i class="key-band"></i>${t('chart.band')}</span>
  <span><i class=${several ? 'key-strip' : 'key-bad'}></i>${t(several ? 'chart.strips' : 'chart.bad')}</span></p>`;
