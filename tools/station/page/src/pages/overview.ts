// Each bus, worst first: its state, planned and measured load, misses by cause, the slowest device. Few buses are cards, many are rows.

import { nothing, render } from 'lit-html';
import { repeat } from 'lit-html/directives/repeat.js';
import type { TemplateResult } from 'lit-html';
import { isShelved } from '../alarm_rows';
import { bridgeAdvice, texts as bridgeTexts } from '../bridge_advice';
import { lateText, overloadText, texts as adviceTexts } from '../bus_advice';
import { worstFirst } from '../bus_order';
import type { BusNeed } from '../bus_order';
import type { Context, MakePage } from '../context';
import { age, count, duration, percent } from '../format';
import { t, word } from '../i18n';
import { html, svg } from '../markup';
import type { Load, Tally } from '../plant';
import { link } from '../router';
import { siteTexts, sitesSection } from '../sites';
import type { Bridge, Bus, Counts, Device } from '../types';
import { badge, bar, empty, fact, makeElement, stateBadge } from '../view';

export const texts = {
  ...siteTexts, ...adviceTexts, ...bridgeTexts,
  'overview.title': ['Overview', '总览'], 'overview.planned': ['Planned', '计划'], 'overview.measured': ['Measured', '实测'],
  'overview.used': ['Used', '占用'], 'overview.planned-hint': ['Share of the wire that the read plan needs', '读取计划所需的总线时间比例'],
  'overview.measured-hint': ['Share of the wire that reading took in the last 10 s', '最近 10 秒读取所占的总线时间比例'],
  'overview.used-hint': ['Share of the last second in which the wire was busy or had to be silent', '最近一秒内总线忙碌或必须静默的时间比例'],
  'overview.channels': ['Channels', '通道'], 'overview.bad': ['bad', '异常'], 'overview.exchanges': ['Exchanges/s', '交换/秒'],
  'overview.misses': ['Missed refreshes', '错过的刷新'], 'overview.stretch': ['Refreshes stretched by', '刷新周期拉长为'],
  'overview.slowest': ['Slowest device', '最慢的设备'], 'overview.no-misses': ['none', '无'],
  'overview.last-minute': ['+{n} in the last minute', '最近一分钟 +{n}'], 'overview.plan': ['Read plan', '读取计划'],
  'overview.show': ['Channels', '通道'], 'overview.view': ['View', '视图'], 'overview.cards': ['Cards', '卡片'], 'overview.rows': ['Rows', '列表'], 'overview.none': ['No bus is known yet.', '尚无总线。'],
  'overview.none-hint': ['Buses show up here as soon as a bridge of this domain reports them.', '此域中的网桥一旦上报，总线就会显示在这里。'],
  'overview.used-trend': ['Used in the last {time}', '最近 {time} 的占用'], 'overview.alarms': ['Alarms', '报警'],
  'overview.report-age': ['Report', '报告'], 'overview.causes': ['Failed exchanges', '失败的交换'],
  'overview.because': ['because of {cause}', '原因：{cause}'], 'overview.clock': ['Clock offset', '时钟偏差'],
  'overview.clock-ahead': ['The clock of this station is {by} ahead of the clock of bridge {bridge}. Synchronize both with NTP.', '本站时钟比网桥 {bridge} 的时钟快 {by}。请用 NTP 同步两者。'],
  'overview.clock-behind': ['The clock of this station is {by} behind the clock of bridge {bridge}. Synchronize both with NTP.', '本站时钟比网桥 {bridge} 的时钟慢 {by}。请用 NTP 同步两者。'],
  'overview.contested': ['Contested: {bridge} also claims to serve a bus of this name. Stop or rename one of them.', '冲突：{bridge} 也声明服务于同名总线。请停止或重命名其中之一。'],
  'overview.contested-short': ['contested', '冲突'],
  'overview.late': ['Cause of the last minute', '最近一分钟的原因'],
  'overview.refused': ['{bridge} has a bus of this name and does not serve it, because this bridge does.', '{bridge} 有同名总线，但因本网桥正在服务而未服务该总线。'],
} as const;

const rowsFrom = 9;  // buses; fewer are cards unless the user chooses
const viewKey = 'fieldcast.overview';
const trendFor_ms = 300_000;
const minute_ms = 60_000;
const mostClockOffset_ms = 1000;
const staleAfter_ms = 5000;  // a bridge reports every second

function slowest(devices: Iterable<Device>, bus: string): Device | undefined {
  let found: Device | undefined;
  for (const device of devices)
    if (device.bus === bus && device.state !== 'offline' && (!found || device.answer_time_ms > found.answer_time_ms)) found = device;
  return found;
}

// Returns the growth of a counter within the time; undefined if there are too few reports.
function grown(loads: readonly Load[], field: 'misses' | 'exchanges', within_ms: number): { by: number; in_s: number } | undefined {
  const last = loads.at(-1);
  if (!last) return undefined;
  const from = loads.find((load) => last.at_ms - load.at_ms <= within_ms);
  return !from || from === last ? undefined : { by: Math.max(0, last[field] - from[field]), in_s: (last.at_ms - from.at_ms) / 1000 };
}

function trend(loads: readonly Load[]): TemplateResult {
  const end = loads.at(-1)?.at_ms ?? 0;
  const span_ms = Math.max(minute_ms / 6, Math.min(trendFor_ms, end - (loads[0]?.at_ms ?? end)));  // the line fills its width
  const points = loads.map((load) =>
    `${(300 - ((end - load.at_ms) / span_ms) * 300).toFixed(1)},${(31 - Math.min(1, load.utilisation) * 30).toFixed(1)}`);
  return html`<svg class="spark" viewBox="0 0 300 32" preserveAspectRatio="none" role="img" aria-label=${t('overview.used-trend', { time: duration(span_ms) })}>
    <title>${t('overview.used-trend', { time: duration(span_ms) })}</title><path class="spark-full" d="M0 1H300"></path>
    ${points.length > 1 ? svg`<polyline points=${points.join(' ')}></polyline>` : nothing}
  </svg>`;
}

const causes = (counts: Counts): TemplateResult | string => {
  const rows = Object.entries(counts).sort((a, b) => b[1] - a[1]).slice(0, 4);
  return rows.length ? html`${rows.map(([cause, n]) => html`<span class="cause">${word('cause', cause)} <b>${count(n)}</b></span>`)}` : t('overview.no-misses');
};

// Other bridges that announce this bus, outside the reporting bridge's standby group: those that serve it too, and those that wait.
function claims(bridges: ReadonlyMap<string, Bridge>, bus: Bus): { serving: string; waiting: string } {
  const group = bridges.get(bus.bridge)?.standby_group;
  const others = [...bridges.values()].filter((each) => each.bridge !== bus.bridge && !(group && each.standby_group === group));
  const named = (serving: boolean): string => others.filter((each) => each.buses.some((claim) => claim.bus === bus.bus && claim.serving === serving))
    .map((each) => `${each.bridge} (${each.host})`).slice(0, 4).join(', ');
  return { serving: named(true), waiting: named(false) };
}

// Why refreshes of the last minute were missed although their device responds.
function lateOf({ plant }: Context, bus: Bus): string | undefined {
  const loads = plant.loads.get(bus.bus) ?? [], last = loads.at(-1)?.at_ms ?? 0;
  const timeout_ms = Math.max(0, ...[...plant.devices.values()].filter((device) => device.bus === bus.bus).map((device) => device.timeout_ms));
  return lateText(loads.filter((load) => last - load.at_ms <= minute_ms), bus, timeout_ms);
}

interface BusView {
  bus: Bus;
  tally: Tally | undefined;
  need: BusNeed;
  alarms: number;  // active
}

function viewOf(context: Context, bus: Bus, tally: Tally | undefined): BusView {
  const { plant } = context;
  const alarms = [...plant.alarms.values()].filter((alarm) => alarm.bus === bus.bus);
  return {
    bus, tally, alarms: alarms.filter((alarm) => alarm.active).length,
    need: {
      contested: claims(plant.bridges, bus).serving !== '', bad: tally?.bad ?? 0, missed: grown(plant.loads.get(bus.bus) ?? [], 'misses', minute_ms)?.by ?? 0,
      alarms: alarms.filter((alarm) => alarm.active && !alarm.suppressed && !isShelved(alarm, context.now())).length,
    },
  };
}

// One line for each of many buses.
function row(context: Context, { bus, tally, alarms, need }: BusView): TemplateResult {
  const stale = context.now() - bus.reported_ms > staleAfter_ms;
  return html`<li class=${stale ? 'bus-row stale' : 'bus-row'} aria-label=${bus.bus}>
    <b class="name"><a href=${link('plan', [bus.bus])} title=${bus.bus}>${bus.bus}</a></b>${stateBadge(bus.state)}
    <span class="marks">${alarms ? html`<a href=${link('alarms')}>${badge('bad', `${count(alarms)} ${t('overview.alarms')}`)}</a>` : nothing}
      ${need.contested ? badge('bad', t('overview.contested-short')) : nothing}
      ${need.bad ? html`<a href=${link('live', [], { q: `${bus.bus}/*`, bad: '' })}>${badge('bad', `${count(need.bad)} ${t('overview.bad')}`)}</a>` : nothing}
      ${bus.stretch > 1.005 ? html`<span title=${overloadText(bus)}>${badge('warning', `×${bus.stretch.toFixed(2)}`)}</span>` : nothing}
      ${need.missed ? badge('warning', t('overview.last-minute', { n: count(need.missed) })) : nothing}
      ${bus.closed_because ? html`<span class="muted">${word('cause', bus.closed_because)}</span>` : nothing}</span>
    <a class="number" href=${link('live', [], { q: `${bus.bus}/*` })}>${count(tally?.all ?? 0)} ${t('overview.show')}</a>
    <span class="number" title=${t('overview.planned-hint')}><span class="muted">${t('overview.planned')}</span> ${percent(bus.planned_load)}</span>
    <span class="number" title=${t('overview.used-hint')}><span class="muted">${t('overview.used')}</span> ${percent(bus.utilisation)}</span>
    ${trend(context.plant.loads.get(bus.bus) ?? [])}</li>`;
}

function card(context: Context, { bus, tally, alarms }: BusView): TemplateResult {
  const { plant } = context;
  const reportAge_ms = context.now() - bus.reported_ms;
  const loads = plant.loads.get(bus.bus) ?? [];
  const device = slowest(plant.devices.values(), bus.bus);
  const ahead_ms = bus.clock_ahead_ms;
  const { serving, waiting } = claims(plant.bridges, bus);
  const overload = overloadText(bus), late = lateOf(context, bus);
  const recent = grown(loads, 'misses', minute_ms);
  const rate = grown(loads, 'exchanges', 10_000);
  return html`<article class=${reportAge_ms > staleAfter_ms ? 'card bus stale' : 'card bus'} aria-label=${bus.bus}>
    <header><h2><a href=${link('live', [], { q: `${bus.bus}/*` })}>${bus.bus}</a></h2>${stateBadge(bus.state)}</header>
    <p class="muted sub">${bus.bridge}${bus.closed_because ? ` · ${t('overview.because', { cause: word('cause', bus.closed_because) })}` : ''}
      <span class="space"></span>${t('overview.report-age')} ${age(reportAge_ms)}</p>
    ${serving ? html`<p class="sub bad-text" role="alert">${t('overview.contested', { bridge: serving })}</p>` : nothing}
    ${waiting ? html`<p class="sub warn">${t('overview.refused', { bridge: waiting })}</p>` : nothing}
    ${ahead_ms !== undefined && Math.abs(ahead_ms) > mostClockOffset_ms ? html`<p class="sub warn">${
      t(ahead_ms > 0 ? 'overview.clock-ahead' : 'overview.clock-behind', { by: duration(Math.abs(ahead_ms)), bridge: bus.bridge })}</p>` : nothing}
    ${bar('planned', t('overview.planned'), bus.planned_load, t('overview.planned-hint'))}
    ${bar('measured', t('overview.measured'), bus.measured_load, t('overview.measured-hint'))}
    ${bar('used', t('overview.used'), bus.utilisation, t('overview.used-hint'))}
    ${trend(loads)}
    <dl class="facts">
      ${fact(t('overview.channels'), html`${count(tally?.all ?? 0)}${tally?.bad ? html` ${badge('bad', `${count(tally.bad)} ${t('overview.bad')}`)}` : nothing}`)}
      ${fact(t('overview.exchanges'), rate ? (rate.by / rate.in_s).toFixed(1) : '–')}
      ${fact(t('overview.slowest'), device ? html`${device.device} <b>${duration(device.answer_time_ms)}</b>` : '–')}
      ${ahead_ms === undefined ? nothing : fact(t('overview.clock'), `${ahead_ms < 0 ? '−' : '+'}${duration(Math.abs(ahead_ms))}`)}
      ${fact(t('overview.alarms'), alarms ? html`<a href=${link('alarms')}>${badge('bad', count(alarms))}</a>` : '0')}
      ${fact(t('overview.misses'), html`<b>${count(bus.deadline_misses)}</b>${recent?.by ? html` <span class="warn">${
        t('overview.last-minute', { n: count(recent.by) })}</span>` : nothing} ${bus.deadline_misses ? causes(bus.misses) : nothing}`, true)}
      ${fact(t('overview.causes'), causes(bus.causes), true)}
      ${late ? fact(t('overview.late'), html`<span class="warn">◆ ${late}</span>`, true) : nothing}
      ${overload ? fact(t('overview.stretch'), html`<span class="warn">◆ ×${bus.stretch.toFixed(2)}</span> ${overload} ${bridgeAdvice(context, bus)}`, true) : nothing}
    </dl>
    <footer><a href=${link('live', [], { q: `${bus.bus}/*` })}>${t('overview.show')}</a><a href=${link('plan', [bus.bus])}>${t('overview.plan')}</a></footer>
  </article>`;
}

export const page: MakePage = (context) => {
  const element = makeElement('overview');
  let chosen = localStorage.getItem(viewKey);
  const draw = (): void => {
    const { plant } = context, tallies = plant.count();
    const views = worstFirst([...plant.buses.values()].map((bus) => viewOf(context, bus, tallies.get(bus.bus))));
    const asRows = chosen ? chosen === 'rows' : views.length >= rowsFrom;
    const choose = (view: string) => (): void => {
      localStorage.setItem(viewKey, (chosen = view));
      draw();
    };
    const choice = (view: 'cards' | 'rows'): TemplateResult => html`<button type="button" class="choice" aria-pressed=${asRows === (view === 'rows')}
      @click=${choose(view)}>${t(`overview.${view}`)}</button>`;
    render(html`<h1 class="unseen">${t('overview.title')}</h1>${sitesSection(plant, context.now())}
      ${views.length > 1 ? html`<div class="choice-row view-choice" role="group" aria-label=${t('overview.view')}>${choice('cards')}${choice('rows')}</div>` : nothing}
      ${asRows && views.length ? html`<ul class="bus-rows">${repeat(views, ({ bus }) => bus.bus, (view) => row(context, view))}</ul>` :
        views.length ? html`<div class="cards">${repeat(views, ({ bus }) => bus.bus, (view) => card(context, view))}</div>` :
        plant.stream ? nothing : empty(t('overview.none'), t('overview.none-hint'))}`, element);
  };
  return {
    element,
    paint: (change) => { if (change.second || change.topics.has('connection')) draw(); },
  };
};
