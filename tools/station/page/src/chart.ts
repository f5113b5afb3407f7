// Draws a trend on a canvas: average as a line, min to max as a band, limits as bands, bad times in red, gaps without a line. Dragging
// requests a zoom. Colours are from the style sheet, for light and dark. Each call draws immediately.

import { exactValue } from './format';
import { t } from './i18n';
import { numberTicks, timeTicks } from './ticks';

export interface Span {
  from_ms: number;
  to_ms: number;
}

export interface Line {
  label: string;
  unit: string;
  stepped: boolean;
  t: number[];  // Unix ms, ascending
  average: (number | null)[];  // null: a gap
  min: (number | null)[];
  max: (number | null)[];
  bad: Span[];
}

// Something that happened, as a mark on the time axis.
export interface Mark {
  at_ms: number;
  text: string;
}

export interface ChartOptions {
  label: string;
  height: number;
  limits?: Record<string, number>;
  onZoom?: (from_ms: number, to_ms: number) => void;
  onCursor?: (at_ms: number | undefined, values: (number | null | undefined)[]) => void;
}

interface Scale {
  unit: string;
  min: number;
  max: number;
  lines: number[];  // numbers of its lines, from 1
  empty: boolean;  // no value in the window: nothing to show on the axis
}

const colourNames = ['--s1', '--s2', '--s3', '--s4', '--s5', '--s6', '--s7', '--s8'];
// A dash for each line: colours alone do not distinguish lines for every eye, nor in print.
export const dashes: readonly (readonly number[])[] = [[], [8, 4], [2, 3], [10, 3, 2, 3], [16, 5], [5, 5], [12, 3, 2, 3, 2, 3], [1, 4]];
export const dashOf = (index: number): readonly number[] => dashes[index % dashes.length]!;
const colourOf = (index: number): string => colourNames[index % colourNames.length]!;
const side = 60;  // width of the labels of a value axis
const axisEach = 250;  // width of the trend for each further axis
const foot = 24;
const head = 20;
const strip = 5;
const leastDrag = 6;
const font = '12px system-ui, sans-serif';

// Returns the index of the last time not after `at`; -1 if there is none.
export function indexAt(t: readonly number[], at: number): number {
  let low = 0, high = t.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (t[middle]! <= at) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export class Chart {
  readonly element = document.createElement('div');
  private readonly data = document.createElement('canvas');
  private readonly overlay = document.createElement('canvas');
  private readonly probe = document.createElement('span');
  private readonly colours = new Map<string, string>();
  private lines: Line[] = [];
  private past: readonly Line[] = [];  // each line one day before, in the same order
  private marks: readonly Mark[] = [];
  private scales: Scale[] = [];
  private from_ms = 0;
  private to_ms = 1;
  private width = 0;
  private pointer: number | undefined;  // x in CSS pixels
  private dragFrom: number | undefined;
  private readonly scheme = matchMedia('(prefers-color-scheme: dark)');
  private readonly resized = new ResizeObserver(() => this.resize());
  private readonly recolour = (): void => {
    this.colours.clear();
    this.draw();
  };

  constructor(private readonly options: ChartOptions) {
    const { element } = this;
    element.className = 'chart';
    element.style.height = `${options.height}px`;
    element.setAttribute('role', 'img');
    element.setAttribute('aria-label', options.label);
    this.probe.hidden = true;
    element.append(this.data, this.overlay, this.probe);
    this.resized.observe(element);
    this.scheme.addEventListener('change', this.recolour);
    addEventListener('fieldcast-theme', this.recolour);
    this.overlay.addEventListener('pointermove', (event) => this.move(event.offsetX));
    this.overlay.addEventListener('pointerleave', () => this.move(undefined));
    this.overlay.addEventListener('pointerdown', (event) => {
      this.dragFrom = event.offsetX;
      this.overlay.setPointerCapture(event.pointerId);
    });
    this.overlay.addEventListener('pointerup', (event) => this.drop(event.offsetX));
    this.overlay.addEventListener('pointercancel', () => { this.dragFrom = undefined; });
  }

  set(lines: Line[], from_ms: number, to_ms: number, past: readonly Line[] = [], marks: readonly Mark[] = []): void {
    Object.assign(this, { lines, past, marks });
    this.from_ms = from_ms;
    this.to_ms = Math.max(to_ms, from_ms + 1);
    this.draw();
  }

  close(): void {
    this.resized.disconnect();
    this.scheme.removeEventListener('change', this.recolour);
    removeEventListener('fieldcast-theme', this.recolour);
  }

  private get left(): number { return side; }
  // Axes that fit: one on the left, the others on the right.
  private get axes(): number { return Math.min(this.scales.length, Math.max(2, Math.floor(this.width / axisEach))); }
  private get right(): number { return this.width - Math.max(12, (this.axes - 1) * side); }
  private get bottom(): number { return this.options.height - foot; }
  private x(at_ms: number): number { return this.left + ((at_ms - this.from_ms) / (this.to_ms - this.from_ms)) * (this.right - this.left); }
  private y(value: number, scale: Scale): number { return this.bottom - ((value - scale.min) / (scale.max - scale.min)) * (this.bottom - head); }
  private timeAt(x: number): number {
    const share = Math.max(0, Math.min(1, (x - this.left) / Math.max(1, this.right - this.left)));
    return this.from_ms + share * (this.to_ms - this.from_ms);
  }

  // Resolves a variable of the style sheet to a canvas colour.
  private colour(name: string, share = 1): string {
    let found = this.colours.get(name);
    if (!found) {
      this.probe.style.color = `var(${name})`;
      this.colours.set(name, (found = getComputedStyle(this.probe).color));
    }
    return share === 1 ? found : found.replace(/^rgb\((.+)\)$/, `rgba($1, ${share})`);
  }

  private resize(): void {
    if (this.element.clientWidth === this.width) return;
    this.width = this.element.clientWidth;
    this.draw();
  }

  // Returns the context of a cleared canvas of the right size, in CSS pixels.
  private begin(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
    const ratio = devicePixelRatio;
    const width = Math.round(this.width * ratio), height = Math.round(this.options.height * ratio);
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    const ctx = canvas.getContext('2d')!;
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, this.width, this.options.height);
    ctx.font = font;
    return ctx;
  }

  private draw(): void {
    if (!this.width) return;
    this.scales = this.makeScales();
    const ctx = this.begin(this.data);
    this.drawAxes(ctx);
    ctx.save();
    ctx.beginPath();
    ctx.rect(this.left, head - 1, this.right - this.left, this.bottom - head + 2);
    ctx.clip();
    this.drawLimits(ctx);
    this.lines.forEach((line, index) => this.drawBad(ctx, line, index));
    this.lines.forEach((line, index) => this.drawBand(ctx, line, index));
    this.past.forEach((line, index) => this.drawLine(ctx, line, index, true));
    this.lines.forEach((line, index) => this.drawLine(ctx, line, index));
    ctx.restore();
    this.drawMarks(ctx);
    this.drawOverlay();
  }

  private drawMarks(ctx: CanvasRenderingContext2D): void {
    ctx.fillStyle = this.colour('--text');
    for (const x of this.marks.map(({ at_ms }) => this.x(at_ms))) {
      ctx.beginPath();
      ctx.moveTo(x, this.bottom - 2);
      ctx.lineTo(x - 5, this.bottom + 7);
      ctx.lineTo(x + 5, this.bottom + 7);
      ctx.fill();
    }
  }

  // Range of the visible points, and one more on each side.
  private seen(line: Line): [number, number] {
    return [Math.max(0, indexAt(line.t, this.from_ms)), Math.min(line.t.length, indexAt(line.t, this.to_ms) + 2)];
  }

  private makeScales(): Scale[] {
    const scales: Scale[] = [];
    for (const [index, line] of [...this.lines, ...this.past].entries()) {
      let scale = scales.find((each) => each.unit === line.unit);
      if (!scale) scales.push((scale = { unit: line.unit, min: Infinity, max: -Infinity, lines: [], empty: false }));
      if (index < this.lines.length) scale.lines.push(index + 1);
      const [first, end] = this.seen(line);
      for (let i = first; i < end; i++) {
        const low = line.min[i], high = line.max[i];
        if (low !== null && low !== undefined && low < scale.min) scale.min = low;
        if (high !== null && high !== undefined && high > scale.max) scale.max = high;
      }
    }
    scales.forEach((scale, index) => this.widen(scale, index === 0));
    return scales;
  }

  // Range of values with a margin; includes limits that are near.
  private widen(scale: Scale, limited: boolean): void {
    scale.empty = !Number.isFinite(scale.min);
    if (scale.empty) Object.assign(scale, { min: 0, max: 1 });
    const size = scale.max - scale.min || Math.abs(scale.max) * 0.1 || 1;
    if (limited) {
      const { min, max } = scale;
      for (const [, value] of this.limits()) {
        if (value > max && value - max < size) scale.max = Math.max(scale.max, value);
        if (value < min && min - value < size) scale.min = Math.min(scale.min, value);
      }
    }
    const margin = (scale.max - scale.min || size) * 0.08;
    scale.min -= margin;
    scale.max += margin;
  }

  private limits(): [string, number][] {
    return Object.entries(this.options.limits ?? {}).filter(([name]) => !name.startsWith('write'));
  }

  private drawAxes(ctx: CanvasRenderingContext2D): void {
    const { left, right, bottom } = this;
    ctx.fillStyle = this.colour('--muted');
    ctx.strokeStyle = this.colour('--grid');
    ctx.lineWidth = 1;
    ctx.beginPath();
    ctx.textBaseline = 'top';
    for (const tick of timeTicks(this.from_ms, this.to_ms, (right - left) / 90)) {
      const x = Math.round(this.x(tick.at)) + 0.5;
      ctx.moveTo(x, head);
      ctx.lineTo(x, bottom);
      const half = ctx.measureText(tick.text).width / 2;
      ctx.textAlign = 'center';
      ctx.fillText(tick.text, Math.max(half, Math.min(this.width - half, x)), bottom + 7);
    }
    this.scales.slice(0, this.axes).forEach((scale, index) => this.drawAxis(ctx, scale, index));
    ctx.stroke();
    if (this.scales.length && this.scales.every((scale) => scale.empty)) {
      ctx.textAlign = 'center';
      ctx.textBaseline = 'middle';
      ctx.fillText(t('chart.no-data'), (left + right) / 2, (head + bottom) / 2);
    }
  }

  // An axis has the colour of its line, or the numbers of its lines if there are several. Without a value it has no labels.
  private drawAxis(ctx: CanvasRenderingContext2D, scale: Scale, index: number): void {
    const { left, right, bottom } = this;
    const textAt = index ? right + 6 + (index - 1) * side : left - 6;
    const own = this.lines.length > 1 && scale.lines.length === 1;
    ctx.fillStyle = this.colour(own ? colourOf(scale.lines[0]! - 1) : '--muted');
    ctx.textAlign = index ? 'left' : 'right';
    ctx.textBaseline = 'middle';
    for (const tick of scale.empty ? [] : numberTicks(scale.min, scale.max, (bottom - head) / 45)) {
      const y = Math.round(this.y(tick.at, scale)) + 0.5;
      if (!index) {
        ctx.moveTo(left, y);
        ctx.lineTo(right, y);
      }
      ctx.fillText(tick.text, textAt, y);
    }
    ctx.textBaseline = 'top';
    ctx.fillText(this.lines.length > 1 ? `${scale.lines.join(' ')}: ${scale.unit || '1'}` : scale.unit, textAt, 2, side - 8);
    ctx.fillStyle = this.colour('--muted');
  }

  private drawLimits(ctx: CanvasRenderingContext2D): void {
    const scale = this.scales[0];
    if (!scale || scale.empty) return;
    for (const [name, value] of this.limits()) {
      const high = name.startsWith('high');
      const y = Math.max(head, Math.min(this.bottom, this.y(value, scale)));
      const colour = name.includes('-') ? '--bad' : '--warning';
      ctx.fillStyle = this.colour(colour, 0.12);
      ctx.fillRect(this.left, high ? head : y, this.right - this.left, high ? y - head : this.bottom - y);
      if (value < scale.min || value > scale.max) continue;
      ctx.fillStyle = this.colour(colour);
      ctx.fillRect(this.left, Math.round(y), this.right - this.left, 1);
      ctx.textAlign = 'right';
      ctx.textBaseline = high ? 'bottom' : 'top';
      ctx.fillText(`${name} ${exactValue(value, 'float32')}`, this.right - 4, high ? y - 2 : y + 4);
    }
  }

  // Bad times of one line fill the whole height; with several lines, each has a strip at the bottom.
  private drawBad(ctx: CanvasRenderingContext2D, line: Line, index: number): void {
    const alone = this.lines.length === 1;
    const top = this.bottom - strip * (this.lines.length - index);
    for (const span of line.bad) {
      if (span.to_ms < this.from_ms || span.from_ms > this.to_ms) continue;
      const left = this.x(span.from_ms), width = Math.max(2, this.x(span.to_ms) - left);
      if (alone) {
        ctx.fillStyle = this.colour('--bad', 0.18);
        ctx.fillRect(left, head, width, this.bottom - head);
      }
      ctx.fillStyle = this.colour(alone ? '--bad' : colourOf(index));
      ctx.fillRect(left, top, width, strip - 1);
    }
  }

  private drawBand(ctx: CanvasRenderingContext2D, line: Line, index: number): void {
    const scale = this.scales.find((each) => each.unit === line.unit)!;
    const [first, end] = this.seen(line);
    ctx.fillStyle = this.colour(colourNames[index % colourNames.length]!, 0.22);
    for (let i = first; i < end; i++) {
      const from = i;
      while (i < end && line.max[i] !== null) i++;
      if (i - from < 2) continue;
      ctx.beginPath();
      for (let k = from; k < i; k++) ctx.lineTo(this.x(line.t[k]!), this.y(line.max[k]!, scale));
      for (let k = i - 1; k >= from; k--) ctx.lineTo(this.x(line.t[k]!), this.y(line.min[k]!, scale));
      ctx.fill();
    }
  }

  private drawLine(ctx: CanvasRenderingContext2D, line: Line, index: number, past = false): void {
    const scale = this.scales.find((each) => each.unit === line.unit)!;
    const [first, end] = this.seen(line);
    ctx.strokeStyle = ctx.fillStyle = this.colour(colourOf(index));
    ctx.lineWidth = past ? 1 : 1.6;
    ctx.lineJoin = 'round';
    ctx.setLineDash(past ? [3, 3] : [...dashOf(index)]);
    ctx.beginPath();
    let y = NaN;  // of the previous point; NaN after a gap
    for (let i = first; i < end; i++) {
      const value = line.average[i];
      if (value === null || value === undefined) {
        y = NaN;
        continue;
      }
      const x = this.x(line.t[i]!), next = this.y(value, scale);
      if (Number.isNaN(y)) {
        ctx.moveTo(x, next);
        const after = line.average[i + 1];
        if (after === null || after === undefined) ctx.fillRect(x - 1.5, next - 1.5, 3, 3);
      } else if (line.stepped) {
        ctx.lineTo(x, y);
      }
      ctx.lineTo(x, next);
      y = next;
    }
    ctx.stroke();
    ctx.setLineDash([]);
    if (this.lines.length > 1 && !past) this.drawNumber(ctx, line, index, scale);
  }

  // Writes the number of a line at its last visible point.
  private drawNumber(ctx: CanvasRenderingContext2D, line: Line, index: number, scale: Scale): void {
    let last = indexAt(line.t, this.to_ms);
    while (last >= 0 && line.average[last] === null) last--;
    if (last < 0 || line.t[last]! < this.from_ms) return;
    ctx.textAlign = 'right';
    ctx.textBaseline = 'bottom';
    ctx.fillText(String(index + 1), Math.min(this.right - 2, this.x(line.t[last]!) - 2), Math.max(head + 12, this.y(line.average[last]!, scale) - 2));
  }

  private move(x: number | undefined): void {
    this.pointer = x === undefined && this.dragFrom !== undefined ? this.pointer : x;
    this.drawOverlay();
  }

  private drop(x: number): void {
    const from = this.dragFrom;
    this.dragFrom = undefined;
    this.drawOverlay();
    if (from !== undefined && Math.abs(x - from) >= leastDrag) this.options.onZoom?.(this.timeAt(Math.min(x, from)), this.timeAt(Math.max(x, from)));
  }

  // Draws the cursor with its values, and the current selection.
  private drawOverlay(): void {
    if (!this.width) return;
    const ctx = this.begin(this.overlay);
    if (this.pointer === undefined || !this.lines.length) {
      this.options.onCursor?.(undefined, []);
      return;
    }
    const pointer = Math.max(this.left, Math.min(this.right, this.pointer));
    if (this.dragFrom !== undefined) {
      const from = Math.max(this.left, Math.min(this.right, this.dragFrom));
      ctx.fillStyle = this.colour('--accent', 0.18);
      ctx.fillRect(Math.min(from, pointer), head, Math.abs(pointer - from), this.bottom - head);
    }
    const at_ms = this.timeAt(pointer);
    ctx.fillStyle = this.colour('--muted');
    ctx.fillRect(Math.round(pointer), head, 1, this.bottom - head);
    const near = this.marks.filter((mark) => Math.abs(this.x(mark.at_ms) - pointer) < 7);
    this.overlay.title = near.map(({ text }) => text).join('\n');
    const values = [...this.lines, ...this.past].map((line, index) => {
      const i = indexAt(line.t, at_ms), value = line.average[i];
      if (value === null || value === undefined) return value;
      ctx.fillStyle = this.colour(colourOf(index % this.lines.length));
      ctx.beginPath();
      ctx.arc(this.x(line.t[i]!), this.y(value, this.scales.find((each) => each.unit === line.unit)!), 3.5, 0, 7);
      ctx.fill();
      return value;
    });
    this.options.onCursor?.(at_ms, values);
  }
}
