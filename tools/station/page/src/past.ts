// A list of stored events of a time range: filter, range, CSV. The page defines the columns. A range that ends now receives new events: the
// store commits them some time after they happen.

import { nothing, render } from 'lit-html';
import { query, request } from './api';
import { csvText, download } from './csv';
import type { Cell } from './csv';
import type { Change, Context } from './context';
import { count } from './format';
import { t } from './i18n';
import { ListTable } from './list';
import type { ListColumn } from './list';
import { html } from './markup';
import { rangeOf, rangeTools } from './time_range';
import type { Range } from './time_range';
import { empty, errorText } from './view';

const most = 5000;
const again_ms = 3000;
const overlap_ms = 60_000;  // longer than the store takes to commit

export interface PastOwner<T> {
  label: string;
  className: string;
  parts: readonly string[];  // of the address
  columns: ListColumn<T>[];
  tone?(item: T): string;
  path: string;  // of the resource
  itemsOf(answer: Record<string, T[]>): T[];
  textOf(item: T): string;  // for the filter
  none: string;
  file: string;
  csvHead: readonly string[];
  csvRow(item: T): Cell[];
}

export class PastList<T extends { at_ms: number }> {
  readonly element = document.createElement('div');
  readonly tools = document.createElement('div');
  private readonly list: ListTable<T>;
  private readonly range: Range;
  private readonly asked = new AbortController();
  private readonly note = document.createElement('div');
  private items: T[] | undefined;
  private filter = '';
  private fault = '';
  private readonly timer: number | undefined;

  constructor(private readonly context: Context, private readonly owner: PastOwner<T>) {
    this.tools.className = 'tools';
    this.element.className = 'past';
    this.note.className = 'nothing';
    this.range = rangeOf(context, '1d');
    this.list = new ListTable<T>({ ...owner, keyOf: this.keyOf });
    this.element.append(this.list.element, this.note);
    void this.load();
    if (this.range.span) this.timer = window.setInterval(() => void this.loadNew(), again_ms);
  }

  paint(change: Change): void {
    if (change.topics.has('catalogue')) this.list.paint();  // units
    if (change.topics.size) this.draw();
  }
  key(event: KeyboardEvent): boolean { return this.list.key(event); }
  focusFilter(): void { this.tools.querySelector<HTMLInputElement>('.filter')?.focus(); }
  close(): void {
    window.clearInterval(this.timer);
    this.asked.abort();
  }

  private async load(): Promise<void> {
    if (!this.context.me.store) return;
    try {
      this.items = await this.read(this.range.from_ms, this.range.to_ms);
    } catch (error) {
      if (this.asked.signal.aborted) return;
      this.fault = errorText(error);
    }
    this.arrange();
  }

  private async loadNew(): Promise<void> {
    if (document.hidden || !this.items) return;
    const newest = this.items[0]?.at_ms;
    try {
      const read = await this.read(newest === undefined ? this.range.from_ms : newest - overlap_ms, this.context.now());
      const known = new Set(this.items.map(this.keyOf));
      const fresh = read.filter((item) => !known.has(this.keyOf(item)));
      if (!fresh.length) return;
      this.items = [...fresh, ...this.items].sort((a, b) => b.at_ms - a.at_ms).slice(0, most);
    } catch {
      return;  // the station does not respond; the next attempt is soon
    }
    this.arrange();
  }

  private async read(from_ms: number, to_ms: number): Promise<T[]> {
    const answer = await request<Record<string, T[]>>(
      query(this.owner.path, { from: Math.floor(from_ms), to: Math.ceil(to_ms), limit: most }), undefined, this.asked.signal);
    return this.owner.itemsOf(answer).sort((a, b) => b.at_ms - a.at_ms);
  }

  private readonly keyOf = (item: T): string => `${item.at_ms} ${this.owner.textOf(item)}`;

  private arrange(): void {
    const words = this.filter.toLowerCase().split(/\s+/).filter(Boolean);
    this.list.set((this.items ?? []).filter((item) => {
      const text = this.owner.textOf(item).toLowerCase();
      return words.every((each) => text.includes(each));
    }));
    this.draw();
  }

  private readonly save = (): void => {
    download(this.owner.file, csvText(this.owner.csvHead, this.list.items.map((item) => this.owner.csvRow(item))));
  };

  private draw(): void {
    const type = (event: Event): void => {
      this.filter = (event.target as HTMLInputElement).value;
      this.arrange();
    };
    const { items, fault } = this;
    const { store } = this.context.me;
    render(store ? html`<input type="search" class="filter" aria-label=${t('alarms.filter')} placeholder="${t('alarms.filter')}  ( / )"
        .value=${this.filter} spellcheck="false" autocapitalize="none" @input=${type}>
      ${rangeTools(this.context, this.range, this.owner.parts)}
      <button type="button" ?disabled=${!this.list.items.length} @click=${this.save}>${t('range.csv')}</button>
      <span class="muted" role="status">${items ? t(items.length >= most ? 'range.most' : 'range.found', { n: count(this.list.items.length) }) : nothing}</span>` : nothing, this.tools);
    this.element.classList.toggle('none', !this.list.items.length);
    render(this.list.items.length ? nothing : !store ? empty(t('history.no-store'), t('history.no-store-hint')) :
      fault ? empty(fault) : empty(items ? this.owner.none : t('loading')), this.note);
  }
}
