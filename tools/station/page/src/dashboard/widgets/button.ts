// A command with a fixed value. It asks for a confirmation and shows the outcome and the present value.

import { nothing, render } from 'lit-html';
import { confirmWrite, writeOutcome } from '../../command';
import type { Outcome } from '../../command';
import type { Reading } from '../reading';
import { WidgetView, valueText } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { t } from '../../i18n';
import { html } from '../../markup';

export class ButtonWidget extends WidgetView {
  private outcome: Outcome | undefined;
  private pending = false;

  constructor(host: Host, widget: Widget) { super(host, widget, [widget['channel'] as string]); }

  protected draw([reading]: readonly Reading[]): void {
    const refusal = this.context.refusal(this.widget['channel'] as string), writable = reading!.channel !== undefined && reading!.channel.access !== 'read-only';
    render(html`<button type="button" class="primary w-command" ?disabled=${refusal || !writable || this.pending} @click=${this.press}>${this.widget['text']}</button>
      <p class="w-now">${valueText(reading!)}</p>
      <p class="w-outcome" role="status">${this.pending ? t('channel.waiting') : this.outcome ? html`<span class=${this.outcome.bad ? 'bad-text' : ''}>${
        this.outcome.bad ? '▲ ' : ''}${this.outcome.text}</span>` : refusal ? t(refusal) : nothing}</p>`, this.body);
  }

  private readonly press = async (): Promise<void> => {
    const [reading] = this.sources.readings;
    const value = this.widget['value'] as string | number | boolean, path = this.widget['channel'] as string;
    if (!await confirmWrite(path, valueText(reading!), `${String(value)} ${reading!.unit}`.trim(), this.widget['text'] as string)) return;
    this.pending = true;
    this.draw(this.sources.readings);
    this.outcome = await writeOutcome(this.context, path, value, this.widget['verify'] === true);
    this.pending = false;
    this.draw(this.sources.readings);
  };
}
