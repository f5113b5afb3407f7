// Positions and labels of the marks of an axis. Pure except for the machine's time zone.

import { clock } from './format';

const second = 1000, minute = 60 * second, hour = 60 * minute, day = 24 * hour;
const timeSteps = [
  1, 2, 5, 10, 20, 50, 100, 200, 500, second, 2 * second, 5 * second, 10 * second, 15 * second, 30 * second,
  minute, 2 * minute, 5 * minute, 10 * minute, 15 * minute, 30 * minute, hour, 2 * hour, 3 * hour, 6 * hour, 12 * hour,
  day, 2 * day, 7 * day, 14 * day, 28 * day, 91 * day, 364 * day,
];

export interface Tick {
  at: number;
  text: string;
}

// Returns round numbers (1, 2, 5 times a power of ten), at most `most`.
export function numberTicks(min: number, max: number, most: number): Tick[] {
  const rough = (max - min) / Math.max(1, most);
  if (!(rough > 0) || !Number.isFinite(rough)) return [];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough * 0.999) ?? 10 * power;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks: Tick[] = [];
  for (let n = Math.ceil(min / step - 1e-9); n * step <= max + step * 1e-9; n++) {
    const at = n * step;
    ticks.push({ at, text: Math.abs(at) >= 1e7 ? at.toExponential(2) : at.toFixed(Math.min(10, decimals)) });
  }
  return ticks;
}

// Returns round times of the local clock; the first mark and each new day show the date.
export function timeTicks(from_ms: number, to_ms: number, most: number): Tick[] {
  const step = timeSteps.find((each) => (to_ms - from_ms) / each <= Math.max(1, most)) ?? timeSteps.at(-1)!;
  const offset_ms = (at: number): number => new Date(at).getTimezoneOffset() * minute;
  const ticks: Tick[] = [];
  let before = '';
  for (let local = Math.ceil((from_ms - offset_ms(from_ms)) / step) * step; ; local += step) {
    const at = local + offset_ms(local);
    if (at > to_ms) break;
    if (at < from_ms) continue;
    const date = new Date(at);
    const dayText = `${String(date.getMonth() + 1).padStart(2, '0')}-${String(date.getDate()).padStart(2, '0')}`;
    const text = step >= day ? dayText : step >= minute ? clock(at).slice(0, 5) : step >= second ? clock(at) :
      `${clock(at)}.${String(date.getMilliseconds()).padStart(3, '0')}`;
    ticks.push({ at, text: step < day && before && before !== dayText ? `${dayText} ${text}` : text });
    before = dayText;
  }
  return ticks;
}
