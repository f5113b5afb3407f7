// The alarms of channels that match a pattern; those that need attention are first.

import { render } from 'lit-html';
import { limitText } from '../../alarm_actions';
import { arrangeAlarms, isShelved } from '../../alarm_rows';
import type { Change } from '../../context';
import { patternTest } from '../reading';
import type { Reading } from '../reading';
import { WidgetView } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { age } from '../../format';
import { t, word } from '../../i18n';
import { html } from '../../markup';
import { channelLink, link } from '../../router';
import type { Alarm } from '../../types';
import { badge } from '../../view';
import type { Tone } from '../../view';

const mostRows = 50;

export class AlarmsWidget extends WidgetView {
  private readonly fits: (path: string) => boolean;

  constructor(host: Host, widget: Widget) {
    super(host, widget);
    this.fits = patternTest((widget['pattern'] as string | undefined) ?? '*');
    this.body.dataset['scroll'] = '';
    this.body.tabIndex = 0;
    this.body.setAttribute('role', 'group');
    this.body.setAttribute('aria-label', this.title);
  }

  protected override get title(): string { return this.widget.title ?? t('alarms.title'); }

  override paint(change: Change): void {
    if (change.second || change.topics.has('alarms')) super.paint({ ...change, second: true });
  }

  protected draw(_: readonly Reading[]): void {
    const now = this.context.now();
    const pathOf = (alarm: Alarm): string => `${alarm.bus}/${alarm.device}/${alarm.channel}`;
    const all = [...this.context.plant.alarms.values()].filter((alarm) => this.fits(pathOf(alarm)));
    const { alarms } = arrangeAlarms(all, { filter: '', section: undefined }, now);
    const tone = (alarm: Alarm): Tone => (isShelved(alarm, now) || alarm.suppressed ? 'unknown' : !alarm.active ? 'good' : alarm.priority === 'critical' || alarm.priority === 'high' ? 'bad' : 'warning');
    render(html`${alarms.length ? html`<ul class="w-alarms">${alarms.slice(0, mostRows).map((alarm) => html`<li>
        ${badge(tone(alarm), word('priority', alarm.priority))} <a href=${channelLink(pathOf(alarm))}>${pathOf(alarm)}</a> <b>${limitText(alarm)}</b>
        <span class="muted">${isShelved(alarm, now) ? t('alarms.section-shelved') : alarm.suppressed ? t('alarms.section-maintenance') : word('state', alarm.state)} · ${age(now - alarm.since_ms)}</span></li>`)}</ul>` :
        html`<p class="muted">✓ ${t('alarms.none')}</p>`}
      <p><a href=${link('alarms')}>${t('alarms.title')}${alarms.length > mostRows ? ` (${alarms.length})` : ''}</a></p>`, this.body);
  }
}
