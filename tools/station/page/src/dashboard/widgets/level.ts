// The level of a vessel, with the limits of the channel as marks.

import { nothing, render } from 'lit-html';
import type { Reading } from '../reading';
import { WidgetView, shareOf } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { html, svg } from '../../markup';
import { limitMarks } from './gauge';

export class LevelWidget extends WidgetView {
  constructor(host: Host, widget: Widget) { super(host, widget, [widget['channel'] as string]); }

  protected draw([reading]: readonly Reading[]): void {
    const { min, max } = this.widget as unknown as { min: number; max: number };
    const share = shareOf(reading!.value, min, max);
    render(html`<svg class="vessel" viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">
        <rect class="track" width="100" height="100"></rect>
        ${share === undefined ? nothing : svg`<rect class="fill" y=${(100 - 100 * share).toFixed(1)} width="100" height=${(100 * share).toFixed(1)}></rect>`}
        ${limitMarks(reading!, min, max).map(({ share: at, serious }) =>
          svg`<path class=${serious ? 'mark serious' : 'mark'} d="M0 ${(100 - 100 * at).toFixed(1)}H100"></path>`)}
      </svg>
      <p class="w-value"><b>${reading!.text}</b> <span class="unit">${reading!.unit}</span></p>`, this.body);
  }
}
