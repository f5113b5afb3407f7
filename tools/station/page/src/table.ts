// A table of any length that has elements only for visible rows. All rows have one height; scrolling reuses a pool of row
// elements. The owner paints the rows. Arrows, Page keys, Home, End and Enter work while the table has the focus.

export interface Column {
  key: string;
  label: string;
  sortable?: boolean;
}

export interface Row {
  element: HTMLElement;
  cells: HTMLElement[];
  index: number;  // index of the shown item; -1: none
  mark: number;  // for the owner: what was painted last
}

export interface TableOwner {
  columns: Column[];
  label: string;
  paintRow(row: Row, fresh: boolean): void;  // fresh: the row shows a different index than before
  open?(index: number): void;  // Enter or a click
  sort?(key: string): void;
}

const above = 4;  // rows kept ready outside the window

export class VirtualTable {
  readonly element = document.createElement('div');
  selected = -1;
  private readonly body = document.createElement('div');
  private readonly rows: Row[] = [];
  private readonly heads: HTMLElement[] = [];
  private count = 0;
  private first = -1;
  private rowHeight = 28;
  private viewHeight = 0;

  constructor(private readonly owner: TableOwner) {
    const { element, body } = this;
    element.className = 'vtable';
    element.tabIndex = 0;
    element.setAttribute('role', 'grid');
    element.setAttribute('aria-label', owner.label);
    element.dataset['scroll'] = '';
    const head = this.part('rowgroup', 'vhead');
    const line = this.part('row', 'vrow');
    owner.columns.forEach((column) => line.append(this.makeHead(column)));
    head.append(line);
    body.className = 'vbody';
    body.setAttribute('role', 'rowgroup');
    element.append(head, body);
    element.addEventListener('scroll', () => this.place(), { passive: true });
    element.addEventListener('keydown', (event) => this.onKey(event));
    body.addEventListener('click', (event) => this.onClick(event));
    new ResizeObserver(() => this.measure()).observe(element);
  }

  setCount(count: number): void {
    this.count = count;
    this.element.setAttribute('aria-rowcount', String(count + 1));
    this.body.style.height = `${count * this.rowHeight}px`;
    if (this.selected >= count) this.selected = count - 1;
    this.first = -1;
    this.place();
  }

  setSort(key: string, descending: boolean): void {
    this.owner.columns.forEach((column, index) => {
      const head = this.heads[index]!;
      if (column.key === key) head.setAttribute('aria-sort', descending ? 'descending' : 'ascending');
      else head.removeAttribute('aria-sort');
    });
  }

  // Paints only rows with an item; the owner skips unchanged contents.
  paint(): void {
    for (const row of this.rows) if (row.index >= 0) this.owner.paintRow(row, false);
  }

  select(index: number): void {
    const next = Math.max(0, Math.min(this.count - 1, index));
    this.selected = this.count ? next : -1;
    const top = next * this.rowHeight;
    const head = this.rowHeight;
    if (top < this.element.scrollTop) this.element.scrollTop = top;
    else if (top + head + this.rowHeight > this.element.scrollTop + this.viewHeight)
      this.element.scrollTop = top + head + this.rowHeight - this.viewHeight;
    this.place();
    for (const row of this.rows) this.markSelected(row);
  }

  private part(role: string, className: string): HTMLElement {
    const part = document.createElement('div');
    part.setAttribute('role', role);
    part.className = className;
    return part;
  }

  private makeHead(column: Column): HTMLElement {
    const cell = this.part('columnheader', `c-${column.key}`);
    if (column.sortable) {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = column.label;
      button.addEventListener('click', () => this.owner.sort?.(column.key));
      cell.append(button);
    } else {
      cell.textContent = column.label;
    }
    this.heads.push(cell);
    return cell;
  }

  private makeRow(): Row {
    const element = this.part('row', 'vrow');
    const cells = this.owner.columns.map((column) => this.part('gridcell', `c-${column.key}`));
    element.append(...cells);
    element.id = `r${Math.random().toString(36).slice(2, 8)}-${this.rows.length}`;
    this.body.append(element);
    return { element, cells, index: -1, mark: -1 };
  }

  private measure(): void {
    this.rowHeight = parseFloat(getComputedStyle(this.element).getPropertyValue('--row')) || 28;
    this.viewHeight = this.element.clientHeight;
    const wanted = Math.ceil(this.viewHeight / this.rowHeight) + 2 * above;
    while (this.rows.length < wanted) this.rows.push(this.makeRow());
    for (const row of this.rows.splice(wanted)) row.element.remove();
    for (const row of this.rows) row.index = -1;
    this.setCount(this.count);
  }

  // Row k of the pool shows an index equal to k modulo the pool size, so scrolling by one row changes one element.
  private place(): void {
    const size = this.rows.length;
    if (!size) return;
    const first = Math.max(0, Math.floor(this.element.scrollTop / this.rowHeight) - above);
    if (first === this.first) return;
    const all = this.first < 0;
    this.first = first;
    for (let k = 0; k < size; k++) {
      const row = this.rows[k]!;
      const index = first + ((((k - first) % size) + size) % size);
      const shown = index < this.count ? index : -1;
      if (shown === row.index && !all) continue;
      row.index = shown;
      row.element.hidden = shown < 0;
      if (shown < 0) continue;
      row.element.style.transform = `translateY(${index * this.rowHeight}px)`;
      row.element.setAttribute('aria-rowindex', String(index + 2));
      this.markSelected(row);
      this.owner.paintRow(row, true);
    }
  }

  private markSelected(row: Row): void {
    const selected = row.index >= 0 && row.index === this.selected;
    row.element.classList.toggle('selected', selected);
    if (selected) {
      row.element.setAttribute('aria-selected', 'true');
      this.element.setAttribute('aria-activedescendant', row.element.id);
    } else {
      row.element.removeAttribute('aria-selected');
    }
  }

  private onKey(event: KeyboardEvent): void {
    if (event.target !== this.element || event.ctrlKey || event.altKey || event.metaKey) return;
    const page = Math.max(1, Math.floor(this.viewHeight / this.rowHeight) - 2);
    const steps: Record<string, number> = {
      ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -this.count, End: this.count };
    const step = steps[event.key];
    if (step !== undefined) this.select(this.selected + step);
    else if (event.key === 'Enter' && this.selected >= 0) this.owner.open?.(this.selected);
    else return;
    event.preventDefault();
  }

  private onClick(event: MouseEvent): void {
    const target = event.target as Element;
    if (target.closest('a, button, input')) return;
    const element = target.closest('.vrow');
    const row = this.rows.find((each) => each.element === element);
    if (!row || row.index < 0) return;
    this.select(row.index);
    this.owner.open?.(row.index);
  }
}
