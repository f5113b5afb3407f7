// The frame of every widget: title, and the quality and age of its worst channel. A widget whose channels are not current looks
// stale as a whole.

import { nothing, render } from 'lit-html';
import type { Change, Context } from '../context';
import { word } from '../i18n';
import { html } from '../markup';
import { channelLink } from '../router';
import { Sources, stateText, stateWords, worstOf } from './reading';
import type { Reading } from './reading';
import type { Widget } from './document';

export interface Picture {
  name: string;
  version: number;
  type: string;
  width: number;
  height: number;
  bytes: number;
  saved_by: string;
  saved_ms: number;
}

// What a widget is shown in.
export interface Host {
  context: Context;
  height_px: number;  // of the whole widget
  pictures: ReadonlyMap<string, Picture>;
}

const frame_px = 38;  // head and margins

export abstract class WidgetView {
  readonly element = document.createElement('div');
  protected readonly body = document.createElement('div');
  protected readonly context: Context;
  protected sources: Sources;
  private readonly head = document.createElement('header');

  constructor(protected readonly host: Host, protected readonly widget: Widget, paths: readonly string[] = []) {
    this.context = host.context;
    this.sources = new Sources(host.context, paths, this.digits);
    this.element.className = `widget k-${widget.kind}`;
    this.element.setAttribute('role', 'group');
    this.element.setAttribute('aria-label', this.title || word('widget', widget.kind));
    this.body.className = 'w-body';
    this.element.append(this.head, this.body);
  }

  paint(change: Change): void {
    if (!this.sources.update(change)) return;
    const { readings } = this.sources;
    this.drawHead(worstOf(readings));
    this.draw(readings, change);
  }

  close(): void {}

  protected abstract draw(readings: readonly Reading[], change: Change): void;

  protected get title(): string {
    const { title, channel } = this.widget as { title?: string; channel?: string };
    return title ?? channel?.split('/').at(-1) ?? '';
  }
  protected get digits(): number | undefined { return this.widget['digits'] as number | undefined; }
  protected get bodyHeight(): number { return Math.max(40, this.host.height_px - frame_px); }

  private drawHead(worst: Reading | undefined): void {
    this.element.dataset['tone'] = worst?.tone ?? 'none';
    this.element.classList.toggle('stale', worst !== undefined && !worst.current);
    const { channel } = this.widget as { channel?: string };
    render(html`<h2 title=${this.title || nothing}>${channel ? html`<a href=${channelLink(channel)}>${this.title}</a>` : this.title}</h2>${
      worst ? html`<span class="w-state" title=${stateWords(worst)}><span aria-hidden="true">${stateText(worst)}</span><span class="unseen">${stateWords(worst)}</span></span>` : nothing}`, this.head);
  }
}

// "21.5 °C", of one reading.
export const valueText = (reading: Reading): string => `${reading.text} ${reading.unit}`.trim();

// The share of a value between both ends, from 0 to 1; undefined without a number.
export const shareOf = (value: number, min: number, max: number): number | undefined =>
  (Number.isNaN(value) ? undefined : Math.max(0, Math.min(1, (value - min) / (max - min))));
