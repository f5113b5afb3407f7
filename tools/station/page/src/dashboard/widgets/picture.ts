// A picture with values placed on it. The picture is an image, so it can run nothing; the values are text of the page.

import { nothing, render } from 'lit-html';
import { query } from '../../api';
import { shownValue } from '../../format';
import { ageText, stateWords } from '../reading';
import type { Reading } from '../reading';
import { WidgetView, valueText } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { t } from '../../i18n';
import { html, svg } from '../../markup';
import { channelLink } from '../../router';
import { shape } from '../../view';

interface Placed {
  channel: string;
  x: number;  // percent of the width
  y: number;
  label?: string;
  size?: number;  // percent of the height of the picture
  digits?: number;
}

const width = 1000;  // the picture is scaled to this width
const usualSize = 4;

export class PictureWidget extends WidgetView {
  private readonly placed: readonly Placed[];

  constructor(host: Host, widget: Widget) {
    const placed = (widget['values'] as Placed[] | undefined) ?? [];
    super(host, widget, placed.map(({ channel }) => channel));
    this.placed = placed;
  }

  protected draw(readings: readonly Reading[]): void {
    const name = this.widget['picture'] as string, picture = this.host.pictures.get(name);
    if (!picture) {
      render(html`<p class="muted">${t('dashboard.no-picture', { name })}</p>`, this.body);
      return;
    }
    const height = (width * picture.height) / picture.width;
    render(html`<svg class="mimic" viewBox="0 0 ${width} ${height.toFixed(1)}" role="group" aria-label=${this.title || name}>
      <image href=${query('/api/picture', { name, v: picture.version })} width=${width} height=${height.toFixed(1)}></image>
      ${readings.map((reading, index) => {
        const { x, y, label, size = usualSize } = this.placed[index]!;
        return svg`<a href=${channelLink(reading.path)} class=${reading.current ? '' : 'stale'} data-tone=${reading.tone}><title>${stateWords(reading)}</title>
          <text x=${(x * width) / 100} y=${((y * height) / 100).toFixed(1)} font-size=${((size * height) / 100).toFixed(1)}>${label ? `${label} ` : ''}<tspan
            class="mimic-value">${this.textOf(reading, index)}</tspan>${reading.current ? nothing : svg`<tspan> ${shape(reading.tone)} ${ageText(reading)}</tspan>`}</text></a>`;
      })}</svg>`, this.body);
  }

  private textOf(reading: Reading, index: number): string {
    const { digits } = this.placed[index]!;
    return digits !== undefined && reading.channel && reading.acquired_ms && !Number.isNaN(reading.value) ?
      `${shownValue(reading.value, { ...reading.channel, digits })} ${reading.unit}`.trim() : valueText(reading);
  }
}
