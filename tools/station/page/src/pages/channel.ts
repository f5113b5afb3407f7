// One channel: its value in large, its stored and live trend in one line, a write with confirmation and result.

import { nothing, render } from 'lit-html';
import { query, request } from '../api';
import { Chart } from '../chart';
import { ChannelFault, texts as faultTexts } from '../channel_fault';
import { chartLegend } from '../chart_legend';
import type { Line } from '../chart';
import { confirmWrite, outcomeOf } from '../command';
import type { Outcome } from '../command';
import type { Context, MakePage, Page } from '../context';
import { patternTest } from '../dashboard/reading';
import { age, clock, duration, exactValue, shownValue, tableValue } from '../format';
import { t, word } from '../i18n';
import { html } from '../markup';
import { noteRecent } from '../recent';
import { link } from '../router';
import { labelOf, spanOf, spans } from '../spans';
import { LiveTail, lineOf } from '../trend';
import { typedValue } from '../typed';
import { isLate, notYetRead } from '../types';
import type { Channel, History, Result, Series } from '../types';
import { badge, empty, errorText, fact, makeElement, qualityText, toneOfQuality } from '../view';
import '../../styles/channel.css';

export const texts = {
  ...faultTexts,
  'channel.title': ['Channel', '通道'], 'channel.unknown': ['There is no channel {path}.', '没有通道 {path}。'],
  'channel.unknown-hint': ['It may come back with its bridge. Look for it on the page Live.', '它可能随网桥恢复。请在“实时”页面查找。'], 'channel.age': ['Age', '时长'],
  'channel.type': ['Type', '类型'], 'channel.at': ['Address', '地址'], 'channel.access': ['Access', '访问'], 'channel.mode': ['Mode', '模式'],
  'channel.refresh': ['Refresh', '刷新'], 'channel.bridge': ['Bridge', '网桥'], 'channel.asked': ['Asked for by', '请求方'], 'channel.limits': ['Limits', '限值'], 'channel.no-limits': ['none', '无'],
  'channel.trend': ['Trend of {path}', '{path} 的趋势'], 'channel.span': ['Shown span', '显示时段'],
  'channel.no-trend': ['A text has no trend. Its last values:', '文本没有趋势。最近的值：'],
  'channel.no-store': ['This station keeps no history: the trend begins when the page is opened.', '此监控站不保存历史：趋势从打开页面时开始。'],
  'channel.write': ['Write', '写入'], 'channel.new-value': ['New value', '新值'], 'channel.verify': ['Read back', '回读'],
  'channel.confirm-title': ['Write this value?', '写入此值？'], 'channel.from-to': ['{from} becomes {to}', '{from} 改为 {to}'],
  'channel.read-now': ['Read now', '立即读取'], 'channel.results': ['Results', '结果'],
  'channel.range': ['{min} to {max}', '{min} 到 {max}'], 'channel.bad-number': ['This is no number for {type}.', '这不是 {type} 的有效数值。'],
  'channel.out-of-range': ['The value must be {range}.', '该值必须在 {range} 之间。'], 'channel.waiting': ['waiting …', '等待中…'],
  'channel.history': ['Open in History', '在历史中打开'],
  'channel.needs-operator': ['Writing needs the role operator.', '写入需要操作员角色。'],
  'channel.no-commands': ['This station sends no commands to this site.', '此监控站不向该站点发送命令。'],
  'channel.follow': ['Back to now', '回到当前'],
} as const;

const points = 1000;
const chartHeight = 320;
const againAfter_ms = 4000;  // fetches the history again, for samples that the store wrote late
const mostOutcomes = 8;

interface Entry extends Outcome {
  at_ms: number;
  what: string;
}

class ChannelPage implements Page {
  readonly element = makeElement('channel');
  readonly title: string;
  private readonly facts = document.createElement('section');
  private readonly faultPlace = document.createElement('div');
  private readonly why: ChannelFault;
  private readonly tools = document.createElement('div');
  private readonly commands = document.createElement('section');
  private readonly path: string;
  private channel: Channel | undefined;
  private chart: Chart | undefined;
  private stored: Series | undefined;
  private line: Line | undefined;
  private tail = new LiveTail(0);
  private span_ms: number;
  private zoom: { from_ms: number; to_ms: number } | undefined;
  private cursor = '';
  private readonly outcomes: Entry[] = [];
  private fault = '';
  private leave: (() => void) | undefined;
  private asked = new AbortController();
  private timer = 0;
  private arrived = false;

  constructor(private readonly context: Context) {
    this.path = context.route.parts.join('/');
    this.title = this.path;
    this.span_ms = spanOf(context.route.query.get('span'), 600_000);
    this.why = new ChannelFault(context, () => this.drawFacts());
    this.facts.className = 'card value-card';
    this.tools.className = 'tools';
    this.commands.className = 'card commands';
    this.find();
  }

  paint(change: Parameters<NonNullable<Page['paint']>>[0]): void {
    if (change.topics.has('catalogue')) this.find();
    if (!this.channel) {
      render(html`<h1 class="unseen">${t('channel.title')}</h1>${this.context.plant.version < 0 ? empty(t('loading')) :
        empty(t('channel.unknown', { path: this.path }), t('channel.unknown-hint'))}`, this.element);
      return;
    }
    if (change.topics.has('sites')) this.drawCommands();
    if (this.arrived || change.second) this.drawFacts();
    if (this.chart && !this.zoom && (this.arrived || change.second)) this.drawChart();
    this.arrived = false;
  }

  close(): void {
    clearTimeout(this.timer);
    this.asked.abort();
    this.leave?.();
    this.why.close();
    this.chart?.close();
    this.context.plant.onValue = undefined;
    this.context.plant.watched = -1;
  }

  // The channel may appear after the page; after a reconnect it may have a different id.
  private find(): void {
    const { plant, live } = this.context;
    const id = plant.ids.get(this.path);
    const found = id === undefined ? undefined : plant.channels.get(id);
    if (!found || found === this.channel) return;
    const first = !this.channel;
    this.channel = found;
    plant.watched = found.id;
    plant.onValue = (each) => this.onValue(each);
    if (!first) return this.onValue(found.id);
    noteRecent(this.path);
    this.tail = new LiveTail(found.mode === 'on-demand' ? 0 : found.refresh_ms);
    if (found.mode !== 'on-demand' && found.refresh_ms >= 50) this.leave = live.subscribe(this.path, found.refresh_ms);
    render(nothing, this.element);
    this.element.replaceChildren(this.facts, this.faultPlace, this.tools);
    if (!found.type.startsWith('string')) {
      this.chart = new Chart({
        label: t('channel.trend', { path: this.path }), height: chartHeight, limits: found.limits,
        onZoom: (from_ms, to_ms) => this.setZoom({ from_ms, to_ms }),
        onCursor: (at_ms, [value]) => this.showCursor(at_ms, value),
      });
      const card = document.createElement('section');
      card.className = 'card chart-card';
      const legend = document.createElement('div');
      render(chartLegend(false), legend);
      card.append(this.chart.element, legend);
      this.element.append(card);
    }
    this.element.append(this.commands);
    this.onValue(found.id);
    this.drawTools();
    this.drawCommands();
    this.drawChart();
    void this.load();
    this.timer = window.setTimeout(() => void this.load(), againAfter_ms);
  }

  private onValue(id: number): void {
    const { plant } = this.context;
    const quality = plant.quality[id] ?? notYetRead, at_ms = plant.acquired_ms[id] ?? 0;
    const value = plant.texts.has(id) ? Number(plant.texts.get(id)) : plant.value[id] ?? NaN;
    if (quality === notYetRead) return;
    this.tail.add(at_ms, value, quality <= 1 && !Number.isNaN(value), this.context.now());
    this.arrived = true;
  }

  private window(): { from_ms: number; to_ms: number } {
    return this.zoom ?? { from_ms: this.context.now() - this.span_ms, to_ms: this.context.now() };
  }

  private async load(): Promise<void> {
    if (!this.context.me.store) return;
    this.asked.abort();
    const asked = (this.asked = new AbortController());
    const { from_ms, to_ms } = this.window();
    try {
      const answer = await request<History>(
        query('/api/history', { channel: this.path, from: Math.floor(from_ms), to: Math.ceil(to_ms), points }), undefined, asked.signal);
      this.stored = answer.series[0];
      if (this.stored && !this.stored.text) this.line = lineOf(this.stored, this.path, this.channel?.refresh_ms);
      if (this.stored?.text) this.drawTools();
      else this.drawChart();
    } catch (error) {
      if (!asked.signal.aborted) this.context.say(errorText(error), true);
    }
  }

  private setZoom(zoom: { from_ms: number; to_ms: number } | undefined): void {
    this.zoom = zoom;
    this.drawTools();
    this.drawChart();
    void this.load();
  }

  private setSpan(ms: number): void {
    this.span_ms = ms;
    this.setZoom(undefined);
  }

  private showCursor(at_ms: number | undefined, value: number | null | undefined): void {
    const next = at_ms === undefined ? '' :
      `${clock(at_ms)}  ${typeof value === 'number' ? `${shownValue(value, this.channel)} ${this.channel!.unit}` : '–'}`;
    if (next === this.cursor) return;
    this.cursor = next;
    this.drawTools();
  }

  private drawChart(): void {
    if (!this.chart || !this.channel) return;
    const { from_ms, to_ms } = this.window();
    const none: Line = { label: this.path, unit: this.channel.unit, stepped: this.channel.type === 'bool', t: [], average: [], min: [], max: [], bad: [] };
    this.chart.set([this.tail.join({ ...(this.line ?? none), unit: this.channel.unit, label: this.path }, from_ms, this.context.now())], from_ms, to_ms);
  }

  private valueText(exact: boolean): string {
    const { plant } = this.context;
    const { id, type } = this.channel!;
    const text = plant.texts.get(id);
    if (text !== undefined) return text;
    if (!plant.acquired_ms[id]) return '–';
    const value = plant.value[id]!;
    return exact ? exactValue(value, type) : tableValue(this.channel!, value);
  }

  private drawFacts(): void {
    const { plant } = this.context;
    const channel = this.channel!;
    const quality = plant.quality[channel.id] ?? notYetRead;
    const acquired_ms = plant.acquired_ms[channel.id] ?? 0;
    const age_ms = this.context.now() - acquired_ms, late = acquired_ms > 0 && isLate(channel, age_ms);
    const [bus, device, name] = channel.path.split('/');
    const asked = [...plant.interests.values()].filter((interest) => patternTest(interest.pattern)(channel.path))
      .map((interest) => `${interest.station} (${duration(interest.refresh_ms)})`).join(', ');
    const limits = Object.entries(channel.limits).map(([limit, value]) => `${limit} ${value}`).join(', ');
    render(html`
      <div class="value-head">
        <h1><a href=${link('plan', [bus!])}>${bus}</a> / <a href=${link('devices', [bus!, device!])}>${device}</a> / ${name}</h1>
        <p class=${`big-value ${toneOfQuality(quality)}${late ? ' late' : ''}`} title=${this.valueText(true)}><b>${this.valueText(false)}</b> <span class="unit">${channel.unit}</span></p>
        <p class="value-state">${badge(toneOfQuality(quality), qualityText(quality))}
          <span class="muted">${t('channel.age')}</span> <span class=${late ? 'age warn' : 'age'}>${late ? '◆ ' : ''}${acquired_ms ? age(age_ms) : '–'}</span></p>
        ${channel.description ? html`<p class="muted">${channel.description}</p>` : nothing}
      </div>
      <dl class="facts about">
        ${fact(t('channel.type'), channel.type)}${fact(t('channel.at'), channel.at || '–')}
        ${fact(t('channel.access'), word('access', channel.access))}${fact(t('channel.mode'), word('mode', channel.mode))}
        ${fact(t('channel.refresh'), channel.refresh_ms ? duration(channel.refresh_ms) : '–')}${fact(t('channel.bridge'), channel.bridge)}
        ${fact(t('channel.limits'), limits || t('channel.no-limits'))}${asked ? fact(t('channel.asked'), asked) : nothing}
      </dl>`, this.facts);
    render(this.why.draw(channel, quality, acquired_ms, this.valueText(false)), this.faultPlace);
  }

  private drawTools(): void {
    const texts = this.stored?.text;
    render(html`
      ${this.chart ? html`<div class="choice-row" role="group" aria-label=${t('channel.span')}>${spans.map(({ key, ms }) => html`
        <button type="button" class="choice" aria-pressed=${!this.zoom && this.span_ms === ms} @click=${() => this.setSpan(ms)}>${labelOf(key)}</button>`)}</div>
        ${this.zoom ? html`<button type="button" @click=${() => this.setZoom(undefined)}>${t('channel.follow')}</button>` : nothing}
        <span class="cursor number">${this.cursor}</span>` : html`<p class="muted">${t('channel.no-trend')}</p>`}
      ${this.context.me.store ? html`<a href=${link('history', [], { c: this.path })}>${t('channel.history')}</a>` :
        html`<span class="muted">${t('channel.no-store')}</span>`}
      ${texts ? html`<ul class="text-values">${texts.slice(-20).reverse().map((text, index) =>
        html`<li><span class="muted">${clock(this.stored!.t.at(-1 - index)!)}</span> ${text}</li>`)}</ul>` : nothing}`, this.tools);
  }

  private drawCommands(): void {
    const channel = this.channel!;
    const writable = channel.access !== 'read-only';
    const refusal = this.context.refusal(this.path);
    const low = channel.limits['write-min'], high = channel.limits['write-max'];
    const range = low !== undefined || high !== undefined ? t('channel.range', { min: low ?? '…', max: high ?? '…' }) : '';
    render(html`
      ${writable && !refusal ? html`<form class="tools" @submit=${this.submit}>
          <label for="new-value">${t('channel.new-value')}</label>
          ${channel.type === 'bool' ? html`<select id="new-value" name="value"><option>true</option><option>false</option></select>` :
            html`<input id="new-value" name="value" required autocomplete="off" spellcheck="false" inputmode=${channel.type.startsWith('string') ? 'text' : 'decimal'}
              aria-describedby="write-hint">`}
          <span class="muted">${channel.unit}</span>
          ${channel.access === 'read-write' ? html`<label><input type="checkbox" name="verify" checked>${t('channel.verify')}</label>` : nothing}
          <button class="primary">${t('channel.write')}</button>
          <span id="write-hint" class=${this.fault ? 'warn' : 'muted'} role="alert">${this.fault || range}</span>
        </form>` : writable ? html`<p class="muted">${t(refusal!)}</p>` : nothing}
      ${!refusal && channel.access !== 'write-only' ? html`<button type="button" @click=${this.acquire}>${t('channel.read-now')}</button>` : nothing}
      <ul class="outcomes" aria-label=${t('channel.results')} aria-live="polite">${this.outcomes.map((outcome) =>
        html`<li class=${outcome.bad ? 'bad' : ''}><span class="muted">${clock(outcome.at_ms)}</span> <b>${outcome.what}</b> ${outcome.bad ? '▲ ' : ''}${outcome.text}</li>`)}</ul>`,
    this.commands);
  }

  private readonly submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    const form = event.target as HTMLFormElement;
    const data = new FormData(form);
    const channel = this.channel!;
    const text = String(data.get('value') ?? '');
    const typed = typedValue(text, channel.type, channel.limits);
    if ('fault' in typed) {
      const range = t('channel.range', { min: channel.limits['write-min'] ?? '…', max: channel.limits['write-max'] ?? '…' });
      this.fault = typed.fault === 'range' ? t('channel.out-of-range', { range }) : t('channel.bad-number', { type: channel.type });
      this.drawCommands();
      return;
    }
    this.fault = '';
    this.drawCommands();
    const shown = `${String(typed.value)} ${channel.unit}`.trim();
    const verify = data.get('verify') !== null;
    const sure = await confirmWrite(channel.path, `${this.valueText(true)} ${channel.unit}`.trim(), shown);
    if (sure) await this.follow(shown, this.context.live.write(channel.path, typed.value, verify));
  };

  private readonly acquire = (): void => void this.follow(t('channel.read-now'), this.context.live.acquire(this.path));

  private async follow(what: string, command: Promise<Result>): Promise<void> {
    const entry: Entry = { at_ms: this.context.now(), what, text: t('channel.waiting'), bad: false };
    this.outcomes.unshift(entry);
    this.outcomes.splice(mostOutcomes);
    this.drawCommands();
    Object.assign(entry, await outcomeOf(command));
    this.drawCommands();
  }
}

export const page: MakePage = (context) => new ChannelPage(context);
