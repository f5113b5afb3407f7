// What widgets show of a channel: value, quality and age together, so that no value can look fresher than it is.

import type { Change, Context } from '../context';
import { age, tableValue } from '../format';
import { t } from '../i18n';
import type { Plant } from '../plant';
import { isLate, notYetRead } from '../types';
import type { Channel } from '../types';
import { qualityText, shape, toneOfQuality } from '../view';
import type { Tone } from '../view';

export interface Reading {
  path: string;
  channel: Channel | undefined;  // undefined: no bridge announces it
  text: string;  // '–' without a value
  value: number;  // NaN without a number
  unit: string;
  quality: number;
  tone: Tone;  // 'warning' also for a late value
  current: boolean;  // good, and not late
  late: boolean;
  acquired_ms: number;  // 0: never
  age_ms: number;  // NaN: never
}

export function readingOf(plant: Plant, path: string, now_ms: number, digits?: number): Reading {
  const id = plant.ids.get(path);
  const channel = id === undefined ? undefined : plant.channels.get(id);
  if (id === undefined || !channel)
    return { path, channel: undefined, text: '–', value: NaN, unit: '', quality: notYetRead, tone: 'unknown', current: false, late: false, acquired_ms: 0, age_ms: NaN };
  const quality = plant.quality[id] ?? notYetRead, acquired_ms = plant.acquired_ms[id] ?? 0, given = plant.texts.get(id);
  const value = given === undefined ? plant.value[id] ?? NaN : Number(given);
  const age_ms = acquired_ms ? Math.max(0, now_ms - acquired_ms) : NaN, late = acquired_ms > 0 && isLate(channel, age_ms);
  const tone = toneOfQuality(quality);
  const shown = given !== undefined ? given : !acquired_ms || Number.isNaN(value) ? '–' : tableValue(digits === undefined ? channel : { ...channel, digits }, value);
  return {
    path, channel, text: shown, value, unit: channel.unit, quality, tone: late && tone === 'good' ? 'warning' : tone, late,
    current: quality === 0 && !late, acquired_ms, age_ms,
  };
}

export const ageText = (reading: Reading): string => (Number.isNaN(reading.age_ms) ? '–' : age(reading.age_ms));

// "◆ 12 s": shape of the quality and age.
export const stateText = (reading: Reading): string => `${shape(reading.tone)} ${ageText(reading)}`;

// Quality and age in words, for titles and screen readers.
export const stateWords = (reading: Reading): string =>
  !reading.channel ? t('channel.unknown', { path: reading.path }) :
  `${reading.path}: ${qualityText(reading.quality)}${reading.late ? `, ${t('dashboard.late')}` : ''}, ${t('channel.age')} ${ageText(reading)}`;

const badness: Record<Tone, number> = { bad: 3, unknown: 2, warning: 1, good: 0 };

// The reading that the frame of a widget shows: the worst one, and of equal ones the oldest.
export const worstOf = (readings: readonly Reading[]): Reading | undefined =>
  readings.reduce<Reading | undefined>((worst, each) =>
    (!worst || badness[each.tone] > badness[worst.tone] || (each.tone === worst.tone && each.age_ms > worst.age_ms) ? each : worst), undefined);

// The channels of one widget. Follows ids over a new connection.
export class Sources {
  private ids: (number | undefined)[] = [];
  private turn = -1;
  readings: Reading[] = [];

  constructor(private readonly context: Context, readonly paths: readonly string[], private readonly digits?: number) {}

  // Reads all channels again and returns true if one changed, or their ages must be shown again.
  update(change: Change): boolean {
    const { plant } = this.context;
    const first = this.turn < 0;
    if (first || change.topics.has('catalogue')) this.ids = this.paths.map((path) => plant.ids.get(path));
    const newer = this.ids.some((id) => id !== undefined && plant.stamp[id]! > this.turn);
    this.turn = plant.turn;
    if (!newer && !first && !change.second && !change.topics.has('catalogue') && !change.topics.has('connection')) return false;
    const now = this.context.now();
    this.readings = this.paths.map((path) => readingOf(plant, path, now, this.digits));
    return true;
  }
}

// Returns a test of paths for a pattern of the station: BUS/DEVICE/CHANNEL, each with *; a shorter pattern contains all below it.
export function patternTest(pattern: string): (path: string) => boolean {
  const glob = (part: string): string => part.split('*').map((text) => text.replace(/[.+?^${}()|[\]\\]/g, '\\$&')).join('[^/]*');
  const parts = pattern.split('/').map(glob);
  while (parts.length < 3) parts.push('[^/]*');
  const expression = new RegExp(`^${parts.join('/')}$`);
  return (path) => expression.test(path);
}
