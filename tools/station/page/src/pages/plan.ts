// The read plan of a bus as a picture: a row for each group of channels that are read together, a mark for each read, as wide as
// its wire time. #/plan/BUS. Hovering, or the arrow keys, show the channels of a read.

import { nothing, render } from 'lit-html';
import { repeat } from 'lit-html/directives/repeat.js';
import type { TemplateResult } from 'lit-html';
import { ApiError, query, request } from '../api';
import { bridgeAdvice } from '../bridge_advice';
import { overloadText, planAdvice } from '../bus_advice';
import type { Change, Context, MakePage, Page } from '../context';
import { count, duration, percent, time } from '../format';
import { t } from '../i18n';
import { html, svg } from '../markup';
import { axisTicks, marksOf, orderedGroups, pathOf, pointsOf, rangeText, readCount, readNear, readOf, readTime_ms } from '../plan_picture';
import type { Read } from '../plan_picture';
import { channelLink, link } from '../router';
import type { PlanGroup, ReadPlan } from '../types';
import { bar, empty, errorText, fact, makeElement } from '../view';
import '../../styles/plan.css';

export const texts = {
  'plan.title': ['Read plan', '读取计划'], 'plan.bus': ['Bus', '总线'], 'plan.picture': ['Reads of {bus} in time', '{bus} 的读取时间图'],
  'plan.load': ['Load of the wire', '总线负载'], 'plan.free': ['Free on the wire', '总线空闲'], 'plan.overload': ['{share} too much', '超出 {share}'],
  'plan.table': ['Repeats after', '重复周期'], 'plan.no-table': ['no timetable', '无时间表'], 'plan.groups': ['Groups', '组'],
  'plan.reads': ['{groups} groups, {reads} reads', '{groups} 组，{reads} 次读取'], 'plan.stretch': ['Refreshes', '刷新周期'],
  'plan.no-stretch': ['as asked for', '与要求一致'], 'plan.since': ['In force since', '生效于'], 'plan.wire': ['Wire', '总线'],
  'plan.all-groups': ['all groups', '所有组'], 'plan.every': ['every {period}', '每 {period}'], 'plan.when-due': ['when due', '按需'],
  'plan.in': ['Zoom in', '放大'], 'plan.out': ['Zoom out', '缩小'], 'plan.none': ['No plan is known of {bus}.', '{bus} 没有已知的计划。'],
  'plan.none-hint': ['A bridge tells its plan when it runs the bus. A bridge of an older version tells none.', '网桥运行该总线时会报告其计划。旧版本的网桥不报告。'],
  'plan.no-groups': ['Nothing is read on this bus.', '此总线上没有读取任何内容。'], 'plan.read': ['Read', '读取'], 'plan.read-of': ['{n} of {of}', '第 {n} / {of} 次'],
  'plan.ends': ['Ends at', '结束于'], 'plan.takes': ['Takes', '用时'], 'plan.period': ['Period', '周期'], 'plan.slack': ['Slack', '余量'],
  'plan.gap': ['Longest gap', '最长间隔'], 'plan.share': ['Share of the wire', '总线占比'], 'plan.request': ['Request', '请求'],
  'plan.list': ['a list of ranges', '地址范围列表'], 'plan.block': ['one block', '一个连续块'], 'plan.channels': ['Channels in this read: {n}', '此次读取的通道：{n}'],
} as const;

const rowHeight = 46;
const mostNames = 60;
const zooms = [1, 2, 4, 8, 16, 32];
const slotsFrom_px = 10;  // least distance; closer slots are not drawn

class PlanPage implements Page {
  readonly element = makeElement('plan');
  readonly title: string;
  private readonly bus: string;
  private plan: ReadPlan | undefined;
  private groups: PlanGroup[] = [];
  private fault = '';
  private selected = 0;
  private read: Read | undefined;
  private zoom = 1;
  private width = 0;  // of a track, px, at zoom 1
  private asking = false;
  private again = false;
  private readonly asked = new AbortController();
  private readonly watch = new ResizeObserver(() => this.measure());

  constructor(private readonly context: Context) {
    this.bus = context.route.parts[0] ?? '';
    this.title = this.bus ? `${t('plan.title')}: ${this.bus}` : t('plan.title');
    this.watch.observe(this.element);
    if (this.bus) void this.load();
  }

  paint(change: Change): void {
    const { plant } = this.context;
    if (change.topics.has('plans') && plant.plans.delete(this.bus)) void this.load();
    if (!this.bus && plant.buses.size) {
      const [first] = [...plant.buses.keys()].sort();
      this.context.go(link('plan', [first!]));
      return;
    }
    if (change.second || change.topics.has('buses')) this.draw();
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === '+' || event.key === '=') this.setZoom(1);
    else if (event.key === '-') this.setZoom(-1);
    else if (!this.groups.length) return false;
    else if (event.key === 'ArrowDown' || event.key === 'ArrowUp') this.go(this.selected + (event.key === 'ArrowDown' ? 1 : -1));
    else if (event.key === 'ArrowRight' || event.key === 'ArrowLeft') this.step(event.key === 'ArrowRight' ? 1 : -1);
    else return false;
    return true;
  }

  close(): void {
    this.watch.disconnect();
    this.asked.abort();
  }

  private async load(): Promise<void> {
    if (this.asking) {
      this.again = true;
      return;
    }
    this.asking = true;
    try {
      this.plan = await request<ReadPlan>(query('/api/plan', { bus: this.bus }), undefined, this.asked.signal);
      this.fault = '';
      this.groups = orderedGroups(this.plan);
      this.choose(Math.min(this.selected, this.groups.length - 1));
    } catch (error) {
      if (this.asked.signal.aborted) return;
      this.plan = undefined;
      this.groups = [];
      this.fault = error instanceof ApiError && error.status === 404 ? t('plan.none', { bus: this.bus }) : errorText(error);
    }
    this.asking = false;
    this.draw();
    if (this.again) {
      this.again = false;
      void this.load();
    }
  }

  private measure(): void {
    const track = this.element.querySelector('.plan-rows');
    const label = this.element.querySelector('.plan-name');
    if (!track || !label) return;
    const width = Math.max(100, Math.floor(track.clientWidth - label.clientWidth - 2));
    if (width === this.width) return;
    this.width = width;
    this.draw();
  }

  private choose(index: number, read?: Read): void {
    this.selected = Math.max(0, Math.min(this.groups.length - 1, index));
    const group = this.groups[this.selected];
    this.read = read ?? (group && this.plan?.hyperperiod_ms ? readOf(group, 0, this.plan.hyperperiod_ms) : undefined);
  }

  private go(index: number): void {
    const group = this.groups[Math.max(0, Math.min(this.groups.length - 1, index))];
    const near = group && this.read && this.plan?.hyperperiod_ms ? readNear(group, this.read.end_ms, this.plan.hyperperiod_ms) : undefined;
    this.choose(index, near);
    this.draw();
    this.element.querySelectorAll<HTMLElement>('.plan-row .plan-name')[this.selected]?.focus();
  }

  private step(by: number): void {
    const group = this.groups[this.selected], hyperperiod_ms = this.plan?.hyperperiod_ms;
    if (!group || !hyperperiod_ms) return;
    this.read = readOf(group, (this.read?.index ?? -1) + by, hyperperiod_ms);
    this.draw();
    this.element.querySelector('.plan-read')?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  }

  private setZoom(by: number): void {
    const next = zooms[zooms.indexOf(this.zoom) + by];
    if (!next) return;
    this.zoom = next;
    this.draw();
  }

  private readonly point = (event: PointerEvent): void => {
    const hyperperiod_ms = this.plan?.hyperperiod_ms;
    const row = (event.target as Element).closest<HTMLElement>('.plan-row');
    const track = row?.querySelector('.plan-track');
    const index = Number(row?.dataset['index'] ?? -1);
    const group = this.groups[index];
    if (!track || !group || !hyperperiod_ms || !(event.target as Element).closest('.plan-track')) return;
    const at_ms = ((event.clientX - track.getBoundingClientRect().left) / (this.width * this.zoom)) * hyperperiod_ms;
    const read = readNear(group, at_ms, hyperperiod_ms);
    if (index === this.selected && read?.index === this.read?.index) return;
    this.choose(index, read);
    this.draw();
  };

  private draw(): void {
    const { plan, context } = this;
    const buses = [...context.plant.buses.keys()].sort();
    const change = (event: Event): void => context.go(link('plan', [(event.target as HTMLSelectElement).value]));
    render(html`<div class="tabs"><h1>${t('plan.title')}</h1>
        <select aria-label=${t('plan.bus')} @change=${change}>${(buses.includes(this.bus) || !this.bus ? buses : [this.bus, ...buses]).map((bus) =>
          html`<option value=${bus} ?selected=${bus === this.bus}>${bus}</option>`)}</select>
        <span class="space"></span>
        ${plan?.hyperperiod_ms ? html`<span class="choice-row">
          <button type="button" class="choice" aria-label=${t('plan.out')} ?disabled=${this.zoom === zooms[0]} @click=${() => this.setZoom(-1)}>−</button>
          <button type="button" class="choice" aria-label=${t('plan.in')} ?disabled=${this.zoom === zooms.at(-1)} @click=${() => this.setZoom(1)}>+</button></span>` : nothing}</div>
      ${plan ? html`${this.loads(plan)}${this.picture(plan)}${this.details(plan)}` :
        empty(this.fault || t(this.bus ? 'loading' : 'overview.none'), this.fault ? t('plan.none-hint') : '')}`, this.element);
    if (plan && !this.width) this.measure();
  }

  private loads(plan: ReadPlan): TemplateResult {
    const bus = this.context.plant.buses.get(this.bus);
    const free = 1 - plan.load;
    const requests = plan.hyperperiod_ms ? this.groups.reduce((sum, group) => sum + readCount(group, plan.hyperperiod_ms!), 0) : 0;
    return html`<section class="card plan-loads" aria-label=${t('plan.load')}>
      <div>${bar('planned', t('overview.planned'), plan.load, t('overview.planned-hint'))}
        ${bar('measured', t('overview.measured'), bus?.measured_load ?? NaN, t('overview.measured-hint'))}
        ${bar('used', t('overview.used'), bus?.utilisation ?? NaN, t('overview.used-hint'))}</div>
      <dl class="facts">
        ${fact(t('plan.free'), html`<b class=${free < 0.1 ? 'warn' : ''}>${free >= 0 ? percent(free) : t('plan.overload', { share: percent(-free) })}</b>`)}
        ${fact(t('plan.table'), plan.hyperperiod_ms ? `${duration(plan.hyperperiod_ms)} = ${Math.round(plan.hyperperiod_ms / plan.slot_ms!)} × ${duration(plan.slot_ms!)}` : t('plan.no-table'))}
        ${fact(t('plan.groups'), plan.hyperperiod_ms ? t('plan.reads', { groups: count(this.groups.length), reads: count(requests) }) : count(this.groups.length))}
        ${fact(t('plan.stretch'), plan.stretch > 1.005 ? html`<span class="warn">◆ ×${plan.stretch.toFixed(2)}</span>` : t('plan.no-stretch'))}
        ${plan.in_force_since_ms ? fact(t('plan.since'), time(plan.in_force_since_ms, this.context.now())) : nothing}
      </dl>${plan.load > 1 || plan.stretch > 1.005 ? html`<p class="plan-advice warn">◆ ${
        [overloadText({ planned_load: plan.load, stretch: plan.stretch }), ...planAdvice(plan)].join(' ')}</p>${bridgeAdvice(this.context, bus)}` : nothing}</section>`;
  }

  private picture(plan: ReadPlan): TemplateResult {
    const width = Math.max(100, this.width * this.zoom), hyperperiod_ms = plan.hyperperiod_ms;
    const slots = hyperperiod_ms && plan.slot_ms ? Math.round(hyperperiod_ms / plan.slot_ms) : 0;
    const step = width / Math.max(1, slots);
    const lines = slots && step >= slotsFrom_px ? Array.from({ length: slots + 1 }, (_, n) => `M${(n * step).toFixed(1)} 0V${rowHeight}`).join('') : '';
    const ticks = hyperperiod_ms ? axisTicks(hyperperiod_ms, width / 90).filter((at) => (at / hyperperiod_ms) * width < width - 34) : [];
    return html`<div class="plan-rows scroll" data-scroll tabindex="0" role="region" aria-label=${t('plan.picture', { bus: this.bus })} @pointermove=${this.point} @pointerdown=${this.point}>
      <div class="plan-axis"><span class="plan-name">${t('plan.wire')}<span class="muted">${t('plan.all-groups')}</span></span>${hyperperiod_ms ? html`
        <svg class="plan-track" width=${width} height=${rowHeight} aria-hidden="true">
          ${ticks.map((at) => svg`<text x=${((at / hyperperiod_ms) * width + 2).toFixed(1)} y="12">${duration(at)}</text>`)}
          <path class="plan-slots" d=${lines}></path><path class="plan-wire" d=${pathOf(marksOf(plan.groups, hyperperiod_ms, width), 20, 18)}></path></svg>` : nothing}</div>
      <ul>${repeat(this.groups, (_, index) => index, (group, index) => this.row(group, index, hyperperiod_ms, width, lines))}</ul></div>`;
  }

  private row(group: PlanGroup, index: number, hyperperiod_ms: number | null, width: number, lines: string): TemplateResult {
    const select = (): void => {
      if (index === this.selected) return;
      this.choose(index);
      this.draw();
    };
    const scale = hyperperiod_ms ? width / hyperperiod_ms : 0;
    const read = index === this.selected ? this.read : undefined;
    const from = read ? Math.max(0, read.begin_ms * scale) : 0;
    return html`<li class=${index === this.selected ? 'plan-row selected' : 'plan-row'} data-index=${index}>
      <button type="button" class="plan-name" aria-pressed=${index === this.selected} @focus=${select} @click=${select}>
        <span><b>${group.device}</b> ${rangeText(group.points)}</span>
        <span class="muted">${group.period_ms ? t('plan.every', { period: duration(group.period_ms) }) : t('plan.when-due')} · ${percent(group.load, 1)}</span></button>
      ${hyperperiod_ms && group.period_ms ? html`<svg class="plan-track" width=${width} height=${rowHeight} aria-hidden="true">
        <path class="plan-slots" d=${lines}></path><path class="plan-marks" d=${pathOf(marksOf([group], hyperperiod_ms, width), 12, 22)}></path>
        ${read ? svg`<rect class="plan-read" x=${from.toFixed(1)} y="8" width=${Math.max(3, read.end_ms * scale - from).toFixed(1)} height="30"></rect>` : nothing}</svg>` : nothing}</li>`;
  }

  // The panel below; its height does not depend on its contents.
  private details(plan: ReadPlan): TemplateResult {
    const group = this.groups[this.selected];
    if (!group) return html`<section class="card plan-details">${t('plan.no-groups')}</section>`;
    const { read } = this;
    const points = read ? pointsOf(group, read) : group.points;
    const names = points.flatMap((point) => point.channels);
    const gap = Math.max(...group.points.map((point) => point.worst_gap_ms ?? 0));
    return html`<section class="card plan-details" aria-live="polite">
      <h2><a href=${link('devices', [this.bus, group.device])}>${group.device}</a> ${rangeText(points)}</h2>
      <dl class="facts">
        ${read && plan.hyperperiod_ms ? fact(t('plan.read'), t('plan.read-of', { n: read.index + 1, of: readCount(group, plan.hyperperiod_ms) })) : nothing}
        ${read ? fact(t('plan.ends'), duration(read.end_ms)) : nothing}
        ${group.period_ms ? fact(t('plan.takes'), `≈ ${duration(readTime_ms(group))}`) : nothing}
        ${fact(t('plan.period'), group.period_ms ? duration(group.period_ms) : t('plan.when-due'))}
        ${group.slack_ms === null ? nothing : fact(t('plan.slack'), duration(group.slack_ms))}
        ${gap ? fact(t('plan.gap'), duration(gap)) : nothing}
        ${fact(t('plan.share'), percent(group.load, 1))}
        ${fact(t('plan.request'), t(group.list ? 'plan.list' : 'plan.block'))}
      </dl>
      <div class="plan-channels" data-scroll tabindex="0" role="region" aria-label=${t('plan.channels', { n: names.length })}><p class="muted">${t('plan.channels', { n: names.length })}</p>
        ${names.slice(0, mostNames).map((name) => html`<a href=${channelLink(`${this.bus}/${group.device}/${name}`)}>${name}</a> `)}
        ${names.length > mostNames ? html`<span class="muted">${t('alarms.and-more', { n: names.length - mostNames })}</span>` : nothing}</div></section>`;
  }
}

export const page: MakePage = (context) => new PlanPage(context);
