// Every channel in one table: filter, sort, group by device, bad ones first, pinned ones on top. The document contains only visible
// rows, and only cells with a changed value are updated.

import { render } from 'lit-html';
import type { Context, MakePage } from '../context';
import { age, count, duration, tableValue } from '../format';
import { t } from '../i18n';
import { html } from '../markup';
import { meter } from '../meter';
import { printable, setText } from '../printable';
import { channelLink } from '../router';
import { arrange } from '../rows';
import type { Choice, Rows, SortKey } from '../rows';
import { VirtualTable } from '../table';
import type { Row } from '../table';
import { isLate, notYetRead } from '../types';
import { makeElement, qualityText, shape, toneOfQuality } from '../view';

export const texts = {
  'live.title': ['Live', '实时'], 'live.filter': ['Filter', '筛选'], 'live.filter-hint': ['press-shop/* or words', 'press-shop/* 或关键词'],
  'live.only-bad': ['Only bad', '仅异常'], 'live.bad-first': ['Bad first', '异常优先'], 'live.group': ['By device', '按设备'],
  'live.shown': ['{n} of {all}', '{n} / {all}'], 'live.table': ['Channels and their values', '通道及其数值'],
  'live.quality': ['Quality', '质量'], 'live.channel': ['Channel', '通道'], 'live.value': ['Value', '数值'], 'live.unit': ['Unit', '单位'],
  'live.age': ['Age', '时长'], 'live.refresh': ['Refresh', '刷新'], 'live.at': ['Address', '地址'],
  'live.none': ['No channel fits the filter.', '没有符合筛选的通道。'], 'live.never': ['never', '从未'], 'live.pin-row': ['Pin {path} on top', '将 {path} 置顶'],
  'live.trend': ['Trend', '趋势'], 'live.pinned': ['Pinned', '已置顶'], 'live.description': ['Description', '说明'],
} as const;

const pinsKey = 'fieldcast.pins';
const mostPins = 200;
const trendWidth = 90, trendHeight = 20;
const longValue = 12;  // characters; a longer text may be cut off

function readPins(): Set<string> {
  try {
    return new Set((JSON.parse(localStorage.getItem(pinsKey) ?? '[]') as string[]).slice(0, mostPins));
  } catch {
    return new Set();
  }
}

function setTitle(element: HTMLElement, received: string): void {
  const text = printable(received);
  if (element.title !== text) element.title = text;
}

class LiveTable {
  readonly table: VirtualTable;
  private found: Rows = { rows: new Int32Array(0), headings: [], channels: 0 };
  private arrangedAt = -1;  // plant.qualityChanges
  private readonly pins = readPins();
  private second = false;
  private trendTurn = false;  // there are new values for the trends
  private trendTaken = -1;
  readonly choice: Choice;

  constructor(private readonly context: Context, private readonly changed: () => void) {
    this.choice = {
      filter: context.route.query.get('q') ?? '', onlyBad: context.route.query.has('bad'), badFirst: false,
      group: context.route.query.has('group'), sort: 'channel', descending: false, pinned: this.pins };
    this.table = new VirtualTable({
      label: t('live.table'),
      columns: [
        { key: 'pin', label: '★' }, { key: 'quality', label: t('live.quality'), sortable: true },
        { key: 'channel', label: t('live.channel'), sortable: true }, { key: 'value', label: t('live.value'), sortable: true },
        { key: 'unit', label: t('live.unit') }, { key: 'trend', label: t('live.trend') }, { key: 'age', label: t('live.age'), sortable: true },
        { key: 'refresh', label: t('live.refresh'), sortable: true }, { key: 'at', label: t('live.at') },
        { key: 'description', label: t('live.description') },
      ],
      paintRow: (row, fresh) => this.paintRow(row, fresh),
      open: (index) => this.open(index),
      sort: (key) => this.sort(key as SortKey),
    });
    this.table.element.classList.add('live-table');
    this.table.setSort('channel', false);
  }

  get shown(): number { return this.found.channels; }

  arrange(): void {
    this.found = arrange(this.context.plant, this.choice);
    this.arrangedAt = this.context.plant.qualityChanges;
    this.table.setCount(this.found.rows.length);
    this.changed();
  }

  paint(values: boolean, second: boolean): void {
    const byQuality = this.choice.badFirst || this.choice.onlyBad || this.choice.sort === 'quality';
    const moves = this.choice.sort === 'value' || this.choice.sort === 'age';
    if (second && (moves || (byQuality && this.arrangedAt !== this.context.plant.qualityChanges))) this.arrange();
    if (!values && !second) return;
    this.second = second;
    this.trendTurn = this.trendTaken !== (this.trendTaken = this.context.plant.recent.taken);
    this.table.paint();
    this.second = this.trendTurn = false;
  }

  togglePin(index: number): void {
    const path = this.context.plant.channels.get(this.found.rows[index] ?? -1)?.path;
    if (!path) return;
    if (!this.pins.delete(path)) this.pins.add(path);
    localStorage.setItem(pinsKey, JSON.stringify([...this.pins].slice(0, mostPins)));
    this.arrange();
  }

  private sort(key: SortKey): void {
    this.choice.descending = this.choice.sort === key ? !this.choice.descending : false;
    this.choice.sort = key;
    this.table.setSort(key, this.choice.descending);
    this.arrange();
  }

  private open(index: number): void {
    const channel = this.context.plant.channels.get(this.found.rows[index] ?? -1);
    if (channel) this.context.go(channelLink(channel.path));
  }

  private paintRow(row: Row, fresh: boolean): void {
    const id = this.found.rows[row.index];
    if (id === undefined) return;
    if (id < 0) return this.paintHeading(row, this.found.headings[-1 - id] ?? '');
    const { plant } = this.context;
    const channel = plant.channels.get(id);
    if (!channel) return;
    if (fresh) {
      row.element.classList.remove('heading');
      this.paintAbout(row, id);
    }
    const stamp = plant.stamp[id] ?? 0;
    const acquired_ms = plant.acquired_ms[id] ?? 0;
    if (fresh || row.mark !== stamp) {
      row.mark = stamp;
      const quality = plant.quality[id] ?? notYetRead;
      const tone = toneOfQuality(quality);
      row.element.dataset['tone'] = tone;
      const [, state, , value] = row.cells as HTMLElement[];
      setText(state!, `${shape(tone)} ${qualityText(quality)}`);
      const text = plant.texts.get(id) ?? (acquired_ms === 0 ? '–' : tableValue(channel, plant.value[id] ?? NaN));
      setText(value!, text);
      setTitle(value!, text.length > longValue ? text : '');
      if (!fresh) meter.painted(acquired_ms);
    } else if (!this.second) {
      return;
    }
    if (fresh || this.trendTurn) this.paintTrend(row.cells[5]!, plant.recent.path(id, trendWidth, trendHeight));
    const age_ms = this.context.now() - acquired_ms;
    row.element.classList.toggle('late', acquired_ms > 0 && isLate(channel, age_ms));
    setText(row.cells[6]!, acquired_ms === 0 ? t('live.never') : age(age_ms));
  }

  private paintHeading(row: Row, device: string): void {
    delete row.element.dataset['tone'];
    row.element.classList.remove('late');
    row.element.classList.add('heading');
    row.cells[5]!.replaceChildren();
    row.cells.forEach((cell, index) => setText(cell, index === 2 ? device || `★ ${t('live.pinned')}` : ''));
  }

  private paintTrend(cell: HTMLElement, path: string): void {
    let line = cell.querySelector('path');
    if (!line) {
      const make = <K extends 'svg' | 'path'>(name: K): SVGElementTagNameMap[K] => document.createElementNS('http://www.w3.org/2000/svg', name);
      const picture = make('svg');
      picture.setAttribute('viewBox', `0 -2 ${trendWidth} ${trendHeight + 4}`);
      picture.ariaHidden = 'true';
      picture.append(line = make('path'));
      cell.append(picture);
    }
    line.setAttribute('d', path);
  }

  // Paints what does not change while a row shows the same channel.
  private paintAbout(row: Row, id: number): void {
    const channel = this.context.plant.channels.get(id)!;
    const pinned = this.pins.has(channel.path);
    let pin = row.cells[0]!.firstElementChild as HTMLButtonElement | null;
    if (!pin) {
      pin = document.createElement('button');
      pin.type = 'button';
      pin.tabIndex = -1;
      pin.addEventListener('click', () => this.togglePin(row.index));
      row.cells[0]!.replaceChildren(pin);
    }
    setText(pin, pinned ? '★' : '☆');
    pin.setAttribute('aria-label', t('live.pin-row', { path: channel.path }));
    pin.setAttribute('aria-pressed', String(pinned));
    const name = this.choice.group && !pinned ? channel.path.slice(channel.path.lastIndexOf('/') + 1) : channel.path;
    setText(row.cells[2]!, name);
    setTitle(row.cells[2]!, channel.path);
    setText(row.cells[4]!, channel.unit);
    setText(row.cells[7]!, channel.refresh_ms ? duration(channel.refresh_ms) : '–');
    setText(row.cells[8]!, channel.at);
    setText(row.cells[9]!, channel.description);
    for (const cell of [4, 8, 9]) setTitle(row.cells[cell]!, row.cells[cell]!.textContent ?? '');
  }
}

export const page: MakePage = (context) => {
  const element = makeElement('live');
  const tools = document.createElement('div');
  tools.className = 'tools';
  const live = new LiveTable(context, () => draw());
  const { choice } = live;
  const toggle = (key: 'onlyBad' | 'badFirst' | 'group') => (event: Event): void => {
    choice[key] = (event.target as HTMLInputElement).checked;
    live.arrange();
  };
  const filter = (event: Event): void => {
    choice.filter = (event.target as HTMLInputElement).value;
    live.arrange();
  };
  const draw = (): unknown => render(html`<h1 class="unseen">${t('live.title')}</h1>
    <input type="search" class="filter" aria-label=${t('live.filter')} placeholder="${t('live.filter-hint')}  ( / )" .value=${choice.filter}
      spellcheck="false" autocapitalize="none" @input=${filter}>
    <label><input type="checkbox" .checked=${choice.onlyBad} @change=${toggle('onlyBad')}>${t('live.only-bad')}</label>
    <label><input type="checkbox" .checked=${choice.badFirst} @change=${toggle('badFirst')}>${t('live.bad-first')}</label>
    <label><input type="checkbox" .checked=${choice.group} @change=${toggle('group')}>${t('live.group')}</label>
    <span class="muted number" role="status">${live.shown || !context.plant.channels.size ?
      t('live.shown', { n: count(live.shown), all: count(context.plant.channels.size) }) : t('live.none')}</span>`, tools);
  element.append(tools, live.table.element);
  draw();
  return {
    element,
    paint: (change) => {
      if (change.topics.has('catalogue')) live.arrange();
      live.paint(change.values, change.second);
    },
    focusFilter: () => tools.querySelector<HTMLInputElement>('.filter')?.focus(),
    key: (event) => {
      if (event.key === 'ArrowDown' && document.activeElement !== live.table.element) {
        live.table.element.focus();
        live.table.select(Math.max(0, live.table.selected));
        return true;
      }
      if (event.key === 'p' && live.table.selected >= 0) {
        live.togglePin(live.table.selected);
        return true;
      }
      return false;
    },
  };
};
