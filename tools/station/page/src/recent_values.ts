// The last minutes of every channel for the trends of the live table: one column of values every 5 s. Kept in memory alone. Pure.

import { isBad } from './types';

const every_ms = 5000;
const most = 48;  // columns: four minutes
const mostBytes = 16e6;  // then fewer columns

export class RecentValues {
  taken = 0;  // grows with each column
  private columns: Float64Array[] = [];  // by id, the oldest first
  private taken_ms = -every_ms;

  clear(): void { this.columns = []; }

  // Keeps a copy of the values, if it is time, with gaps where the quality is bad. `now_ms`: monotonic.
  take(values: Float64Array, quality: Uint8Array, now_ms: number): void {
    if (now_ms < this.taken_ms + every_ms) return;
    this.taken_ms = now_ms;
    this.taken++;
    this.columns.push(values.map((value, id) => isBad(quality[id]!) ? NaN : value));
    while (this.columns.length > most || this.columns.length * values.byteLength > mostBytes) this.columns.shift();
  }

  // Returns an SVG path in a box of this size; empty with fewer than two values. Its right end is the present.
  path(id: number, width: number, height: number): string {
    let low = Infinity, high = -Infinity, n = 0, text = '', pen = 'M';
    for (const column of this.columns) {
      const value = column[id]!;
      if (!Number.isFinite(value)) continue;
      n++;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    if (n < 2) return '';
    this.columns.forEach((column, index) => {
      const value = column[id]!;
      if (!Number.isFinite(value)) pen = 'M';
      else {
        const x = width * (1 - (this.columns.length - 1 - index) / (most - 1)), y = high > low ? height * (high - value) / (high - low) : height / 2;
        text += `${pen}${x.toFixed(1)} ${y.toFixed(1)}`;
        pen = 'L';
      }
    });
    return text;
  }
}
