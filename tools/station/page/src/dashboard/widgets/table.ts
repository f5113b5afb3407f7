// The channels that match a pattern, with value, quality and age.

import { render } from 'lit-html';
import type { Change } from '../../context';
import { Sources, ageText, patternTest } from '../reading';
import type { Reading } from '../reading';
import { WidgetView } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { t } from '../../i18n';
import { html } from '../../markup';
import { channelLink } from '../../router';
import { badge, qualityText } from '../../view';

const mostRows = 200;
const pause_ms = 250;  // between two paintings

export class TableWidget extends WidgetView {
  private found = 0;
  private paintedAt = 0;
  private readonly prefix: string;  // common part of all paths

  constructor(host: Host, widget: Widget) {
    super(host, widget);
    const parts = this.pattern.split('/'), open = parts.findIndex((part) => part.includes('*'));
    this.prefix = parts.slice(0, open < 0 ? Math.min(2, parts.length) : open).map((part) => `${part}/`).join('');
    this.body.dataset['scroll'] = '';
    this.body.tabIndex = 0;
    this.body.setAttribute('role', 'group');
    this.body.setAttribute('aria-label', this.title);
  }

  override paint(change: Change): void {
    if (change.topics.has('catalogue')) {
      const fits = patternTest(this.pattern);
      const paths = [...this.context.plant.ids.keys()].filter(fits).sort();
      this.found = paths.length;
      this.sources = new Sources(this.context, paths.slice(0, mostRows));
    } else if (!change.second && performance.now() - this.paintedAt < pause_ms) {
      return;
    }
    this.paintedAt = performance.now();
    super.paint(change);
  }

  private get pattern(): string { return this.widget['pattern'] as string; }
  protected override get title(): string { return this.widget.title ?? this.pattern; }

  protected draw(readings: readonly Reading[]): void {
    render(html`<table class="plain"><thead><tr><th>${t('dashboard.channel')}</th><th class="number">${t('dashboard.value')}</th>
        <th>${t('dashboard.quality')}</th><th class="number">${t('channel.age')}</th></tr></thead>
      <tbody>${readings.map((reading) => html`<tr class=${reading.current ? '' : 'stale'}>
        <td><a href=${channelLink(reading.path)} title=${reading.path}>${reading.path.slice(this.prefix.length)}</a></td>
        <td class="number"><b>${reading.text}</b> ${reading.unit}</td>
        <td>${badge(reading.tone, qualityText(reading.quality))}</td>
        <td class="number">${reading.late ? '◆ ' : ''}${ageText(reading)}</td></tr>`)}</tbody></table>
      ${this.found > readings.length ? html`<p class="muted">${t('dashboard.more', { n: this.found - readings.length })}</p>` :
        this.found ? '' : html`<p class="muted">${t('dashboard.no-channels')}</p>`}`, this.body);
  }
}
