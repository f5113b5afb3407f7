// One value in large.

import { render } from 'lit-html';
import type { Reading } from '../reading';
import { WidgetView } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { html } from '../../markup';

export class NumberWidget extends WidgetView {
  constructor(host: Host, widget: Widget) { super(host, widget, [widget['channel'] as string]); }

  protected draw([reading]: readonly Reading[]): void {
    render(html`<p class="w-value"><b>${reading!.text}</b> <span class="unit">${reading!.unit}</span></p>`, this.body);
  }
}
