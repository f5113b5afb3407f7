// The edit mode of a dashboard: the board with a handle on each widget, the properties of the selected one, and the text beside.
// The station checks each change; a text with a fault is not applied to the board.

import { nothing, render } from 'lit-html';
import { query, request } from '../api';
import type { Change, Context } from '../context';
import { t, word } from '../i18n';
import { html } from '../markup';
import { errorText } from '../view';
import { Board, gap_px } from './board';
import { columnsOf, kinds, parameterRow, printed, rowOf, valuesOf } from './document';
import type { Dashboard, PropertyRow, Widget } from './document';
import { freePlace, placed } from './grid';
import type { Cells } from './grid';
import { Handle } from './handle';
import type { HandleOwner } from './handle';
import { fields } from './property_form';
import type { Picture } from './widget';

interface Fault {
  place: string;
  what: string;
  allowed: string;
}

export interface Draft {
  dashboard: Dashboard;
  base: number;  // the version that is changed; 0: a new dashboard
  name: string;  // of that version
  changed?: boolean;  // and not saved
}

export interface EditorOwner {
  saved(dashboard: Dashboard): void;
  left(): void;
}

const mostSteps = 50;
const mostNames = 20;
const mostVersions = 20;  // kept by the station
const checkAfter_ms = 300;
const titleRow: PropertyRow = { name: 'title', type: 'text', max: 120 };
const usual: Record<string, unknown> = { min: 0, max: 100, value: true };

export class Editor implements HandleOwner {
  readonly element = document.createElement('div');
  private readonly tools = document.createElement('div');
  private readonly side = document.createElement('aside');
  private readonly text = document.createElement('textarea');
  private readonly names = document.createElement('datalist');
  private readonly pictureNames = document.createElement('datalist');
  private readonly board: Board;
  private readonly handles = new Map<HTMLElement, Handle>();
  private readonly steps: Dashboard[] = [];
  private selected = -1;
  private placing = -1;  // the value of the selected picture that the next click places
  private faults: Fault[] = [];
  private fault = '';
  private textDiffers = false;
  private timer = 0;
  private checks = 0;

  constructor(private readonly context: Context, pictures: ReadonlyMap<string, Picture>, private readonly draft: Draft, private readonly owner: EditorOwner) {
    this.board = new Board(context, pictures, (cell, index) => this.dress(cell, index));
    this.element.className = 'editor';
    this.tools.className = 'tools';
    this.side.className = 'card';
    this.side.setAttribute('aria-label', t('dashboard.properties'));
    this.names.id = 'channel-names';
    this.pictureNames.id = 'picture-names';
    render(html`${[...pictures.keys()].map((name) => html`<option value=${name}></option>`)}`, this.pictureNames);
    this.text.spellcheck = false;
    this.text.dataset['scroll'] = '';
    this.text.setAttribute('aria-label', t('dashboard.text'));
    this.text.addEventListener('input', () => this.onTyped());
    this.side.addEventListener('input', (event) => this.propose(event));
    const scroll = document.createElement('div');
    scroll.className = 'board-scroll';
    scroll.dataset['scroll'] = '';
    scroll.append(this.board.element);
    const panel = document.createElement('div');
    panel.className = 'panel';
    panel.append(this.side, this.text, this.names, this.pictureNames);
    this.element.append(this.tools, scroll, panel);
    this.show();
  }

  get changed(): boolean { return this.draft.changed === true; }

  paint(change: Change): void { this.board.paint(change); }

  close(): void {
    clearTimeout(this.timer);
    this.board.close();
  }

  label(index: number): string {
    const { kind, title, at: [column, row, width, height] } = this.widgets[index]!;
    return t('dashboard.handle', { name: `${word('widget', kind)} ${title ?? ''}`.trim(), column: column + 1, row: row + 1, width, height });
  }
  at(index: number): Cells { return this.widgets[index]!.at; }
  step(): { x: number; y: number } {
    return { x: (this.board.element.clientWidth + gap_px) / columnsOf(this.draft.dashboard), y: rowOf(this.draft.dashboard) + gap_px };
  }
  preview(index: number, at: Cells): void { this.board.preview(this.places(index, at)); }
  move(index: number, at: Cells): void {
    const places = this.places(index, at);
    this.change({ widgets: this.widgets.map((widget, each) => ({ ...widget, at: places[each]! })) });
  }
  remove(index: number): void {
    this.selected = -1;
    this.change({ widgets: this.widgets.toSpliced(index, 1) });
  }
  select(index: number): void {
    if (this.selected === index) return;
    this.selected = index;
    this.placing = -1;
    this.drawSide();
    for (const handle of this.handles.values()) handle.relabel(handle.index === index);
  }

  click(index: number, { clientX, clientY }: MouseEvent): void {
    const item = this.placing, picture = this.board.cell(index)?.querySelector<SVGGraphicsElement>('.mimic');
    if (item < 0 || index !== this.selected || !picture) return this.select(index);
    this.placing = -1;
    const box = picture.querySelector('image')!.getBoundingClientRect();
    const percent = (share: number): number => Math.round(1000 * Math.max(0, Math.min(1, share))) / 10;
    const values = (this.widgets[index]!['values'] as Record<string, unknown>[]).with(item, {
      ...(this.widgets[index]!['values'] as Record<string, unknown>[])[item], x: percent((clientX - box.left) / box.width), y: percent((clientY - box.top) / box.height) });
    this.change({ widgets: this.widgets.with(index, { ...this.widgets[index]!, values }) });
  }

  private get widgets(): Widget[] { return this.draft.dashboard.widgets; }

  private places(index: number, at: Cells): Cells[] {
    return placed(this.widgets.map((widget) => widget.at), index, at, columnsOf(this.draft.dashboard));
  }

  private dress(cell: HTMLElement, index: number): void {
    let handle = this.handles.get(cell);
    if (!handle) {
      this.handles.set(cell, (handle = new Handle(this, index)));
      cell.append(handle.element);
    }
    handle.index = index;
    handle.relabel(index === this.selected);
  }

  private change(next: Partial<Dashboard>): void {
    this.steps.push(this.draft.dashboard);
    if (this.steps.length > mostSteps) this.steps.shift();
    Object.assign(this.draft, { dashboard: { ...this.draft.dashboard, ...next }, changed: true });
    this.show();
  }

  private readonly undo = (): void => {
    const last = this.steps.pop();
    if (!last) return;
    this.draft.dashboard = last;
    if (this.selected >= this.widgets.length) this.selected = -1;
    this.show();
  };

  private show(): void {
    this.board.show(this.draft.dashboard, valuesOf(this.draft.dashboard, this.context.route.query));
    for (const cell of this.handles.keys()) if (!cell.isConnected && !this.board.element.contains(cell)) this.handles.delete(cell);
    if (document.activeElement !== this.text) {
      this.text.value = printed(this.draft.dashboard);
      this.textDiffers = false;
    }
    this.drawTools();
    this.drawSide();
    this.checkSoon(() => printed(this.draft.dashboard));
    this.context.plant.touch('connection');  // paints the new widgets
  }

  private onTyped(): void {
    this.textDiffers = true;
    this.drawTools();
    this.checkSoon(() => this.text.value, true);
  }

  private checkSoon(textOf: () => string, apply = false): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.check(textOf(), apply), checkAfter_ms);
  }

  private async check(text: string, apply: boolean): Promise<void> {
    const mine = ++this.checks;
    try {
      const { faults } = await request<{ faults: Fault[] }>('/api/dashboards/check', { text });
      if (mine !== this.checks) return;
      this.faults = faults;
      this.fault = '';
      if (apply && !faults.length) {
        this.textDiffers = false;
        this.change(JSON.parse(text) as Dashboard);
      }
    } catch (error) {
      this.fault = errorText(error);
    }
    this.drawTools();
  }

  private add(kind: string): void {
    const { size, properties } = kinds[kind]!;
    const at = freePlace(this.widgets.map((widget) => widget.at), size, columnsOf(this.draft.dashboard));
    const members = properties.filter((row) => row.required).map((row) => [row.name!, row.type === 'list' ? [''] : usual[row.name!] ?? (row.type === 'text' ? word('widget', kind) : '')]);
    this.selected = this.widgets.length;
    this.change({ widgets: [...this.widgets, { kind, at, ...Object.fromEntries(members) } as Widget] });
    this.board.cell(this.selected)?.querySelector<HTMLElement>('.handle')?.focus();
  }

  private readonly save = async (): Promise<void> => {
    const { dashboard, base, name } = this.draft;
    try {
      // Under a different name the draft is a copy.
      const { version } = await request<{ version: number }>('/api/dashboards/save', { text: printed(dashboard), base: dashboard.name === name ? base : 0 });
      const changed = this.draft.dashboard !== dashboard || this.textDiffers;  // while it was saved
      Object.assign(this.draft, { base: version, name: dashboard.name, changed });
      this.context.say(t('dashboard.saved', { version }));
      if (changed) return this.drawTools();
      this.steps.length = 0;
      this.owner.saved(dashboard);
    } catch (error) {
      this.fault = errorText(error);
      this.drawTools();
    }
  };

  private drawTools(): void {
    const addKind = (event: Event): void => {
      const choice = event.target as HTMLSelectElement;
      if (choice.value) this.add(choice.value);
      choice.value = '';
    };
    const faults = [...(this.fault ? [this.fault] : []), ...this.faults.map(({ place, what, allowed }) => `${place}: ${what}. ${t('dashboard.allowed')}: ${allowed}`)];
    render(html`
      <select aria-label=${t('dashboard.add-widget')} @change=${addKind}><option value="">+ ${t('dashboard.add-widget')}</option>
        ${Object.keys(kinds).map((kind) => html`<option value=${kind}>${word('widget', kind)}</option>`)}</select>
      <button type="button" ?disabled=${!this.steps.length} @click=${this.undo}>${t('dashboard.undo')}</button>
      <button type="button" class="primary" ?disabled=${!this.changed || this.textDiffers || this.faults.length > 0} @click=${this.save}>${t('dashboard.save')}</button>
      <button type="button" class="plain" @click=${() => this.owner.left()}>${t(this.changed ? 'dashboard.discard' : 'dashboard.done')}</button>
      <span class="muted wide">${t('dashboard.keys')}</span>
      <div class="faults" role="alert">${faults.map((text) => html`<p>▲ ${text}</p>`)}</div>`, this.tools);
  }

  private drawSide(): void {
    const widget = this.widgets[this.selected];
    if (!widget) return this.drawDashboard();
    const rows: readonly PropertyRow[] = [titleRow, ...kinds[widget.kind]?.properties ?? []];
    const index = this.selected;
    render(html`<h2>${word('widget', widget.kind)}</h2>
      ${fields(rows, widget, (next) => this.change({ widgets: this.widgets.with(index, next as Widget) }), (row, item) => (row.name === 'values' ? html`<button
        type="button" class="small" aria-pressed=${this.placing === item} @click=${() => this.place(item)}>${t('dashboard.place')}</button>` : nothing))}
      <div class="form-item"><button type="button" @click=${() => this.remove(index)}>${t('dashboard.remove')}</button>
      <button type="button" class="plain" @click=${() => this.select(-1)}>${t('dashboard.whole')}</button></div>`, this.side);
  }

  private place(item: number): void {
    this.placing = item;
    this.drawSide();
    this.context.say(t('dashboard.place-hint'));
  }

  private drawDashboard(): void {
    const { dashboard } = this.draft, { grid = {} } = dashboard;
    const rows: readonly PropertyRow[] = [{ name: 'name', type: 'name', required: true }, { ...titleRow, required: true }, parameterRow];
    const gridRows: readonly PropertyRow[] = [{ name: 'columns', type: 'integer', min: 1, max: 24 }, { name: 'row_px', type: 'integer', min: 24, max: 160 }];
    render(html`<h2>${t('dashboard.title')}</h2>
      ${fields(rows, dashboard as unknown as Record<string, unknown>, (next) => {
        const { parameters, ...rest } = next as unknown as Dashboard;
        this.draft.dashboard = { ...this.draft.dashboard };
        if (!parameters) delete this.draft.dashboard.parameters;
        this.change(parameters ? { ...rest, parameters } : rest);
      })}
      ${fields(gridRows, grid as Record<string, unknown>, (next) => this.change({ grid: next }))}
      ${this.draft.base > 1 ? html`<label class="field"><span>${t('dashboard.earlier')}</span><select @change=${this.takeVersion}><option value=""></option>${
        Array.from({ length: Math.min(this.draft.base, mostVersions) - 1 }, (_, n) => html`<option>${this.draft.base - 1 - n}</option>`)}</select></label>` : nothing}`, this.side);
  }

  // An earlier version becomes the draft; nothing is saved.
  private readonly takeVersion = async (event: Event): Promise<void> => {
    const choice = event.target as HTMLSelectElement, version = choice.value;
    choice.value = '';
    if (!version) return;
    try {
      const { text } = await request<{ text: string }>(query('/api/dashboard', { name: this.draft.name, version }));
      this.change(JSON.parse(text) as Dashboard);
    } catch (error) {
      this.context.say(errorText(error), true);
    }
  };

  // Proposes the channels that contain the typed text.
  private propose(event: Event): void {
    const field = event.target as HTMLInputElement;
    if (field.getAttribute('list') !== this.names.id) return;
    const typed = field.value.toLowerCase(), found: string[] = [];
    for (const path of this.context.plant.ids.keys()) {
      if (path.toLowerCase().includes(typed)) found.push(path);
      if (found.length === mostNames) break;
    }
    render(found.length ? html`${found.map((path) => html`<option value=${path}></option>`)}` : nothing, this.names);
  }
}
