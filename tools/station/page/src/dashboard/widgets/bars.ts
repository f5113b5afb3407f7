// Values beside each other as bars on one scale.

import { nothing, render } from 'lit-html';
import { stateText, stateWords } from '../reading';
import type { Reading } from '../reading';
import { WidgetView, shareOf, valueText } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { html, svg } from '../../markup';
import { channelLink } from '../../router';

export class BarsWidget extends WidgetView {
  constructor(host: Host, widget: Widget) {
    super(host, widget, widget['channels'] as string[]);
    this.body.dataset['scroll'] = '';
    this.body.tabIndex = 0;
    this.body.setAttribute('role', 'group');
    this.body.setAttribute('aria-label', this.title || this.widget.kind);
  }

  protected draw(readings: readonly Reading[]): void {
    const { min, max } = this.widget as unknown as { min: number; max: number };
    render(html`<ul class="w-bars">${readings.map((reading) => {
      const share = shareOf(reading.value, min, max);
      return html`<li class=${reading.current ? '' : 'stale'} data-tone=${reading.tone} title=${stateWords(reading)}>
        <a href=${channelLink(reading.path)}>${reading.path.split('/').slice(1).join('/')}</a>
        <svg class="bar-track" viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true">
          <rect class="track" width="100" height="4"></rect>${share === undefined ? nothing : svg`<rect class="fill" width=${(100 * share).toFixed(1)} height="4"></rect>`}
        </svg>
        <span><b>${valueText(reading)}</b> <span class="w-age">${stateText(reading)}</span></span></li>`;
    })}</ul>`, this.body);
  }
}
