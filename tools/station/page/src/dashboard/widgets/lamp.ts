// A state as a lamp with its text: shape, colour and word.

import { render } from 'lit-html';
import type { Reading } from '../reading';
import { WidgetView, valueText } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { html } from '../../markup';

interface State {
  value: string | number | boolean;
  text: string;
  tone?: 'good' | 'warning' | 'bad' | 'plain';
}

const shapes = { good: '●', warning: '◆', bad: '▲', plain: '■' };

// A boolean channel has the values true and false, or 1 and 0.
export function stateOf(states: readonly State[], reading: Reading): State | undefined {
  const isNumber = !Number.isNaN(reading.value);
  return states.find(({ value }) => (isNumber && typeof value !== 'string' ? Number(value) === reading.value : String(value) === reading.text));
}

export class LampWidget extends WidgetView {
  constructor(host: Host, widget: Widget) { super(host, widget, [widget['channel'] as string]); }

  protected draw([reading]: readonly Reading[]): void {
    const state = reading!.acquired_ms ? stateOf((this.widget['states'] as State[] | undefined) ?? [], reading!) : undefined;
    const tone = state?.tone ?? 'plain';
    render(html`<p class="lamp-state ${tone}"><span class="lamp-shape" aria-hidden="true">${shapes[tone]}</span> <b>${state?.text ?? valueText(reading!)}</b></p>`, this.body);
  }
}
