// The handle that covers a widget in the editor: moves it by pointer and arrow keys, resizes it by its corner and Shift with
// arrow keys.

import type { Cells } from './grid';

export interface HandleOwner {
  label(index: number): string;
  at(index: number): Cells;
  step(): { x: number; y: number };  // pixels of one cell
  select(index: number): void;
  click(index: number, event: MouseEvent): void;
  preview(index: number, at: Cells): void;
  move(index: number, at: Cells): void;
  remove(index: number): void;
}

const arrows: Record<string, readonly [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Handle {
  readonly element = document.createElement('button');
  private readonly corner = document.createElement('span');
  private from: { x: number; y: number; at: Cells; resizes: boolean } | undefined;
  private target: Cells | undefined;

  constructor(private readonly owner: HandleOwner, public index: number) {
    const { element, corner } = this;
    element.type = 'button';
    element.className = 'handle';
    corner.className = 'corner';
    corner.setAttribute('aria-hidden', 'true');
    element.append(corner);
    element.addEventListener('pointerdown', (event) => this.begin(event));
    element.addEventListener('pointermove', (event) => this.drag(event));
    element.addEventListener('pointerup', () => this.drop());
    element.addEventListener('pointercancel', () => { this.from = this.target = undefined; });
    element.addEventListener('click', (event) => owner.click(this.index, event));
    element.addEventListener('focus', () => owner.select(this.index));
    element.addEventListener('keydown', (event) => this.key(event));
  }

  relabel(selected: boolean): void {
    this.element.setAttribute('aria-label', this.owner.label(this.index));
    this.element.setAttribute('aria-pressed', String(selected));
  }

  private moved(dx: number, dy: number, [column, row, width, height]: Cells, resizes: boolean): Cells {
    return resizes ? [column, row, width + dx, height + dy] : [column + dx, row + dy, width, height];
  }

  private begin(event: PointerEvent): void {
    if (event.button !== 0) return;
    this.element.setPointerCapture(event.pointerId);
    this.from = { x: event.clientX, y: event.clientY, at: this.owner.at(this.index), resizes: event.target === this.corner };
  }

  private drag(event: PointerEvent): void {
    if (!this.from) return;
    const step = this.owner.step();
    const dx = Math.round((event.clientX - this.from.x) / step.x), dy = Math.round((event.clientY - this.from.y) / step.y);
    if (!dx && !dy && !this.target) return;
    this.target = this.moved(dx, dy, this.from.at, this.from.resizes);
    this.owner.preview(this.index, this.target);
  }

  private drop(): void {
    const target = this.target;
    this.from = this.target = undefined;
    if (target) this.owner.move(this.index, target);
  }

  private key(event: KeyboardEvent): void {
    const arrow = arrows[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (arrow) this.owner.move(this.index, this.moved(arrow[0], arrow[1], this.owner.at(this.index), event.shiftKey));
    else if (event.key === 'Delete') this.owner.remove(this.index);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
