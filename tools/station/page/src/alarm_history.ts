// What happened to alarms in a span of time, from the station's store.

import { html, nothing, render } from 'lit-html';
import { limitText } from './alarm_actions';
import { query, request } from './api';
import { csvText, csvTime, download } from './csv';
import type { Change, Context } from './context';
import { count, exactValue, fullTime } from './format';
import { t, word } from './i18n';
import { ListTable } from './list';
import { channelLink, link } from './router';
import { rangeOf, rangeTools } from './time_range';
import type { Range } from './time_range';
import type { AlarmEvent } from './types';
import { empty, errorText } from './view';

const most = 5000;
const shapes: Record<string, string> = { raised: '▲', cleared: '◇', acknowledged: '✓', shelved: '◷', chattering: '⚠' };

export class AlarmHistory {
  readonly element = document.createElement('div');
  readonly tools = document.createElement('div');
  private readonly list: ListTable<AlarmEvent>;
  private readonly range: Range;
  private readonly asked = new AbortController();
  private readonly note = document.createElement('div');
  private events: AlarmEvent[] | undefined;
  private filter = '';
  private fault = '';

  constructor(private readonly context: Context) {
    this.tools.className = 'tools';
    this.element.className = 'past';
    this.note.className = 'nothing';
    this.range = rangeOf(context, '1d');
    const pathOf = (event: AlarmEvent): string => [event.bus, event.device, event.channel].filter(Boolean).join('/');
    this.list = new ListTable<AlarmEvent>({
      label: t('alarms.history'), className: 'event-table', keyOf: (event) => `${event.at_ms} ${pathOf(event)} ${event.limit} ${event.event}`,
      tone: (event) => `e-${event.event.replaceAll(' ', '-')}`,
      columns: [
        { key: 'at', label: t('alarms.at'), text: (event) => fullTime(event.at_ms) },
        { key: 'event', label: t('alarms.event'), text: (event) => `${shapes[event.event] ?? '○'} ${word('event', event.event)}` },
        { key: 'channel', label: t('alarms.channel'), text: pathOf, link: (event) => (event.channel ? channelLink(pathOf(event)) : link('devices', [event.bus, event.device])) },
        { key: 'limit', label: t('alarms.limit'), text: (event) => (event.limit ? limitText(event) : '') },
        { key: 'value', label: t('alarms.value'), text: (event) => this.valueOf(event) },
        { key: 'who', label: t('alarms.who'), text: (event) => event.who },
        { key: 'note', label: t('alarms.note'), text: (event) => [event.until_ms ? t('alarms.until', { time: fullTime(event.until_ms).slice(0, 16) }) : '', event.note].filter(Boolean).join(' · '), hint: (event) => event.note },
      ],
    });
    this.element.append(this.list.element, this.note);
    void this.load();
  }

  paint(change: Change): void { if (change.topics.size) this.draw(); }
  key(event: KeyboardEvent): boolean { return this.list.key(event); }
  focusFilter(): void { this.tools.querySelector<HTMLInputElement>('.filter')?.focus(); }
  close(): void { this.asked.abort(); }

  private valueOf(event: AlarmEvent): string {
    if (event.value === null || event.value === undefined) return '';
    const { plant } = this.context;
    const channel = plant.channels.get(plant.ids.get(`${event.bus}/${event.device}/${event.channel}`) ?? -1);
    return `${exactValue(event.value, channel?.type ?? 'float32')}${channel?.unit ? ` ${channel.unit}` : ''}`;
  }

  private async load(): Promise<void> {
    if (!this.context.me.store) return;
    const { from_ms, to_ms } = this.range;
    try {
      const { events } = await request<{ events: AlarmEvent[] }>(
        query('/api/alarms', { from: Math.floor(from_ms), to: Math.ceil(to_ms), limit: most }), undefined, this.asked.signal);
      this.events = events.sort((a, b) => b.at_ms - a.at_ms);
    } catch (error) {
      if (this.asked.signal.aborted) return;
      this.fault = errorText(error);
    }
    this.arrange();
    this.draw();
  }

  private arrange(): void {
    const words = this.filter.toLowerCase().split(/\s+/).filter(Boolean);
    this.list.set((this.events ?? []).filter((event) => {
      const text = `${event.bus}/${event.device}/${event.channel} ${event.event} ${event.limit} ${event.who} ${event.note}`.toLowerCase();
      return words.every((each) => text.includes(each));
    }));
  }

  private readonly save = (): void => {
    const rows = this.list.items.map((event) => [csvTime(event.at_ms), event.event, event.bus, event.device, event.channel, event.limit, event.value ?? null, event.who, event.note, csvTime(event.until_ms ?? null)]);
    download('alarms.csv', csvText(['at', 'event', 'bus', 'device', 'channel', 'limit', 'value', 'who', 'note', 'until'], rows));
  };

  private draw(): void {
    const type = (event: Event): void => {
      this.filter = (event.target as HTMLInputElement).value;
      this.arrange();
      this.draw();
    };
    const { events, fault } = this;
    render(this.context.me.store ? html`<input type="search" class="filter" aria-label=${t('alarms.filter')} placeholder="${t('alarms.filter')}  ( / )"
        .value=${this.filter} spellcheck="false" autocapitalize="none" @input=${type}>
      ${rangeTools(this.context, this.range, ['history'])}
      <button type="button" ?disabled=${!this.list.items.length} @click=${this.save}>${t('range.csv')}</button>
      <span class="muted" role="status">${events ? t(events.length >= most ? 'range.most' : 'range.found', { n: count(this.list.items.length) }) : nothing}</span>` : nothing, this.tools);
    this.element.classList.toggle('none', !this.list.items.length);
    render(this.list.items.length ? nothing : !this.context.me.store ? empty(t('history.no-store'), t('history.no-store-hint')) :
      fault ? empty(fault) : empty(events ? t('alarms.no-events') : t('loading')), this.note);
  }
}
