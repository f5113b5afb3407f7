// A heading or a note; it may open a dashboard.

import { render } from 'lit-html';
import type { Reading } from '../reading';
import { WidgetView } from '../widget';
import { html } from '../../markup';
import { link } from '../../router';

export class TextWidget extends WidgetView {
  protected draw(_: readonly Reading[]): void {
    const { text, opens } = this.widget as unknown as { text: string; opens?: string };
    const [name = '', search = ''] = (opens ?? '').split('?', 2);
    render(html`<p class="w-note">${opens ? html`<a href=${link('dashboard', [name], Object.fromEntries(new URLSearchParams(search)))}>${text}</a>` : text}</p>`, this.body);
  }
}
