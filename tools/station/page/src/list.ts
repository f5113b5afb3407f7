// A virtual table of objects: each column returns the text of an object. Keeps the selected object when the order changes.

import { printable, setText } from './printable';
import { VirtualTable } from './table';
import type { Row } from './table';

const longText = 14;  // characters; a longer text may be cut off and is shown in the title too

export interface ListColumn<T> {
  key: string;
  label: string;
  text(item: T): string;
  link?(item: T): string;  // address of the link on the text; empty: no link
  hint?(item: T): string;  // tooltip; for a link its text, which may be cut off
  order?(item: T): string | number;  // sort key; without it the column cannot be sorted
  checked?(item: T): boolean;  // a checkbox instead of the text; the text is its name
  toggle?(item: T): void;
}

export interface ListOwner<T> {
  label: string;
  className: string;
  columns: ListColumn<T>[];
  keyOf(item: T): string;
  tone?(item: T): string;  // classes of the row
  open?(item: T): void;
  choose?(item: T): void;  // called when a different object is selected
}

export class ListTable<T> {
  readonly table: VirtualTable;
  items: readonly T[] = [];
  private all: readonly T[] = [];
  private selectedKey: string | undefined;
  private sortKey = '';
  private descending = false;

  constructor(private readonly owner: ListOwner<T>) {
    this.table = new VirtualTable({
      columns: owner.columns.map(({ key, label, order }) => ({ key, label, sortable: order !== undefined })),
      label: owner.label,
      paintRow: (row) => this.paintRow(row),
      open: (index) => this.open(index),
      sort: (key) => this.sort(key),
    });
    this.table.element.classList.add(owner.className);
  }

  get element(): HTMLElement { return this.table.element; }
  get selected(): T | undefined { return this.items[this.table.selected]; }
  get sorted(): boolean { return this.sortKey !== ''; }

  // Uses the owner's order until the user sorts by a column. `same`: the same objects in the same order with other contents.
  set(items: readonly T[], same = false): void {
    this.noteSelected();
    this.all = items;
    this.items = this.ordered();
    if (same) return;
    this.table.selected = this.selectedKey === undefined ? -1 : this.items.findIndex((item) => this.owner.keyOf(item) === this.selectedKey);
    this.table.setCount(this.items.length);
  }

  select(key: string): void {
    this.selectedKey = key;
    const index = this.items.findIndex((item) => this.owner.keyOf(item) === key);
    if (index >= 0 && index !== this.table.selected) this.table.select(index);
  }

  paint(): void {
    this.noteSelected();
    this.table.paint();
  }

  // Returns true if it handled the key: the first arrow key moves the focus to the table.
  key(event: KeyboardEvent): boolean {
    if (event.key !== 'ArrowDown' || document.activeElement === this.element || !this.items.length) return false;
    this.element.focus();
    this.table.select(Math.max(0, this.table.selected));
    return true;
  }

  private noteSelected(): void {
    const item = this.selected;
    if (item) this.selectedKey = this.owner.keyOf(item);
  }

  private ordered(): readonly T[] {
    const order = this.owner.columns.find((column) => column.key === this.sortKey)?.order;
    if (!order) return this.all;
    const sign = this.descending ? -1 : 1;
    return this.all.map((item) => ({ item, by: order(item) }))
      .sort((a, b) => sign * (typeof a.by === 'number' && typeof b.by === 'number' ? a.by - b.by : String(a.by).localeCompare(String(b.by))))
      .map(({ item }) => item);
  }

  private sort(key: string): void {
    this.descending = this.sortKey === key ? !this.descending : false;
    this.sortKey = key;
    this.table.setSort(key, this.descending);
    this.set(this.all);
  }

  private open(index: number): void {
    const item = this.items[index];
    if (!item) return;
    this.selectedKey = this.owner.keyOf(item);
    this.owner.choose?.(item);
    this.owner.open?.(item);
  }

  private paintRow(row: Row): void {
    const item = this.items[row.index];
    if (item === undefined) return;
    const name = `vrow ${this.owner.tone?.(item) ?? ''}${row.element.classList.contains('selected') ? ' selected' : ''}`;
    if (row.element.className !== name) row.element.className = name;
    this.owner.columns.forEach((column, index) => this.paintCell(row.cells[index]!, column, item));
  }

  private paintCell(cell: HTMLElement, column: ListColumn<T>, item: T): void {
    const text = column.text(item), hint = printable(column.hint?.(item) ?? (column.link || text.length > longText ? text : ''));
    if (cell.title !== hint) cell.title = hint;
    if (column.checked) return this.paintBox(cell, column, item);
    const address = column.link?.(item) ?? '';
    let anchor = cell.firstElementChild as HTMLAnchorElement | null;
    if (!address) {
      anchor?.remove();
      return setText(cell, text);
    }
    if (!anchor) {
      anchor = document.createElement('a');
      anchor.tabIndex = -1;
      cell.replaceChildren(anchor);
    }
    if (anchor.getAttribute('href') !== address) anchor.setAttribute('href', address);
    setText(anchor, text);
  }

  private paintBox(cell: HTMLElement, column: ListColumn<T>, item: T): void {
    let box = cell.firstElementChild as HTMLInputElement | null;
    if (!box) {
      box = document.createElement('input');
      box.type = 'checkbox';
      box.tabIndex = -1;  // the space key toggles it for the row
      cell.replaceChildren(box);
    }
    box.onchange = () => column.toggle?.(item);
    box.checked = column.checked!(item);
    const label = column.text(item);
    if (box.ariaLabel !== label) box.ariaLabel = label;
  }
}
