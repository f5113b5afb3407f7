// Formats numbers, times and durations for the user. Pure except for the language.

import { language } from './i18n';
import type { Channel, Shown } from './types';

const locale = (): string => (language === 'zh' ? 'zh-CN' : 'en-GB');

// Most decimals that each channel has shown, so that its column does not jump.
const decimalsSeen = new Map<number, number>();
const mostDecimals = 6;

function float32Text(value: number): string {
  for (let digits = 6; digits < 9; digits++) {
    const text = value.toPrecision(digits);
    if (Math.fround(Number(text)) === Math.fround(value)) return String(Number(text));
  }
  return String(value);
}

// Formats with all significant digits.
export function exactValue(value: number, type: string): string {
  if (type === 'bool') return value === 0 ? 'false' : 'true';
  if (type === 'float32') return float32Text(value);
  return String(Number(value.toPrecision(15)));
}

// Decimals of a channel; if they are unknown, those at which the largest of these values has about five digits, or of an integer type those
// that its values have.
export function decimalsOf(shown: Shown, values: readonly number[]): number {
  const known = shown.digits ?? shown.resolution;
  if (known !== undefined) return known;
  const finite = values.filter(Number.isFinite);
  if (shown.type === 'bool' || !finite.length) return 0;
  const exact = Math.max(...finite.map((value) => (/\.(\d+)$/.exec(String(Number(value.toPrecision(12))))?.[1] ?? '').length));
  const size = Math.max(...finite.map(Math.abs));
  if (!shown.type.startsWith('float')) return Math.min(exact, size >= 1 ? 3 : mostDecimals);
  if (size > 0 && size < 1e-4) return floatDecimals(size);
  return Math.min(exact, floatDecimals(size));
}

const floatDecimals = (size: number): number => (size >= 10_000 ? 0 : size >= 1000 ? 1 : size >= 100 ? 2 : size >= 1 ? 3 : size >= 0.1 ? 4 : Math.min(15, 2 - Math.floor(Math.log10(size))));

// Without configured digits, a value that is not 0 is not shown as 0.
function fixed(value: number, decimals: number, configured: boolean): string {
  const text = value.toFixed(decimals);
  if (Number(text) !== 0 || value === 0) return text.replace(/^-(0(\.0*)?)$/, '$1');
  return configured ? text.replace('-', '') : String(Number(value.toPrecision(3)));
}

// Formats a value beside others of its channel, all with the same decimals.
export function roundedValue(value: number | null | undefined, shown: Shown, decimals: number): string {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (shown.type === 'bool' && (value === 0 || value === 1)) return value ? 'true' : 'false';
  return Number.isFinite(value) ? fixed(value, decimals, shown.digits !== undefined) : value > 0 ? '∞' : '-∞';
}

export const shownValue = (value: number | null, shown: Shown = { type: 'float32' }): string =>
  roundedValue(value, shown, decimalsOf(shown, value === null ? [] : [value]));

// Formats a value in a table with as many decimals as the last ones of its channel.
export function tableValue(channel: Pick<Channel, 'id'> & Shown, value: number): string {
  const { id, type } = channel, size = Math.abs(value);
  if (channel.digits !== undefined || channel.resolution !== undefined || !(size > 0 && size < Infinity) || type === 'bool') return shownValue(value, channel);
  if (size >= 1e15) return value.toPrecision(6);
  if (type.startsWith('float')) return fixed(value, floatDecimals(size), false);
  const text = String(Number(value.toPrecision(12)));
  const point = text.indexOf('.');
  const decimals = Math.min(mostDecimals, Math.max(decimalsSeen.get(id) ?? 0, point < 0 ? 0 : text.length - point - 1));
  if (decimals > 0) decimalsSeen.set(id, decimals);
  return fixed(value, decimals, false);
}

export function age(ms: number): string {
  if (ms < 0) ms = 0;
  if (ms < 10_000) return `${(ms / 1000).toFixed(1)} s`;
  return duration(ms);
}

export function duration(ms: number): string {
  if (ms < 1) return ms === 0 ? '0 ms' : `${(ms * 1000).toFixed(0)} µs`;
  if (ms < 10) return `${Number(ms.toFixed(1))} ms`;
  if (ms < 1000) return `${Math.round(ms)} ms`;
  const s = ms / 1000;
  if (s < 10) return `${Number(s.toFixed(1))} s`;
  if (s < 100) return `${Math.round(s)} s`;
  if (s < 6000) return `${Math.round(s / 60)} min`;
  if (s < 172_800) return `${Math.round(s / 3600)} h`;
  return `${Math.round(s / 86_400)} d`;
}

export const percent = (share: number, digits = 0): string => `${(100 * share).toFixed(digits)} %`;

export const count = (n: number): string => n.toLocaleString(locale());

export function bytes(n: number): string {
  if (n < 1000) return `${n} B`;
  if (n < 1e6) return `${(n / 1e3).toFixed(1)} kB`;
  if (n < 1e9) return `${(n / 1e6).toFixed(1)} MB`;
  return `${(n / 1e9).toFixed(1)} GB`;
}

const two = (n: number): string => String(n).padStart(2, '0');

export function clock(ms: number): string {
  const at = new Date(ms);
  return `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}`;
}

// Local time, with the date if it is not today.
export function time(ms: number, now_ms = Date.now()): string {
  const at = new Date(ms);
  const day = `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;
  return at.toDateString() === new Date(now_ms).toDateString() ? clock(ms) : `${day} ${clock(ms)}`;
}

export function fullTime(ms: number): string {
  const at = new Date(ms);
  return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())} ${clock(ms)}.${String(at.getMilliseconds()).padStart(3, '0')}`;
}
