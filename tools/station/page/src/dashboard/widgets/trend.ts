// Trends of up to eight channels: stored values, continued with live ones.

import { nothing, render } from 'lit-html';
import { query, request } from '../../api';
import { Chart } from '../../chart';
import type { Line } from '../../chart';
import { swatch } from '../../chart_legend';
import type { Change } from '../../context';
import type { Reading } from '../reading';
import { stateText, stateWords } from '../reading';
import { WidgetView, valueText } from '../widget';
import type { Host } from '../widget';
import type { Widget } from '../document';
import { t } from '../../i18n';
import { html } from '../../markup';
import { channelLink } from '../../router';
import { spanOf } from '../../spans';
import { LiveTail, lineOf } from '../../trend';
import type { History } from '../../types';
import { errorText } from '../../view';

const points = 400;
const legendRow_px = 22;
const again_ms = 600_000;  // fetches the history again, so that a page that is open for days shows stored buckets

export class TrendWidget extends WidgetView {
  private readonly chart: Chart;
  private readonly legend = document.createElement('ul');
  private readonly tails: LiveTail[] = [];
  private lines: Line[] = [];
  private readonly span_ms: number;
  private readonly asked = new AbortController();
  private timer = 0;
  private fault = '';

  constructor(host: Host, widget: Widget) {
    super(host, widget, widget['channels'] as string[]);
    this.span_ms = spanOf((widget['span'] as string | undefined) ?? null, 600_000);
    const height = Math.max(80, this.bodyHeight - legendRow_px * this.sources.paths.length);
    this.chart = new Chart({ label: t('channel.trend', { path: this.title || this.sources.paths.join(', ') }), height });
    this.legend.className = 'w-legend';
    this.body.append(this.chart.element, this.legend);
    this.lines = this.sources.paths.map((label) => ({ label, unit: '', stepped: false, t: [], average: [], min: [], max: [], bad: [] }));
    void this.load();
  }

  override close(): void {
    clearTimeout(this.timer);
    this.asked.abort();
    this.chart.close();
  }

  protected draw(readings: readonly Reading[], change: Change): void {
    const now = this.context.now();
    readings.forEach((reading, index) => {
      if (!reading.channel || !reading.acquired_ms) return;
      const { refresh_ms, mode } = reading.channel;
      const tail = (this.tails[index] ??= new LiveTail(mode === 'on-demand' ? 0 : refresh_ms));
      tail.add(reading.acquired_ms, reading.value, reading.quality <= 1 && !Number.isNaN(reading.value), now);
    });
    if (!change.second) return;
    const joined = this.lines.map((line, index) => {
      const channel = readings[index]?.channel, tail = this.tails[index];
      const named: Line = { ...line, unit: channel?.unit ?? line.unit, stepped: channel?.type === 'bool' };
      return tail ? tail.join(named, now - this.span_ms, now) : named;
    });
    this.chart.set(joined, now - this.span_ms, now);
    render(html`${readings.map((reading, index) => html`<li class=${reading.current ? '' : 'stale'} title=${stateWords(reading)}>
      ${swatch(index)}<a href=${channelLink(reading.path)}>${reading.path}</a> <b>${valueText(reading)}</b>
      <span class="w-age">${stateText(reading)}</span></li>`)}${this.fault ? html`<li class="bad-text">${this.fault}</li>` : nothing}`, this.legend);
  }

  private async load(): Promise<void> {
    if (!this.context.me.store) return;
    const to = Math.ceil(this.context.now());
    try {
      const { series } = await request<History>(
        query('/api/history', { channel: this.sources.paths, from: to - this.span_ms, to, points }), undefined, this.asked.signal);
      this.lines = this.lines.map((line, index) => {
        const stored = series[index];
        return stored && !stored.text ? lineOf(stored, line.label, this.sources.readings[index]?.channel?.refresh_ms) : line;
      });
      this.fault = '';
    } catch (error) {
      if (this.asked.signal.aborted) return;
      this.fault = errorText(error);
    }
    this.timer = window.setTimeout(() => void this.load(), again_ms);
  }
}
