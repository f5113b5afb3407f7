// A dial of 240 degrees, with the limits of the channel as marks.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import type { Reading } from '../reading';
import { WidgetView, shareOf } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { html, svg } from '../../markup';

const half_deg = 120;
const radius = 40;

function point(share: number, at: number): string {
  const angle = ((share * 2 - 1) * half_deg - 90) * (Math.PI / 180);
  return `${(50 + at * Math.cos(angle)).toFixed(2)} ${(50 + at * Math.sin(angle)).toFixed(2)}`;
}
const arc = (share: number): string => `M${point(0, radius)} A${radius} ${radius} 0 ${share * 2 * half_deg > 180 ? 1 : 0} 1 ${point(share, radius)}`;

// The limits of a channel that are on the scale, as shares of it.
export function limitMarks(reading: Reading, min: number, max: number): { share: number; serious: boolean }[] {
  return Object.entries(reading.channel?.limits ?? {})
    .filter(([name, value]) => !name.startsWith('write') && value >= min && value <= max)
    .map(([name, value]) => ({ share: shareOf(value, min, max)!, serious: name.includes('-') }));
}

export class GaugeWidget extends WidgetView {
  constructor(host: Host, widget: Widget) { super(host, widget, [widget['channel'] as string]); }

  protected draw([reading]: readonly Reading[]): void {
    const { min, max } = this.widget as unknown as { min: number; max: number };
    const share = shareOf(reading!.value, min, max);
    const marks = limitMarks(reading!, min, max).map(({ share: at, serious }): TemplateResult =>
      svg`<path class=${serious ? 'mark serious' : 'mark'} d="M${point(at, radius - 6)} L${point(at, radius + 6)}"></path>`);
    render(html`<svg class="dial" viewBox="4 4 92 76" aria-hidden="true">
        <path class="track" d=${arc(1)}></path>
        ${share === undefined ? nothing : svg`<path class="fill" d=${arc(Math.max(share, 0.001))}></path>`}${marks}
        <text class="end" x="16" y="78">${min}</text><text class="end right" x="84" y="78">${max}</text>
      </svg>
      <p class="w-value"><b>${reading!.text}</b> <span class="unit">${reading!.unit}</span></p>`, this.body);
  }
}
