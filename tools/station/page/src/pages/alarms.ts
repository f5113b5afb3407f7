// Alarms by ISA-18.2, those that need attention first. #/alarms shows present alarms, #/alarms/history the events of a time range.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { acknowledge, limitText, shelve, unshelve } from '../alarm_actions';
import { alarmHistory } from '../alarm_history';
import { canNotify, chooseNotices, isNotifying } from '../browser_notices';
import { arrangeAlarms, isShelved, sectionOf, sections, steadyAlarms, wantsSomebody } from '../alarm_rows';
import type { AlarmChoice, Section } from '../alarm_rows';
import type { Change, Context, MakePage } from '../context';
import { age, count, fullTime, shownValue, time } from '../format';
import { t, word } from '../i18n';
import type { Key } from '../i18n';
import { ListTable } from '../list';
import { html } from '../markup';
import { showMessages } from '../message_list';
import { alarmKey } from '../plant';
import { channelLink } from '../router';
import { tabbedPage } from '../tabs';
import { isBad, notYetRead } from '../types';
import type { Alarm, Channel } from '../types';
import { empty, qualityText } from '../view';
import { WorstValues } from '../worst_values';
import '../../styles/alarms.css';

export const texts = {
  'alarms.title': ['Alarms', '报警'], 'alarms.present': ['Present', '当前'], 'alarms.history': ['History', '历史'],
  'alarms.table': ['Alarms that are there', '当前报警'], 'alarms.filter': ['Filter', '筛选'], 'alarms.all': ['All', '全部'],
  'alarms.section-unacknowledged': ['Unacknowledged', '未确认'], 'alarms.section-acknowledged': ['Acknowledged', '已确认'],
  'alarms.section-shelved': ['Shelved', '已搁置'], 'alarms.section-maintenance': ['Maintenance', '维护中'], 'alarms.priority': ['Priority', '优先级'],
  'alarms.state': ['State', '状态'], 'alarms.channel': ['Channel', '通道'], 'alarms.limit': ['Limit', '限值'], 'alarms.value': ['Value', '数值'],
  'alarms.now': ['Now', '当前值'], 'alarms.worst': ['Worst', '最差值'], 'alarms.now-value': ['now {value}', '当前 {value}'], 'alarms.worst-value': ['worst {value}', '最差 {value}'],
  'alarms.held': ['The rows keep their places while you select.', '选择期间，各行保持原位。'],
  'alarms.since': ['Since', '持续'], 'alarms.count': ['Times', '次数'], 'alarms.by': ['By, note', '人员、备注'], 'alarms.at': ['Time', '时间'],
  'alarms.event': ['Event', '事件'], 'alarms.who': ['Who', '人员'], 'alarms.note': ['Note', '备注'], 'alarms.check': ['Choose {path}', '选择 {path}'],
  'alarms.check-all': ['Choose all unacknowledged', '选择全部未确认'], 'alarms.choose': ['Choose an alarm that this can be done to.', '请选择可执行此操作的报警。'],
  'alarms.acknowledge': ['Acknowledge', '确认'], 'alarms.shelve': ['Shelve', '搁置'], 'alarms.unshelve': ['Unshelve', '取消搁置'],
  'alarms.acknowledge-title': ['Acknowledge ({n})', '确认报警（{n}）'], 'alarms.shelve-title': ['Shelve ({n})', '搁置报警（{n}）'],
  'alarms.shelve-hint': ['A shelved alarm asks for nobody until its time is over.', '被搁置的报警在到期之前不再提醒。'],
  'alarms.and-more': ['and {n} more', '以及另外 {n} 条'], 'alarms.for': ['For', '时长'], 'alarms.minutes': ['{n} min', '{n} 分钟'],
  'alarms.hours': ['{n} h', '{n} 小时'], 'alarms.days': ['{n} d', '{n} 天'], 'alarms.acknowledged': ['Acknowledged: {n}', '已确认：{n}'],
  'alarms.shelved': ['Shelved for {time}: {n}', '已搁置 {time}：{n}'], 'alarms.unshelved': ['No longer shelved: {n}', '已取消搁置：{n}'],
  'alarms.failed': ['{what}: failed. {reason}', '{what}：失败。{reason}'], 'alarms.maintenance-title': ['Maintenance of {device}', '维护 {device}'],
  'alarms.maintenance-start': ['Start maintenance', '开始维护'],
  'alarms.maintenance-hint': ['Values are read as before. Alarms of this device ask for nobody until the end.', '数值照常读取。在结束之前，此设备的报警不再提醒。'],
  'alarms.maintenance-started': ['{device} in maintenance for {time}', '{device} 进入维护，时长 {time}'],
  'alarms.maintenance-ended': ['{device}: maintenance has ended', '{device}：维护已结束'], 'alarms.until': ['until {time}', '至 {time}'],
  'alarms.chattering': ['Chattering: {n} times in 10 minutes', '抖动：10 分钟内 {n} 次'], 'alarms.none': ['No alarm', '无报警'],
  'alarms.none-hint': ['No good value is beyond a limit.', '没有有效值超出限值。'], 'alarms.none-fits': ['No alarm fits.', '没有符合的报警。'],
  'alarms.no-events': ['Nothing happened to alarms in this time.', '此时段内没有报警事件。'], 'alarm.unacknowledged': ['unacknowledged', '未确认'],
  'alarm.acknowledged': ['acknowledged', '已确认'], 'alarm.returned': ['returned, unacknowledged', '已恢复，未确认'], 'alarm.clear': ['clear', '正常'],
  'priority.critical': ['critical', '紧急'], 'priority.high': ['high', '高'], 'priority.medium': ['medium', '中'], 'priority.low': ['low', '低'],
  'limit.high-high': ['high-high', '高高'], 'limit.high': ['high', '高'], 'limit.low': ['low', '低'], 'limit.low-low': ['low-low', '低低'],
  'suppressed.maintenance': ['maintenance', '维护中'], 'event.raised': ['raised', '触发'], 'event.cleared': ['cleared', '恢复'],
  'event.acknowledged': ['acknowledged', '确认'], 'event.shelved': ['shelved', '搁置'], 'event.unshelved': ['unshelved', '取消搁置'],
  'event.shelving ended': ['shelving ended', '搁置到期'], 'event.maintenance': ['maintenance', '开始维护'],
  'event.maintenance ended': ['maintenance ended', '维护结束'], 'event.chattering': ['chattering', '开始抖动'],
  'event.chattering ended': ['chattering ended', '抖动结束'], 'range.span': ['Span', '时段'], 'range.from': ['From', '从'], 'range.to': ['To', '到'],
  'range.show': ['Show', '显示'], 'range.csv': ['CSV', 'CSV'], 'range.found': ['{n} entries', '{n} 条'],
  'alarms.notify': ['Notify in this browser', '在此浏览器中通知'], 'alarms.notify-refused': ['The browser does not allow notifications of this page.', '浏览器不允许此页面发送通知。'],
  'alarms.notice-many': ['{n} new alarms', '{n} 条新报警'], 'alarms.messages': ['Messages', '通知消息'],
  'notify.rules': ['Rules', '规则'], 'notify.test': ['Send a test to {name}', '向 {name} 发送测试'],
  'notify.priority': ['priority {priority} or higher', '优先级不低于{priority}'], 'notify.delay': ['after {time}', '{time} 后'],
  'notify.repeat': ['again every {time}, at most {n} times', '每 {time} 重复，最多 {n} 次'], 'notify.escalate': ['after {time} also {to}', '{time} 后另通知 {to}'],
  'notify.cleared': ['also its end', '恢复时也通知'], 'notify.digest': ['more than {n} in {time}: one digest', '{time} 内超过 {n} 条：合并为一条'],
  'notify.file': ['An administrator changes the rules in the file of the station (notify).', '管理员在监控站的配置文件（notify）中修改规则。'],
  'alarms.message-counts': ['Waiting: {waiting}, lost: {lost}', '等待：{waiting}，丢失：{lost}'],
  'alarms.message-none-sent': ['nothing sent yet', '尚未发送'], 'alarms.message-nobody': ['The station notifies nobody.', '此监控站未配置通知。'],
  'message.waiting': ['waiting', '等待'], 'message.sent': ['sent', '已发送'], 'message.expired': ['expired', '已过期'], 'message.dropped': ['dropped', '已丢弃'],
  'range.most': ['the newest {n} entries', '最新的 {n} 条'], 'range.wrong': ['The end must be behind the begin.', '结束时间必须晚于开始时间。'],
} as const;

const heldFor_ms = 10_000;  // a pointer that rests longer selects nothing

const priorityShapes: Record<Alarm['priority'], string> = { critical: '▲', high: '▲', medium: '◆', low: '●' };
const stateShapes: Record<string, string> = { unacknowledged: '▲', returned: '◇', acknowledged: '✓', clear: '○' };

const pathOf = (alarm: Alarm): string => `${alarm.bus}/${alarm.device}/${alarm.channel}`;

// "high > 80 °C"
function boundText(channel: Channel | undefined, alarm: Alarm): string {
  const limit = channel?.limits[alarm.limit];
  return limit === undefined ? limitText(alarm) : `${limitText(alarm)} ${alarm.limit.startsWith('low') ? '<' : '>'} ${limit} ${channel!.unit}`.trim();
}

function stateText(alarm: Alarm, now_ms: number): string {
  if (isShelved(alarm, now_ms)) return `◷ ${t('alarms.until', { time: time(alarm.shelved_until_ms!, now_ms) })}`;
  if (alarm.suppressed) return `○ ${word('suppressed', alarm.suppressed)}`;
  return `${stateShapes[alarm.state] ?? '○'} ${word('alarm', alarm.state)}`;
}

function personText(alarm: Alarm, now_ms: number): string {
  const by = isShelved(alarm, now_ms) ? alarm.shelved_by : alarm.acknowledged_by;
  const at = by === alarm.acknowledged_by && alarm.acknowledged_ms ? time(alarm.acknowledged_ms, now_ms) : '';
  return [by && `${by}${at ? ` ${at}` : ''}`, alarm.note].filter(Boolean).join(' · ');
}

class PresentAlarms {
  readonly element = document.createElement('div');
  readonly tools = document.createElement('div');
  private readonly list: ListTable<Alarm>;
  private readonly choice: AlarmChoice = { filter: '', section: undefined };
  private readonly checked = new Set<string>();
  private readonly worst: WorstValues;
  private pointedAt = -Infinity;
  private held = false;
  private counts: Record<Section, number> = { unacknowledged: 0, acknowledged: 0, shelved: 0, maintenance: 0 };

  constructor(private readonly context: Context) {
    this.tools.className = 'tools';
    // The address in a message: the path and the limit of one alarm.
    this.choice.filter = (context.route.query.get('alarm') ?? '').split('/').slice(0, 3).join('/');
    this.element.className = 'present';
    const now = (): number => context.now();
    this.worst = new WorstValues(context, () => this.list.paint());
    this.list = new ListTable<Alarm>({
      label: t('alarms.table'), className: 'alarm-table', keyOf: alarmKey,
      tone: (alarm) => `p-${alarm.priority} s-${sectionOf(alarm, now())}${alarm.active ? '' : ' inactive'}`,
      choose: () => this.draw(),
      columns: [
        { key: 'check', label: '✓', text: (alarm) => t('alarms.check', { path: alarmKey(alarm) }), checked: (alarm) => this.checked.has(alarmKey(alarm)), toggle: (alarm) => this.toggle(alarm) },
        { key: 'priority', label: t('alarms.priority'), text: (alarm) => `${priorityShapes[alarm.priority] ?? '●'} ${word('priority', alarm.priority)}` },
        { key: 'state', label: t('alarms.state'), text: (alarm) => stateText(alarm, now()) },
        { key: 'channel', label: t('alarms.channel'), text: pathOf, link: (alarm) => channelLink(pathOf(alarm)) },
        { key: 'limit', label: t('alarms.limit'), text: (alarm) => boundText(this.channelOf(alarm), alarm) },
        { key: 'value', label: t('alarms.now'), text: (alarm) => t('alarms.now-value', { value: this.nowText(alarm) }) },
        { key: 'worst', label: t('alarms.worst'), text: (alarm) => t('alarms.worst-value', { value: this.worstText(alarm) }) },
        { key: 'age', label: t('alarms.since'), text: (alarm) => age(now() - alarm.since_ms), hint: (alarm) => fullTime(alarm.since_ms) },
        { key: 'count', label: t('alarms.count'), text: (alarm) => (alarm.chattering ? `⚠ ${alarm.occurrences}×` : alarm.occurrences > 1 ? `${alarm.occurrences}×` : ''),
          hint: (alarm) => (alarm.chattering ? t('alarms.chattering', { n: alarm.occurrences }) : '') },
        { key: 'note', label: t('alarms.by'), text: (alarm) => personText(alarm, now()), hint: (alarm) => personText(alarm, now()) },
      ],
    });
    this.element.append(this.list.element);
    this.list.element.addEventListener('pointermove', () => { this.pointedAt = performance.now(); }, { passive: true });
    this.list.element.addEventListener('pointerleave', () => { this.pointedAt = -Infinity; });
  }

  close(): void { this.worst.close(); }

  paint(change: Change): void {
    if (change.topics.has('alarms') || change.topics.has('catalogue') || (this.held && !this.holds())) this.arrange(this.holds());
    else if (change.second) this.list.paint();
    this.draw();
  }

  focusFilter(): void { this.tools.querySelector<HTMLInputElement>('.filter')?.focus(); }

  key(event: KeyboardEvent): boolean {
    const inTable = document.activeElement === this.list.element;
    const selected = this.list.selected;
    if (event.key === ' ' && inTable && selected) this.toggle(selected);
    else if (event.key === 'Enter' && inTable && selected) this.context.go(channelLink(pathOf(selected)));
    else if (event.key === 'a' && this.context.mayOperate()) void this.acknowledge();
    else if (event.key === 's' && this.context.mayOperate()) void this.shelve();
    else if (event.key === 'u' && this.context.mayOperate()) void this.unshelve();
    else return this.list.key(event);
    return true;
  }

  // The user is about to select a row: the pointer moves over the rows, or some are checked.
  private holds(): boolean { return this.checked.size > 0 || performance.now() - this.pointedAt < heldFor_ms; }

  private channelOf(alarm: Alarm): Channel | undefined {
    return this.context.plant.channelOf(pathOf(alarm));
  }

  // The present value, if it is good.
  private valueOf(alarm: Alarm): number | undefined {
    const { plant } = this.context, id = plant.ids.get(pathOf(alarm)) ?? -1, quality = plant.quality[id] ?? notYetRead;
    return quality === notYetRead || isBad(quality) ? undefined : plant.value[id];
  }

  private withUnit(alarm: Alarm, value: number | null): string {
    const channel = this.channelOf(alarm);
    return `${shownValue(value, channel)} ${channel?.unit ?? ''}`.trim();
  }

  private nowText(alarm: Alarm): string {
    const value = this.valueOf(alarm), { plant } = this.context;
    return value === undefined ? qualityText(plant.quality[plant.ids.get(pathOf(alarm)) ?? -1] ?? notYetRead) : this.withUnit(alarm, value);
  }

  private worstText(alarm: Alarm): string { return this.withUnit(alarm, this.worst.of(alarm, this.valueOf(alarm))); }

  private arrange(hold = false): void {
    const { plant } = this.context;
    const { alarms, counts } = arrangeAlarms(plant.alarms.values(), this.choice, this.context.now());
    this.counts = counts;
    for (const key of this.checked) if (!plant.alarms.has(key)) this.checked.delete(key);
    this.held = hold && this.list.items.length > 0;
    this.list.set(this.held ? steadyAlarms(this.list.items, plant.alarms, alarms) : alarms);
    this.worst.load(this.list.items);
  }

  // Returns the checked alarms; if none is checked, the selected one.
  private chosen(fits: (alarm: Alarm) => boolean): Alarm[] {
    const all = this.checked.size ? [...this.context.plant.alarms.values()].filter((alarm) => this.checked.has(alarmKey(alarm))) :
      this.list.selected ? [this.list.selected] : [];
    return all.filter(fits);
  }

  private readonly mayAcknowledge = (alarm: Alarm): boolean => alarm.state === 'unacknowledged' || alarm.state === 'returned';
  private readonly mayShelve = (alarm: Alarm): boolean => !isShelved(alarm, this.context.now());
  private readonly mayUnshelve = (alarm: Alarm): boolean => isShelved(alarm, this.context.now());

  private acknowledge(): Promise<void> { return this.act(this.mayAcknowledge, acknowledge); }
  private shelve(): Promise<void> { return this.act(this.mayShelve, shelve); }
  private unshelve(): Promise<void> { return this.act(this.mayUnshelve, unshelve); }

  private async act(fits: (alarm: Alarm) => boolean, what: (context: Context, alarms: readonly Alarm[]) => Promise<void>): Promise<void> {
    const alarms = this.chosen(fits);
    if (!alarms.length) return this.context.say(t('alarms.choose'));
    await what(this.context, alarms);
    this.checked.clear();
    this.pointedAt = -Infinity;
    this.arrange();
    this.draw();
  }

  private readonly chooseNotices = async (event: Event): Promise<void> => {
    const { checked } = event.target as HTMLInputElement;
    if (!await chooseNotices(checked) && checked) this.context.say(t('alarms.notify-refused'), true);
    this.draw();
  };

  private toggle(alarm: Alarm): void {
    const key = alarmKey(alarm);
    if (!this.checked.delete(key)) this.checked.add(key);
    this.list.paint();
    this.draw();
  }

  private readonly toggleAll = (): void => {
    const all = this.list.items.filter((alarm) => wantsSomebody(alarm, this.context.now())).map(alarmKey);
    if (all.every((key) => this.checked.has(key))) this.checked.clear();
    else for (const key of all) this.checked.add(key);
    this.list.paint();
    this.draw();
  };

  private draw(): void {
    const { choice } = this;
    const filter = (event: Event): void => {
      choice.filter = (event.target as HTMLInputElement).value;
      this.arrange();
      this.draw();
    };
    const show = (section: Section | undefined) => (): void => {
      choice.section = section;
      this.arrange();
      this.draw();
    };
    const total = sections.reduce((sum, section) => sum + this.counts[section], 0);
    const tab = (section: Section | undefined, text: string, n: number): TemplateResult => html`<button type="button" class="choice"
      aria-pressed=${choice.section === section} @click=${show(section)}>${text} <b>${count(n)}</b></button>`;
    render(html`<input type="search" class="filter" aria-label=${t('alarms.filter')} placeholder="${t('alarms.filter')}  ( / )" .value=${choice.filter}
        spellcheck="false" autocapitalize="none" @input=${filter}>
      <span class="choice-row" role="group" aria-label=${t('alarms.state')}>${tab(undefined, t('alarms.all'), total)}
        ${sections.map((section) => tab(section, t(`alarms.section-${section}` as Key), this.counts[section]))}</span>
      ${canNotify() ? html`<label class="notices"><input type="checkbox" .checked=${isNotifying()} @change=${this.chooseNotices}> ${t('alarms.notify')}</label>` : nothing}
      ${this.context.mayOperate() ? this.buttons() : nothing}<span class="held muted" role="status">${this.held ? t('alarms.held') : ''}</span>`, this.tools);
    this.element.classList.toggle('none', !this.list.items.length);
    let note = this.element.querySelector('.nothing');
    if (!note) {
      note = document.createElement('div');
      note.className = 'nothing';
      this.element.append(note);
    }
    render(this.list.items.length ? nothing : total || choice.filter ? empty(t('alarms.none-fits'))
      : this.context.plant.buses.size ? empty(`✓ ${t('alarms.none')}`, t('alarms.none-hint')) : empty(t('overview.none')), note as HTMLElement);
  }

  private buttons(): TemplateResult {
    const button = (text: string, key: string, n: number, act: () => Promise<void>, primary = false): TemplateResult => html`<button type="button"
      class=${primary && n ? 'primary' : ''} ?disabled=${!n} @click=${() => void act()}>${text}${n > 1 ? ` (${n})` : ''} <kbd>${key}</kbd></button>`;
    return html`<span class="acts">
      <button type="button" class="plain" @click=${() => void showMessages(this.context.mayEngineer())}>${t('alarms.messages')}</button>
      <button type="button" ?disabled=${!this.counts.unacknowledged} @click=${this.toggleAll}>${t('alarms.check-all')}</button>
      ${button(t('alarms.acknowledge'), 'a', this.chosen(this.mayAcknowledge).length, () => this.acknowledge(), true)}
      ${button(t('alarms.shelve'), 's', this.chosen(this.mayShelve).length, () => this.shelve())}
      ${button(t('alarms.unshelve'), 'u', this.chosen(this.mayUnshelve).length, () => this.unshelve())}</span>`;
  }
}

export const page: MakePage = (context) =>
  tabbedPage(context, 'history', [t('alarms.present'), t('alarms.history')], (past) => (past ? alarmHistory(context) : new PresentAlarms(context)));
