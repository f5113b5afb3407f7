// A card for each site of the stream, and why the stream cannot be read.

import { nothing } from 'lit-html';
import { repeat } from 'lit-html/directives/repeat.js';
import type { TemplateResult } from 'lit-html';
import { age, count, duration } from './format';
import { t } from './i18n';
import { html } from './markup';
import { link } from './router';
import type { Plant } from './plant';
import type { Site } from './types';
import { badge, fact } from './view';

export const siteTexts = {
  'site.on': ['connected', '已连接'], 'site.off': ['silent', '无消息'], 'site.heard': ['Last heard', '最近消息'],
  'site.backlog': ['Backlog', '积压'], 'site.late': ['Late samples', '迟到样本'], 'site.lost': ['Lost samples', '丢失样本'],
  'site.refused': ['Messages that could not be decoded', '无法解码的消息'], 'site.stream': ['The stream cannot be read: {reason}', '无法读取数据流：{reason}'],
} as const;

function card(site: Site, now_ms: number): TemplateResult {
  const ahead_ms = site.clock_ahead_ms;
  return html`<article class=${site.connected ? 'card' : 'card stale'} aria-label=${site.site}>
    <header><h2><a href=${link('live', [], { q: `${site.site}:*` })}>${site.site}</a></h2>${
      site.connected ? badge('good', t('site.on')) : badge('bad', t('site.off'))}</header>
    <dl class="facts">
      ${fact(t('site.heard'), age(now_ms - (site.heard_ms ?? NaN)))}
      ${fact(t('site.backlog'), site.backlog_since_ms ? `${count(site.backlog_records)} · ${age(now_ms - site.backlog_since_ms)}` : '0')}
      ${fact(t('site.late'), count(site.late_samples))}
      ${fact(t('site.lost'), count(site.lost_samples))}
      ${fact(t('overview.clock'), ahead_ms === undefined ? '–' : `${ahead_ms < 0 ? '−' : '+'}${duration(Math.abs(ahead_ms))}`)}
      ${site.refused_messages ? fact(t('site.refused'), count(site.refused_messages), true) : nothing}
    </dl>
  </article>`;
}

export function sitesSection({ stream, sites }: Plant, now_ms: number): unknown {
  // Silent sites first.
  const sorted = [...sites.values()].sort((a, b) => Number(a.connected) - Number(b.connected) || a.site.localeCompare(b.site));
  return stream ? html`${stream.connected ? nothing : html`<p class="bad-text" role="alert">${t('site.stream', { reason: stream.reason })}</p>`}
    <div class="cards">${repeat(sorted, (site) => site.site, (site) => card(site, now_ms))}</div>` : nothing;
}
