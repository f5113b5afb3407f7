// Min, mean, max and integral of channels by shift, day or month. The address contains the whole report; a saved report is a name for it.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { query, request } from '../api';
import type { Context, MakePage, Page } from '../context';
import { fullTime, percent, shownValue, time } from '../format';
import { t, word } from '../i18n';
import { html } from '../markup';
import { link } from '../router';
import { rangeOf, rangeTools } from '../time_range';
import type { Reports, ReportTable } from '../types';
import { empty, errorText, makeElement } from '../view';
import '../../styles/reports.css';

export const texts = {
  'reports.title': ['Reports', '报表'], 'reports.channels': ['Channels or patterns', '通道或通配'], 'reports.by': ['A row for each', '每行'],
  'by.shift': ['shift', '班次'], 'by.day': ['day', '日'], 'by.month': ['month', '月'], 'reports.shifts': ['Shifts begin', '班次开始'],
  'reports.none': ['Type channels or patterns with *.', '输入通道或带 * 的通配。'], 'reports.integral': ['Integral × h', '积分 × h'],
  'reports.covered': ['Covered', '覆盖'], 'reports.print': ['Print', '打印'], 'reports.save': ['Save report', '保存报表'],
  'reports.scheduled': ['By schedule', '定时'],
} as const;

const shapes: Record<string, number> = { month: 7, day: 10, shift: 16 };  // characters of the time of a row
const figures = { min: 'history.min', mean: 'history.average', max: 'history.max', integral: 'reports.integral' } as const;
const textOf = (event: Event, name: string): string => String(new FormData(event.target as HTMLFormElement).get(name)).trim();

class ReportsPage implements Page {
  readonly element = makeElement('reports');
  private readonly channel: string[];
  private readonly by: string;
  private readonly address;  // of the page, without the time
  private readonly range;
  private tables: ReportTable[] | undefined;
  private reports: Reports | undefined;
  private fault = '';

  constructor(private readonly context: Context) {
    const { query: given } = context.route;
    this.channel = given.getAll('channel');
    this.by = given.get('by') ?? 'day';
    this.address = { channel: this.channel, by: this.by, shifts: given.get('shifts') ?? '06:00,14:00,22:00' };
    this.range = rangeOf(context, '7d');
    this.draw();
    if (!context.me.store) return;
    if (this.channel.length) void this.load<{ tables: ReportTable[] }>(this.source('json'), ({ tables }) => { this.tables = tables; });
    void this.list();
  }

  focusFilter(): void { this.element.querySelector<HTMLInputElement>('.filter')?.focus(); }

  private source(format: string): string {
    const { from_ms, to_ms } = this.range;
    return query('/api/report', { ...this.address, from: Math.floor(from_ms), to: Math.ceil(to_ms), format });
  }

  private async load<T>(path: string, take: (answer: T) => void): Promise<void> {
    try {
      take(await request<T>(path));
    } catch (error) {
      this.fault = errorText(error);
    }
    this.draw();
  }

  private list(): Promise<void> { return this.load<Reports>('/api/reports', (reports) => { this.reports = reports; }); }

  private async change(path: string, body: object): Promise<void> {
    await request(path, body).catch((error: unknown) => this.context.say(errorText(error), true));
    await this.list();
  }

  private link(address: typeof this.address): string {
    const { from_ms, to_ms, span } = this.range;
    return link('reports', [], { ...address, ...(span ? { span } : { from: String(from_ms), to: String(to_ms) }) });
  }

  private readonly onShow = (event: Event): void => {
    event.preventDefault();
    const words = (name: string): string[] => textOf(event, name).split(/[\s,]+/).filter(Boolean);
    this.context.go(this.link({ channel: words('channel'), by: textOf(event, 'by'), shifts: words('shifts').join() }));
  };

  private readonly onSave = (event: Event): void => {
    event.preventDefault();
    void this.change('/api/reports/save', { name: textOf(event, 'name'), query: this.link(this.address).split('?')[1] });
  };

  private draw(): void {
    const { tables, fault, channel } = this;
    render(html`<h1>${t('reports.title')}</h1>${!this.context.me.store ? empty(t('history.no-store'), t('history.no-store-hint')) : html`
      <form class="tools" @submit=${this.onShow}>
        <label>${t('reports.channels')} <input class="filter" name="channel" required spellcheck="false" autocapitalize="none" autocomplete="off" .value=${channel.join(', ')}></label>
        <label>${t('reports.by')} <select name="by">${Object.keys(shapes).map((each) => html`<option value=${each} ?selected=${each === this.by}>${word('by', each)}</option>`)}</select></label>
        <label>${t('reports.shifts')} <input name="shifts" required spellcheck="false" autocomplete="off" .value=${this.address.shifts}></label>
        <button class="primary">${t('range.show')}</button></form>
      <div class="tools">${rangeTools(this.context, this.range, [], this.address)}
        ${tables ? html`<a download href=${this.source('csv')}>CSV</a> <a download href=${this.source('xlsx')}>XLSX</a>
          <button type="button" @click=${() => print()}>${t('reports.print')}</button>` : nothing}</div>
      ${tables?.length ? this.table(tables) : empty(fault || t(tables ? 'history.no-data' : channel.length ? 'loading' : 'reports.none'))}
      ${this.lists()}`}`, this.element);
  }

  private table(tables: readonly ReportTable[]): TemplateResult {
    return html`<div class="scroll" data-scroll tabindex="0" role="region" aria-label=${t('reports.title')}><table class="plain"><thead><tr>
      <th scope="col">${t('history.channel')}</th><th scope="col">${t('history.unit')}</th><th scope="col">${t('range.from')}</th>
      ${Object.values(figures).map((name) => html`<th scope="col" class="number">${t(name)}</th>`)}<th scope="col" class="number">${t('reports.covered')}</th></tr></thead>
      <tbody>${tables.map(({ channel, unit, rows }) => rows.map((row) => html`<tr><td>${channel}</td><td>${unit}</td><td>${fullTime(row.from_ms).slice(0, shapes[this.by])}</td>
        ${Object.keys(figures).map((name) => html`<td class="number">${shownValue(row[name as 'min'], { type: 'float64' })}</td>`)}<td class="number">${percent(row.covered)}</td></tr>`))}</tbody></table></div>`;
  }

  private lists(): TemplateResult {
    const { saved = [], scheduled = [], runs = [] } = this.reports ?? {}, may = this.context.mayOperate();
    const row = (address: string, name: string, more: unknown): TemplateResult => html`<li><a href=${address}>${name}</a> ${more}</li>`;
    return html`<ul class="saved">${saved.map(({ name, query: address }) => row(`#/reports?${address}`, name, may ? html`<button type="button" class="plain small"
        aria-label="${t('dashboards.delete')} ${name}" @click=${() => void this.change('/api/reports/delete', { name })}>✕</button>` : nothing))}
      ${scheduled.map(({ name, channels, by, at, every }) => row(link('reports', [], { channel: channels, by }), name, html`<span class="muted">${t('reports.scheduled')}: ${word('by', every)} ${at}
        ${runs.filter(({ report }) => report === name).slice(0, 2).map(({ result, made_ms }) => html`· ${result} ${time(made_ms)} `)}</span>`))}</ul>
      ${may && this.channel.length ? html`<form class="tools" @submit=${this.onSave}><label>${t('dashboards.name')} <input name="name" required maxlength="64" autocomplete="off"></label><button>${t('reports.save')}</button></form>` : nothing}`;
  }
}

export const page: MakePage = (context) => new ReportsPage(context);
