// The response time of one device over the last day, as the station has stored it once a minute.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { query, request } from './api';
import { Chart } from './chart';
import type { Context } from './context';
import { html } from './markup';
import { lineOf } from './trend';
import type { History } from './types';

const day_ms = 86_400_000;
const again_ms = 60_000;
const height = 140;
const points = 480;

export class ResponseTrend {
  private chart: Chart | undefined;
  private device = '';
  private asked_ms = 0;
  private found = false;
  private readonly left = new AbortController();

  constructor(private readonly context: Context, private readonly label: string) {}

  close(): void {
    this.left.abort();
    this.chart?.close();
  }

  draw(device: string): TemplateResult | typeof nothing {
    if (!this.context.me.store) return nothing;
    const now_ms = this.context.now();
    if (device !== this.device) this.found = false;
    if (device !== this.device || now_ms > this.asked_ms + again_ms) void this.load(device, now_ms);
    return this.found ? html`<h3>${this.label}</h3>${this.chart!.element}` : nothing;
  }

  private async load(device: string, now_ms: number): Promise<void> {
    this.device = device;
    this.asked_ms = now_ms;
    const from = Math.floor(now_ms - day_ms), to = Math.ceil(now_ms);
    try {
      const { series: [series] } = await request<History>(query('/api/history', { channel: `${device}/$response-time`, from, to, points }), undefined, this.left.signal);
      if (device !== this.device || !series?.t.length) return;
      this.chart ??= new Chart({ label: this.label, height });
      this.chart.set([lineOf(series, this.label, again_ms)], from, to);
      this.found = true;
    } catch {
      // the figures of the device remain
    }
  }
}
