// A field for a set-point. It asks for a confirmation and shows the outcome and the present value.

import { nothing, render } from 'lit-html';
import { confirmWrite, writeOutcome } from '../../command';
import type { Outcome } from '../../command';
import type { Reading } from '../reading';
import { WidgetView, valueText } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { t } from '../../i18n';
import { html } from '../../markup';
import { typedValue } from '../../typed';

export class SetpointWidget extends WidgetView {
  private outcome: Outcome | undefined;

  constructor(host: Host, widget: Widget) { super(host, widget, [widget['channel'] as string]); }

  protected draw([reading]: readonly Reading[]): void {
    const channel = reading!.channel;
    const refusal = this.context.refusal(this.widget['channel'] as string), may = !refusal && channel !== undefined && channel.access !== 'read-only';
    const low = channel?.limits['write-min'], high = channel?.limits['write-max'];
    const range = low !== undefined || high !== undefined ? t('channel.range', { min: low ?? '…', max: high ?? '…' }) : '';
    render(html`<p class="w-now"><b>${valueText(reading!)}</b></p>
      ${may ? html`<form class="w-setpoint" @submit=${this.submit}>
        ${channel.type === 'bool' ? html`<select name="value" aria-label=${t('channel.new-value')}><option>true</option><option>false</option></select>` :
          html`<input name="value" required autocomplete="off" spellcheck="false" aria-label="${t('channel.new-value')} ${this.title}" placeholder=${range}
            inputmode=${channel.type.startsWith('string') ? 'text' : 'decimal'}>`}
        <button class="primary">${t('channel.write')}</button></form>` : nothing}
      <p class="w-outcome" role="status">${this.outcome ? html`<span class=${this.outcome.bad ? 'bad-text' : ''}>${this.outcome.bad ? '▲ ' : ''}${this.outcome.text}</span>` :
        refusal ? t(refusal) : nothing}</p>`, this.body);
  }

  private readonly submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    const [reading] = this.sources.readings, channel = reading?.channel;
    if (!channel) return;
    const form = event.target as HTMLFormElement;
    const typed = typedValue(String(new FormData(form).get('value') ?? ''), channel.type, channel.limits);
    if ('fault' in typed) {
      const range = t('channel.range', { min: channel.limits['write-min'] ?? '…', max: channel.limits['write-max'] ?? '…' });
      return this.show({ bad: true, text: typed.fault === 'range' ? t('channel.out-of-range', { range }) : t('channel.bad-number', { type: channel.type }) });
    }
    if (!await confirmWrite(channel.path, valueText(reading), `${String(typed.value)} ${channel.unit}`.trim())) return;
    this.show({ bad: false, text: t('channel.waiting') });
    form.reset();
    this.show(await writeOutcome(this.context, channel.path, typed.value, this.widget['verify'] === true));
  };

  private show(outcome: Outcome): void {
    this.outcome = outcome;
    this.draw(this.sources.readings);
  }
}
