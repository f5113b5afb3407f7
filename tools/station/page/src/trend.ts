// Joins stored history and live values to one line. Pure.

import type { Line, Span } from './chart';
import type { Series } from './types';

export interface Sample {
  at_ms: number;
  value: number | null;  // null: bad from this time on
}

const gapAfter_ms = 35_000;  // shorter silences of the store are not gaps: an unchanged value may be stored that rarely
const mostSamples = 20_000;

// A line has a gap after a long time without a sample, and at bad samples.
export function lineOf(series: Series, label: string, refresh_ms = 0): Line {
  const line: Line = { label, unit: series.unit, stepped: series.type === 'bool', t: [], average: [], min: [], max: [], bad: [] };
  const gap_ms = Math.max(3 * series.bucket_ms, 3 * refresh_ms, gapAfter_ms);
  const width_ms = series.bucket_ms || refresh_ms || 1000;
  (series.t ?? []).forEach((at, index) => {
    const last = line.t.at(-1);
    if (last !== undefined && at - last > gap_ms) push(line, last + 1, null, null, null);
    push(line, at, series.average[index] ?? null, series.min[index] ?? null, series.max[index] ?? null);
    if ((series.bad[index] ?? 0) > 0) addSpan(line.bad, at, at + width_ms);
  });
  return line;
}

function push(line: Line, at: number, average: number | null, min: number | null, max: number | null): void {
  line.t.push(at);
  line.average.push(average);
  line.min.push(min);
  line.max.push(max);
}

function addSpan(spans: Span[], from_ms: number, to_ms: number): void {
  const last = spans.at(-1);
  if (last && from_ms <= last.to_ms + 1) last.to_ms = Math.max(last.to_ms, to_ms);
  else spans.push({ from_ms, to_ms });
}

// Samples that arrived while the page is open; they continue the stored line.
export class LiveTail {
  private readonly samples: Sample[] = [];
  private readonly bad: Span[] = [];
  private badFrom_ms = 0;

  // refresh_ms: the promised refresh; 0: none, so no refresh can be missed.
  constructor(private readonly refresh_ms: number) {}

  add(at_ms: number, value: number, good: boolean, now_ms: number): void {
    const last = this.samples.findLast((sample) => sample.value !== null)?.at_ms ?? 0;
    if (!good) {
      if (this.badFrom_ms) return;
      this.badFrom_ms = Math.min(now_ms, Math.max(last, at_ms) || now_ms);
      this.samples.push({ at_ms: Math.max(this.badFrom_ms, last + 1), value: null });
      return;
    }
    if (at_ms <= last) return;
    if (this.badFrom_ms) {
      this.bad.push({ from_ms: this.badFrom_ms, to_ms: at_ms });
      this.badFrom_ms = 0;
    } else if (last && this.refresh_ms && at_ms - last > this.late_ms()) {
      this.bad.push({ from_ms: last + this.refresh_ms, to_ms: at_ms });
      this.samples.push({ at_ms: last + 1, value: null });
    }
    this.samples.push({ at_ms, value });
    if (this.samples.length > mostSamples) this.samples.splice(0, mostSamples / 10);
    if (this.bad.length > 1000) this.bad.splice(0, 100);
  }

  // Returns the stored line continued with newer samples. A present outage extends to now.
  join(line: Line, from_ms: number, now_ms: number): Line {
    const end = line.t.at(-1) ?? from_ms;
    const joined: Line = { ...line, t: [...line.t], average: [...line.average], min: [...line.min], max: [...line.max], bad: line.bad.map((span) => ({ ...span })) };
    for (const sample of this.samples)
      if (sample.at_ms > end) push(joined, sample.at_ms, sample.value, sample.value, sample.value);
    for (const span of this.bad) if (span.to_ms > end) addSpan(joined.bad, span.from_ms, span.to_ms);
    const last = this.samples.at(-1);
    if (this.badFrom_ms) addSpan(joined.bad, this.badFrom_ms, now_ms);
    else if (last && this.refresh_ms && now_ms - last.at_ms > this.late_ms() + 1000) addSpan(joined.bad, last.at_ms + this.refresh_ms, now_ms);
    return joined;
  }

  private late_ms(): number { return 2.2 * this.refresh_ms + 50; }
}
