// Up to eight channels over any time range: min to max as a band, the average as a line, bad times at the bottom. Every zoom
// sends a new request, so that the picture has the resolution of the store. The address contains channels and range.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { query, request } from '../api';
import { Chart } from '../chart';
import type { Line, Mark } from '../chart';
import { chartLegend, swatch } from '../chart_legend';
import type { Context, MakePage, Page } from '../context';
import { count, decimalsOf, duration, fullTime, roundedValue, time } from '../format';
import { t, word } from '../i18n';
import { html } from '../markup';
import { recentChannels } from '../recent';
import { channelLink, link } from '../router';
import { spans } from '../spans';
import { rangeOf, rangeTools } from '../time_range';
import { lineOf } from '../trend';
import type { AlarmEvent, AuditEntry, History, Series } from '../types';
import { empty, errorText, makeElement } from '../view';

export const texts = {
  'history.title': ['History', '历史'], 'history.add': ['Add a channel', '添加通道'], 'history.add-hint': ['bus/device/channel', '总线/设备/通道'],
  'history.day': ['Day before', '前一天'], 'history.events': ['Events: {n}', '事件：{n}'], 'history.back': ['Zoom out', '缩小'],
  'history.csv': ['Save as CSV', '保存为 CSV'], 'history.none': ['Choose up to eight channels.', '最多选择八个通道。'],
  'history.recent': ['Looked at last', '最近查看'], 'history.recent-all': ['The last {n} together', '最近 {n} 个一起显示'],
  'history.none-hint': ['Type a part of a name and take one of the list. The address of this page can be sent.', '输入名称的一部分，再从列表中选择。本页地址可以转发。'],
  'history.no-store': ['This station keeps no history.', '此监控站不保存历史。'],
  'history.no-store-hint': ['Give it a store in its configuration, then it records.', '在其配置中设置存储后即开始记录。'],
  'history.remove': ['Remove {path}', '移除 {path}'], 'history.full': ['Eight channels are the most.', '最多八个通道。'],
  'history.no-data': ['no data', '无数据'], 'history.points': ['{n} points of {width}', '{n} 个点，每点 {width}'], 'history.raw': ['{n} samples', '{n} 个样本'],
  'history.min': ['Min', '最小'], 'history.average': ['Average', '平均'], 'history.max': ['Max', '最大'], 'history.bad': ['Bad', '异常'],
  'history.cursor': ['At {time}', '时刻 {time}'], 'history.channel': ['Channel', '通道'], 'history.chart': ['Trend of {n} channels', '{n} 个通道的趋势'],
  'history.resolution': ['Resolution', '分辨率'], 'history.drag': ['Drag across the trend to zoom in.', '在趋势图上拖动即可放大。'],
  'history.value': ['Value', '数值'], 'history.unit': ['Unit', '单位'], 'history.text': ['A text has no trend: see its CSV.', '文本没有趋势：请查看其 CSV。'],
} as const;

const mostChannels = 8;
const points = 1000;
const chartHeight = 380;
const mostSuggestions = 50;
const shortest_ms = 1000;
const day_ms = 86_400_000;

interface Figures {
  min: number;
  max: number;
  average: number;
  bad: number;
  points: number;
}

function figuresOf(series: Series): Figures {
  let min = Infinity, max = -Infinity, sum = 0, n = 0, bad = 0;
  series.t.forEach((_, index) => {
    bad += series.bad?.[index] ?? 0;
    const average = series.average?.[index], weight = series.count?.[index] ?? 0;
    if (average === null || average === undefined) return;
    min = Math.min(min, series.min[index] ?? average);
    max = Math.max(max, series.max[index] ?? average);
    sum += average * weight;
    n += weight;
  });
  return { min, max, average: sum / n, bad, points: series.t.length };
}

class HistoryPage implements Page {
  readonly element = makeElement('history');
  private readonly chart: Chart;
  private readonly channels: string[];
  private readonly range;
  private readonly compared: boolean;
  private answer: History | undefined;
  private marks: Mark[] = [];
  private cursorAt: number | undefined;
  private cursorValues: (number | null | undefined)[] = [];
  private readonly asked = new AbortController();
  private typed = '';
  private drawn = false;

  constructor(private readonly context: Context) {
    const { query: address } = context.route;
    this.channels = address.getAll('c').slice(0, mostChannels);
    this.range = rangeOf(context, '1h');
    this.compared = address.has('compare');
    this.chart = new Chart({
      label: t('history.chart', { n: this.channels.length }), height: chartHeight,
      onZoom: (from, to) => { if (to - from >= shortest_ms) this.go(this.address(), { from_ms: Math.floor(from), to_ms: Math.ceil(to) }); },
      onCursor: (at_ms, values) => {
        this.cursorAt = at_ms;
        this.cursorValues = values;
        this.draw();
      },
    });
    void this.load();
  }

  paint(change: { topics: ReadonlySet<string> }): void {
    if (!this.drawn || change.topics.has('catalogue')) this.draw();
    this.drawn = true;
  }

  focusFilter(): void { this.element.querySelector<HTMLInputElement>('#add-channel')?.focus(); }

  close(): void {
    this.asked.abort();
    this.chart.close();
  }

  // The parameters of the address, without the time.
  private address(channels = this.channels, compared = this.compared): Record<string, string | readonly string[]> {
    return { c: channels, ...(compared ? { compare: '' } : {}) };
  }

  // Every change is a new address, so the browser's Back button leaves a zoom.
  private go(address: Record<string, string | readonly string[]>, { from_ms, to_ms, span = '' }: { from_ms: number; to_ms: number; span?: string } = this.range): void {
    this.context.go(link('history', [], { ...address, ...(span ? { span } : { from: String(from_ms), to: String(to_ms) }) }));
  }

  private read(ago_ms: number): Promise<History> {
    const { from_ms, to_ms } = this.range;
    return request<History>(query('/api/history', { channel: this.channels, from: Math.floor(from_ms - ago_ms), to: Math.ceil(to_ms - ago_ms), points }), undefined, this.asked.signal);
  }

  private linesOf(answer: History | undefined, ago_ms = 0): Line[] {
    return (answer?.series ?? []).filter((series) => !series.text).map((series) => {
      const line = lineOf(series, series.channel, this.refreshOf(series.channel));
      return { ...line, t: line.t.map((at) => at + ago_ms) };
    });
  }

  private async load(): Promise<void> {
    if (!this.channels.length || !this.context.me.store) return;
    const { from_ms, to_ms } = this.range;
    try {
      const [answer, before] = await Promise.all([this.read(0), this.compared ? this.read(day_ms) : undefined, this.loadMarks().catch(() => undefined)]);
      this.answer = answer;
      this.chart.set(this.linesOf(answer), from_ms, to_ms, this.linesOf(before, day_ms), this.marks);
      this.draw();
    } catch (error) {
      if (!this.asked.signal.aborted) this.context.say(errorText(error), true);
    }
  }

  // Alarm events of the channels, and for operators the writes to them.
  private async loadMarks(): Promise<void> {
    const part = async <T>(path: string): Promise<T> => request<T>(
      query(path, { from: Math.floor(this.range.from_ms), to: Math.ceil(this.range.to_ms), limit: 1000 }), undefined, this.asked.signal);
    const [{ events }, { entries }] = await Promise.all([part<{ events: AlarmEvent[] }>('/api/alarms'),
      this.context.mayOperate() ? part<{ entries: AuditEntry[] }>('/api/audit') : { entries: [] }]);
    const found = [
      ...events.map(({ at_ms, bus, device, channel, event, limit }) => ({ at_ms, path: `${bus}/${device}/${channel}`, text: `${word('event', event)} ${limit}` })),
      ...entries.map(({ at_ms, target, what, who }) => ({ at_ms, path: target.split(/[ =]/)[0]!, text: `${what} ${who}` }))];
    this.marks = found.filter(({ path }) => this.channels.includes(path)).sort((a, b) => a.at_ms - b.at_ms)
      .map(({ at_ms, path, text }) => ({ at_ms, text: `${fullTime(at_ms)} ${path} ${text}` }));
  }

  private refreshOf(path: string): number {
    return this.context.plant.channelOf(path)?.refresh_ms ?? 0;
  }

  private add(path: string): void {
    if (this.channels.includes(path) || !this.context.plant.ids.has(path)) return;
    if (this.channels.length >= mostChannels) this.context.say(t('history.full'), true);
    else this.go(this.address([...this.channels, path]));
  }

  private readonly onType = (event: Event): void => {
    this.typed = (event.target as HTMLInputElement).value;
    if (this.context.plant.ids.has(this.typed)) this.add(this.typed);
    else this.draw();
  };

  private readonly onAdd = (event: Event): void => {
    event.preventDefault();
    this.add(this.suggestions()[0] ?? '');
  };

  private suggestions(): string[] {
    const words = this.typed.toLowerCase().split(/\s+/).filter(Boolean);
    if (!words.length) return [];
    const found: string[] = [];
    for (const path of this.context.plant.ids.keys()) {
      if (words.every((word) => path.toLowerCase().includes(word))) found.push(path);
      if (found.length >= mostSuggestions) break;
    }
    return found;
  }

  private zoomOut(): void {
    const { from_ms, to_ms } = this.range;
    const more = to_ms - from_ms;
    this.go(this.address(), { from_ms: Math.floor(from_ms - more / 2), to_ms: Math.min(Math.ceil(this.context.now()), Math.ceil(to_ms + more / 2)) });
  }

  private draw(): void {
    if (!this.context.me.store) {
      render(html`<h1 class="unseen">${t('history.title')}</h1>${empty(t('history.no-store'), t('history.no-store-hint'))}`, this.element);
      return;
    }
    const { from_ms, to_ms } = this.range;
    render(html`<h1 class="unseen">${t('history.title')}</h1>
      <div class="tools">
        <form class="tools" @submit=${this.onAdd}><input id="add-channel" class="filter" list="paths" autocomplete="off" spellcheck="false" aria-label=${t('history.add')}
          placeholder=${`${t('history.add')}: ${t('history.add-hint')}`} .value=${this.typed} @input=${this.onType}></form>
        <datalist id="paths">${this.suggestions().map((path) => html`<option value=${path}></option>`)}</datalist>
        ${rangeTools(this.context, this.range, [], this.address(), spans)}
        <button type="button" @click=${() => this.zoomOut()} ?disabled=${!this.channels.length}>${t('history.back')}</button>
        <button type="button" class="choice" aria-pressed=${this.compared} @click=${() => this.go(this.address(this.channels, !this.compared))}>${t('history.day')}</button>
        ${this.channels.length ? html`<a download href=${query('/api/export', { channel: this.channels, from: Math.floor(from_ms), to: Math.ceil(to_ms), format: 'csv' })}>${t('history.csv')}</a>` : ''}
      </div>
      ${this.channels.length ? html`<section class="card chart-card">${this.chart.element}${chartLegend(this.channels.length > 1)}${this.marks.length ? html`<details><summary>${t('history.events', { n: this.marks.length })}</summary>
        <ul>${this.marks.map(({ text }) => html`<li>${text}</li>`)}</ul></details>` : nothing}</section>${this.table()}` :
        html`${empty(t('history.none'), t('history.none-hint'))}${this.recent()}`}`, this.element);
  }

  // Channels that were looked at last, to begin with.
  private recent(): TemplateResult | typeof nothing {
    const paths = recentChannels().filter((path) => this.context.plant.ids.has(path));
    if (!paths.length) return nothing;
    return html`<section class="card recent"><h2>${t('history.recent')}</h2><ul>${paths.map((path) => html`<li><a href=${link('history', [], { c: path })}>${path}</a></li>`)}</ul>
      ${paths.length > 1 ? html`<p><a href=${link('history', [], { c: paths.slice(0, mostChannels) })}>${t('history.recent-all', { n: Math.min(mostChannels, paths.length) })}</a></p>` : nothing}</section>`;
  }

  private table(): TemplateResult {
    return html`<div class="scroll" data-scroll tabindex="0" role="region" aria-label=${t('history.title')}><table class="plain">
      <caption class="muted">${this.cursorAt === undefined ? t('history.drag') : t('history.cursor', { time: fullTime(this.cursorAt) })}</caption>
      <thead><tr><th scope="col">${t('history.channel')}</th><th scope="col" class="number">${t('history.value')}</th>${this.compared ? html`<th scope="col" class="number">${t('history.day')}</th>` : nothing}<th scope="col">${t('history.unit')}</th>
        <th scope="col" class="number">${t('history.min')}</th><th scope="col" class="number">${t('history.average')}</th>
        <th scope="col" class="number">${t('history.max')}</th><th scope="col" class="number">${t('history.bad')}</th><th scope="col">${t('history.resolution')}</th><td></td></tr></thead>
      <tbody>${this.channels.map((path) => this.row(path))}</tbody></table></div>`;
  }

  private row(path: string): TemplateResult {
    const series = this.answer?.series.find((each) => each.channel === path);
    const drawn = this.answer?.series.filter((each) => !each.text) ?? [];
    const line = series ? drawn.indexOf(series) : -1;
    const figures = series && !series.text ? figuresOf(series) : undefined;
    const shown = { ...this.context.plant.channelOf(path), type: series?.type ?? '' }, decimals = figures ? decimalsOf(shown, [figures.min, figures.max]) : 0;
    const number = (value: number | null | undefined, more = 0): string => (Number.isFinite(value ?? NaN) ? roundedValue(value, shown, decimals + more) : '–');
    const read = (index: number): string => (line >= 0 && this.cursorAt !== undefined ? number(this.cursorValues[index]) : '');
    const resolution = !series ? '' : series.text ? t('history.text') : !figures!.points ? t('history.no-data') :
      series.bucket_ms ? t('history.points', { n: count(figures!.points), width: duration(series.bucket_ms) }) : t('history.raw', { n: count(figures!.points) });
    const late = series?.late?.slice(-3).map((each) => `${time(each.from_ms)}–${time(each.to_ms)}`).join(', ');
    return html`<tr>
      <td>${line >= 0 ? swatch(line) : ''}<a href=${channelLink(path)}>${path}</a></td>
      <td class="number"><b>${read(line)}</b></td>${this.compared ? html`<td class="number">${read(line + drawn.length)}</td>` : nothing}<td>${series?.unit}</td>
      <td class="number">${number(figures?.min)}</td><td class="number">${number(figures?.average, shown.type.startsWith('float') || shown.digits !== undefined ? 0 : 1)}</td><td class="number">${number(figures?.max)}</td>
      <td class=${figures?.bad ? 'number bad-text' : 'number'}>${figures ? count(figures.bad) : ''}</td><td class="muted">${resolution}${late ? html`<br><span class="warn">${t('site.late')}: ${late}</span>` : nothing}</td>
      <td><button type="button" class="plain small" aria-label=${t('history.remove', { path })}
        @click=${() => this.go(this.address(this.channels.filter((each) => each !== path)))}>✕</button></td></tr>`;
  }
}

export const page: MakePage = (context) => new HistoryPage(context);
