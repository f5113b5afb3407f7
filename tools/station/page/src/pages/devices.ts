// Devices: health with reason, learned values, refusals, failures, maintenance. #/devices/BUS/DEVICE shows one device.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { endMaintenance, startMaintenance } from '../alarm_actions';
import type { Change, Context, MakePage } from '../context';
import { deviceStates, failedShare, grownCause, orderedDevices, pathOf, reasonOf } from '../device_health';
import type { Reason } from '../device_health';
import { age, count, duration, percent } from '../format';
import { t, word } from '../i18n';
import { ListTable } from '../list';
import { html } from '../markup';
import { ResponseTrend } from '../response_trend';
import { link } from '../router';
import { SplitPage } from '../split_page';
import type { Description, Device } from '../types';
import { bar, empty, fact, shape, stateBadge, toneOfState } from '../view';
import '../../styles/devices.css';

export const texts = {
  'devices.title': ['Devices', '设备'], 'devices.table': ['Devices and how they are', '设备及其状态'], 'devices.state': ['State', '状态'],
  'devices.device': ['Device', '设备'], 'devices.reason': ['Reason', '原因'], 'devices.answer': ['Answer', '应答'], 'devices.failed': ['Failed', '失败'],
  'devices.missed': ['Missed', '错过'], 'devices.none': ['No device is known yet.', '尚无设备。'], 'devices.none-fits': ['No device fits.', '没有符合的设备。'],
  'devices.unknown': ['No bridge tells of {device}.', '没有网桥报告 {device}。'], 'devices.programmed': ['programmed by {who}', '{who} 正在编程'],
  'devices.bus-closed': ['bus closed: {cause}', '总线已关闭：{cause}'],
  'devices.bus-leased': ['the bus rests while another device is programmed', '另一设备编程期间总线暂停'],
  'devices.refuses': ['refuses {n} addresses', '拒绝 {n} 个地址'], 'devices.refuses-one': ['refuses one address', '拒绝一个地址'],
  'devices.not-read': ['nothing was read yet', '尚未读取'], 'devices.fine': ['Answers in time.', '应答及时。'],
  'devices.in-maintenance': ['in maintenance', '维护中'], 'devices.end-maintenance': ['End maintenance', '结束维护'], 'devices.timeout': ['Timeout', '超时'],
  'devices.pause': ['Pause', '间歇'], 'devices.exchanges': ['Exchanges', '交换'], 'devices.failures': ['Failed exchanges', '失败的交换'],
  'devices.retries': ['Retries', '重试'], 'devices.learned': ['Learned', '已学习'], 'devices.area': ['Area', '区域'],
  'devices.largest': ['Largest block', '最大块'], 'devices.longest': ['Limit', '上限'], 'devices.nothing': ['Nothing was learned yet.', '尚未学习到任何内容。'],
  'devices.refused': ['Refused addresses', '被拒绝的地址'],
  'devices.refused-hint': ['The device answers these with an error. They are tried again from time to time.', '设备对这些地址返回错误。会不时重试。'],
  'devices.protocol': ['Protocol', '协议'], 'devices.at': ['Address', '地址'], 'devices.port': ['Port', '端口'],
  'devices.day': ['Response time of the last day', '最近一天的应答时间'],
  'devices.gaps': ['Gaps', '间隙'], 'devices.gaps-hint': ['No request reaches across these ranges, since the device refuses that.', '设备不允许请求跨越这些范围。'],
} as const;

const staleAfter_ms = 10_000;  // a device with changed counters only is reported every 2 s

function reasonText(reason: Reason): string {
  switch (reason.kind) {
    case 'programmed': return t('devices.programmed', { who: reason.who });
    case 'bus-closed': return t('devices.bus-closed', { cause: word('cause', reason.cause) });
    case 'bus-leased': return t('devices.bus-leased');
    case 'failing': return word('cause', reason.cause);
    case 'refuses': return t(reason.n === 1 ? 'devices.refuses-one' : 'devices.refuses', { n: reason.n });
    case 'not-read': return t('devices.not-read');
    case 'fine': return '';
  }
}

// State that is kept while the user opens a device and returns.
const causes = new Map<string, Device['causes']>();  // of the previous report, by path
const recent = new Map<string, string>();  // the cause that grew last
const kept = { filter: '', state: '' };

class DevicesPage extends SplitPage {
  private readonly tools = document.createElement('div');
  private readonly list: ListTable<Device>;
  private readonly day = new ResponseTrend(this.context, t('devices.day'));

  constructor(context: Context) {
    super(context, t('devices.title'));
    this.tools.className = 'tools';
    this.list = new ListTable<Device>({
      label: t('devices.table'), className: 'device-table', keyOf: pathOf,
      tone: (device) => `d-${toneOfState(device.state)}`,
      open: (device) => context.go(link('devices', [device.bus, device.device])),
      columns: [
        { key: 'state', label: t('devices.state'), text: (device) => `${shape(toneOfState(device.state))} ${word('state', device.state)}` },
        { key: 'device', label: t('devices.device'), text: pathOf, link: (device) => link('devices', [device.bus, device.device]), order: pathOf },
        { key: 'at', label: t('devices.protocol'), text: (device) => this.aboutText(device), hint: (device) => this.about(device)?.port ?? '' },
        { key: 'reason', label: t('devices.reason'), text: (device) => [reasonText(this.reason(device)), this.inMaintenance(device) ? t('devices.in-maintenance') : ''].filter(Boolean).join(' · '), hint: (device) => reasonText(this.reason(device)) },
        { key: 'answer', label: t('devices.answer'), text: (device) => (device.answer_time_ms ? duration(device.answer_time_ms) : '–'), order: (device) => device.answer_time_ms },
        { key: 'failed', label: t('devices.failed'), text: (device) => (device.exchanges ? percent(failedShare(device), 2) : '–'), order: failedShare },
        { key: 'missed', label: t('devices.missed'), text: (device) => count(device.deadline_misses), order: (device) => device.deadline_misses },
      ],
    });
    this.body.append(this.list.element, this.note, this.details);
    this.element.append(this.head, this.tools, this.body);
    render(html`<h1>${t('devices.title')}</h1>`, this.head);
  }

  override paint(change: Change): void {
    if (change.topics.has('devices')) this.noteCauses();
    if (change.second || change.topics.has('alarms') || change.topics.has('sessions')) this.arrange();
  }

  close(): void { this.day.close(); }

  key(event: KeyboardEvent): boolean {
    const device = this.device();
    if (event.key === 'm' && device && this.context.mayOperate()) void this.maintain(device);
    else if (event.key === 'Backspace' && this.chosen) this.context.go(link('devices'));
    else return this.list.key(event);
    return true;
  }

  focusFilter(): void { this.tools.querySelector<HTMLInputElement>('.filter')?.focus(); }

  private device(): Device | undefined { return this.context.plant.devices.get(this.chosen) ?? this.list.selected; }

  private about(device: Device): Description | undefined { return this.context.plant.descriptions.get(pathOf(device)); }

  private aboutText(device: Device): string {
    const about = this.about(device);
    return about ? `${about.protocol} · ${about.address}` : '';
  }

  private noteCauses(): void {
    for (const [path, device] of this.context.plant.devices) {
      const before = causes.get(path);
      if (before === device.causes) continue;
      const grown = before && grownCause(before, device.causes);
      if (grown) recent.set(path, grown);
      else if (device.state === 'online') recent.delete(path);
      causes.set(path, device.causes);
    }
  }

  private reason(device: Device): Reason {
    const { plant } = this.context;
    return reasonOf(device, plant.buses.get(device.bus), plant.sessions.get(pathOf(device)), recent.get(pathOf(device)));
  }

  private inMaintenance(device: Device): boolean {
    for (const alarm of this.context.plant.alarms.values())
      if (alarm.suppressed && alarm.bus === device.bus && alarm.device === device.device) return true;
    return false;
  }

  private async maintain(device: Device): Promise<void> {
    if (this.inMaintenance(device)) await endMaintenance(this.context, device.bus, device.device);
    else await startMaintenance(this.context, device.bus, device.device);
  }

  private arrange(): void {
    const words = kept.filter.toLowerCase().split(/\s+/).filter(Boolean);
    const fitting = orderedDevices(this.context.plant.devices.values()).filter((device) => {
      const text = `${pathOf(device)} ${this.aboutText(device)} ${reasonText(this.reason(device))}`.toLowerCase();
      return words.every((each) => text.includes(each));
    });
    const shown = fitting.filter((device) => !kept.state || device.state === kept.state);
    const same = shown.length === this.list.items.length && !this.list.sorted && shown.every((device, index) => pathOf(device) === pathOf(this.list.items[index]!));
    this.list.set(shown, same);
    if (this.chosen) this.list.select(this.chosen);
    this.list.paint();
    this.draw(fitting);
  }

  private draw(fitting: readonly Device[]): void {
    const type = (event: Event): void => {
      kept.filter = (event.target as HTMLInputElement).value;
      this.arrange();
    };
    const show = (state: string) => (): void => {
      kept.state = state;
      this.arrange();
    };
    const tab = (state: string, text: string, n: number): TemplateResult => html`<button type="button" class="choice" aria-pressed=${kept.state === state}
      @click=${show(state)}>${text} <b>${count(n)}</b></button>`;
    render(html`<input type="search" class="filter" aria-label=${t('alarms.filter')} placeholder="${t('alarms.filter')}  ( / )" .value=${kept.filter}
        spellcheck="false" autocapitalize="none" @input=${type}>
      <span class="choice-row" role="group" aria-label=${t('devices.state')}>${tab('', t('alarms.all'), fitting.length)}
        ${deviceStates.map((state) => tab(state, word('state', state), fitting.filter((device) => device.state === state).length))}</span>`, this.tools);
    this.body.classList.toggle('none', !this.list.items.length);
    render(this.list.items.length ? nothing : empty(t(this.context.plant.devices.size ? 'devices.none-fits' : 'devices.none')), this.note);
    this.details.setAttribute('aria-label', this.chosen || t('devices.device'));
    this.drawDetails();
  }

  private drawDetails(): void {
    const device = this.context.plant.devices.get(this.chosen);
    if (!this.chosen) return;
    if (!device) {
      render(html`<a class="back" href=${link('devices')}>‹ ${t('devices.title')}</a>${empty(t('devices.unknown', { device: this.chosen }))}`, this.details);
      return;
    }
    const { context } = this;
    const reason = reasonText(this.reason(device));
    const reportAge_ms = context.now() - device.reported_ms;
    const maintained = this.inMaintenance(device), about = this.about(device);
    this.details.classList.toggle('stale', reportAge_ms > staleAfter_ms);
    render(html`<a class="back" href=${link('devices')}>‹ ${t('devices.title')}</a>
      <header><h2>${pathOf(device)}</h2>${stateBadge(device.state)}</header>
      <p class="reason">${reason || t('devices.fine')}${maintained ? html` · <b>${t('devices.in-maintenance')}</b>` : nothing}</p>
      <p class="links"><a href=${link('live', [], { q: `${pathOf(device)}/*` })}>${t('overview.show')}</a>
        <a href=${link('plan', [device.bus])}>${t('overview.plan')}</a>
        <a href=${link('programming', [device.bus, device.device])}>${t('programming.title')}</a>
        ${context.mayOperate() ? html`<button type="button" @click=${() => void this.maintain(device)}>${t(maintained ? 'devices.end-maintenance' : 'alarms.maintenance-start')} <kbd>m</kbd></button>` : nothing}</p>
      <dl class="facts">
        ${about ? html`${fact(t('devices.protocol'), about.protocol)}${fact(t('devices.at'), about.address)}${fact(t('devices.port'), about.port)}` : nothing}
        ${fact(t('devices.answer'), html`<b>${duration(device.answer_time_ms)}</b> ± ${duration(device.answer_spread_ms)}`)}
        ${fact(t('devices.timeout'), duration(device.timeout_ms))}
        ${fact(t('devices.pause'), duration(device.pause_ms))}
        ${fact(t('devices.exchanges'), count(device.exchanges))}
        ${fact(t('devices.failures'), html`${count(device.failures)} <span class="muted">${percent(failedShare(device), 2)}</span>`)}
        ${fact(t('devices.retries'), count(device.retries))}
        ${fact(t('devices.missed'), count(device.deadline_misses))}
        ${fact(t('overview.report-age'), age(reportAge_ms))}
      </dl>
      ${this.day.draw(pathOf(device))}
      ${this.areas(device)}
      ${this.addresses(t('devices.refused'), t('devices.refused-hint'), device.refused)}
      ${this.addresses(t('devices.gaps'), t('devices.gaps-hint'), device.refused_gaps)}
      <h3>${t('overview.causes')}</h3>${this.failures(device)}`, this.details);
  }

  private areas(device: Device): TemplateResult {
    return html`<h3>${t('devices.learned')}</h3>${device.areas.length ? html`<div class="scroll" data-scroll tabindex="0" role="region" aria-label=${t('devices.learned')}>
      <table class="plain"><thead><tr><th scope="col">${t('devices.area')}</th><th scope="col" class="number">${t('devices.answer')}</th><th scope="col" class="number">±</th>
        <th scope="col" class="number">${t('devices.largest')}</th><th scope="col" class="number">${t('devices.longest')}</th></tr></thead>
      <tbody>${device.areas.map((area) => html`<tr><td>${area.area}</td><td class="number">${duration(area.answer_time_ms)}</td><td class="number">${duration(area.answer_spread_ms)}</td>
        <td class="number">${count(area.largest_block)}</td><td class="number">${area.longest_block ? count(area.longest_block) : '–'}</td></tr>`)}</tbody></table></div>` :
      html`<p class="muted">${t('devices.nothing')}</p>`}`;
  }

  private addresses(title: string, hint: string, list: readonly string[]): TemplateResult | typeof nothing {
    if (!list.length) return nothing;
    return html`<h3>${title} <b>${count(list.length)}</b></h3><p class="muted">${hint}</p><ul class="addresses">${list.map((each) => html`<li>${each}</li>`)}</ul>`;
  }

  private failures(device: Device): TemplateResult {
    const rows = Object.entries(device.causes).sort((a, b) => b[1] - a[1]);
    const sum = rows.reduce((total, [, n]) => total + n, 0);
    return rows.length ? html`<div class="failures">${rows.map(([cause, n]) => html`${bar('cause-bar', `${word('cause', cause)} ${count(n)}`, n / sum)}`)}</div>` :
      html`<p class="muted">${t('overview.no-misses')}</p>`;
  }
}

export const page: MakePage = (context) => new DevicesPage(context);
