// The grid of a dashboard. Keeps the widgets that have not changed, so that editing one does not restart the others.

import type { Change, Context } from '../context';
import type { Topic } from '../plant';
import { widgets } from './widgets';
import { columnsOf, filled, rowOf } from './document';
import type { Dashboard, Values, Widget } from './document';
import { byPlace } from './grid';
import type { Cells } from './grid';
import type { Picture, WidgetView } from './widget';

export const gap_px = 8;

interface Item {
  key: string;
  cell: HTMLElement;
  view: WidgetView | undefined;  // undefined: the widget is not complete
  fresh: boolean;
}

const everything: ReadonlySet<Topic> = new Set<Topic>(['catalogue', 'alarms', 'connection']);

export class Board {
  readonly element = document.createElement('div');
  private items: Item[] = [];

  // `dress` adds the handle of the editor to the cell of a widget.
  constructor(private readonly context: Context, private readonly pictures: ReadonlyMap<string, Picture>,
    private readonly dress: (cell: HTMLElement, index: number) => void = () => {}) {
    this.element.className = 'board';
  }

  show(dashboard: Dashboard, values: Values): void {
    this.element.style.setProperty('--columns', String(columnsOf(dashboard)));
    this.element.style.setProperty('--row-px', `${rowOf(dashboard)}px`);
    const before = this.items, unused = new Set(before);
    this.items = dashboard.widgets.map((widget, index) => {
      const height_px = widget.at[3] * (rowOf(dashboard) + gap_px) - gap_px;
      const { at, ...rest } = widget;
      const key = `${height_px} ${JSON.stringify(filled(rest, values))}`;
      const kept = before.find((item) => item.key === key && unused.has(item));
      if (kept) unused.delete(kept);
      // A widget that changed keeps its cell, so that its handle keeps the focus.
      const same = before[index];
      const item = kept ?? this.make(filled(widget, values), key, height_px, same && unused.delete(same) ? same : undefined);
      this.place(item.cell, at);
      this.dress(item.cell, index);
      return item;
    });
    for (const item of unused) item.view?.close();
    const order = dashboard.widgets.map((_, index) => index).sort((a, b) => byPlace(dashboard.widgets[a]!.at, dashboard.widgets[b]!.at));
    const cells = order.map((index) => this.items[index]!.cell);
    if (cells.length === this.element.childElementCount && cells.every((cell, index) => this.element.children[index] === cell)) return;
    const focused = document.activeElement as HTMLElement | null;
    this.element.replaceChildren(...cells);  // takes the focus away
    if (focused && focused !== document.activeElement && this.element.contains(focused)) focused.focus({ preventScroll: true });
  }

  // Shows other places for a moment, while a widget is dragged.
  preview(places: readonly Cells[]): void {
    places.forEach((at, index) => this.place(this.items[index]!.cell, at));
  }

  cell(index: number): HTMLElement | undefined { return this.items[index]?.cell; }

  paint(change: Change): void {
    for (const item of this.items) {
      if (!item.view) continue;
      try {
        item.view.paint(item.fresh ? { values: true, second: true, topics: everything } : change);
        item.fresh = false;
      } catch {
        this.breakOff(item);
      }
    }
  }

  close(): void {
    for (const { view } of this.items) view?.close();
    this.items = [];
  }

  private make(widget: Widget, key: string, height_px: number, before?: Item): Item {
    const cell = before?.cell ?? document.createElement('div');
    cell.className = 'cell';
    before?.view?.close();
    cell.querySelector('.widget')?.remove();
    const item: Item = { key, cell, view: undefined, fresh: true };
    try {
      const Kind = Object.hasOwn(widgets, widget.kind) ? widgets[widget.kind] : undefined;
      item.view = Kind && new Kind({ context: this.context, height_px, pictures: this.pictures }, widget);
    } catch {
      // A draft may lack properties; the editor shows the faults that the station reports.
    }
    if (item.view) cell.prepend(item.view.element);
    else this.breakOff(item);
    return item;
  }

  private breakOff(item: Item): void {
    item.view?.close();
    item.view = undefined;
    const note = document.createElement('div');
    note.className = 'widget incomplete';
    note.textContent = '…';
    item.cell.querySelector('.widget')?.remove();
    item.cell.prepend(note);
  }

  private place(cell: HTMLElement, [column, row, width, height]: Cells): void {
    cell.style.gridColumn = `${column + 1} / span ${width}`;
    cell.style.gridRow = `${row + 1} / span ${height}`;
    cell.style.setProperty('--rows', String(height));
  }
}
