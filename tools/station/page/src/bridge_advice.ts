// The proposals of a bridge for an overloaded bus, as `fieldcast plan` prints them. The bridge plans its configuration for it, which takes
// seconds, and only engineers may request that.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { query, request } from './api';
import type { Checked, Configuration } from './configuration/api';
import type { Context } from './context';
import { t } from './i18n';
import { html } from './markup';
import type { Bus } from './types';
import { errorText } from './view';

export const texts = {
  'advice.ask': ['Proposals of the bridge', '网桥的建议'], 'advice.asking': ['The bridge is planning …', '网桥正在规划…'],
  'advice.feasible': ['None: with the response times that a plan assumes, the configuration is feasible. The devices are slower, or stations request more.', '无：按规划假定的应答时间，配置可行。设备应答更慢，或监控站请求更多。'],
} as const;

const received = new Map<string, readonly string[]>();  // by bus; lost with the page

async function remediesOf({ bridge, bus }: Bus): Promise<readonly string[]> {
  const { text } = await request<Configuration>(query('/api/configuration', { bridge }));
  const { today } = await request<Checked>('/api/configuration/check', { bridge, text });
  const plan = today.find((each) => each.bus === bus);
  return plan?.remedies.length ? plan.remedies : [t('advice.feasible')];
}

// The last list, and a button that requests it. The page that shows it draws again after each second.
export function bridgeAdvice(context: Context, bus: Bus | undefined): TemplateResult | typeof nothing {
  if (!bus || !context.mayEngineer()) return nothing;
  const list = received.get(bus.bus);
  const ask = (): void => {
    received.set(bus.bus, [t('advice.asking')]);
    remediesOf(bus).catch((error: unknown) => [errorText(error)]).then((remedies) => received.set(bus.bus, remedies));
  };
  return html`<ul class="remedies" aria-live="polite">${list?.map((text) => html`<li>${text}</li>`)}</ul>
    <button type="button" @click=${ask}>${t('advice.ask')}</button>`;
}
