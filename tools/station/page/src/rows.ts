// Filters and sorts the channels of the live table. Pure: works on plain columns.

import { isBad, notYetRead } from './types';
import type { Channel } from './types';

export type SortKey = 'channel' | 'value' | 'quality' | 'age' | 'refresh';

export interface Choice {
  filter: string;
  onlyBad: boolean;
  badFirst: boolean;
  group: boolean;  // by device, with a heading row
  sort: SortKey;
  descending: boolean;
  pinned: ReadonlySet<string>;
}

export interface Columns {
  channels: ReadonlyMap<number, Channel>;
  value: Float64Array;
  acquired_ms: Float64Array;
  quality: Uint8Array;
}

// A row is a channel's id, or (-1 - index) for a heading.
export interface Rows {
  rows: Int32Array;
  headings: string[];
  channels: number;
}

// A pattern with * must match the whole path; otherwise the path must contain each word.
export function matcher(filter: string): (channel: Channel) => boolean {
  const text = filter.trim().toLowerCase();
  if (!text) return () => true;
  if (text.includes('*')) {
    const pattern = new RegExp(`^${text.split('*').map((part) => part.replace(/[.+?^${}()|[\]\\]/g, '\\$&')).join('.*')}$`);
    return (channel) => pattern.test(channel.path.toLowerCase());
  }
  const words = text.split(/\s+/);
  return (channel) => {
    const where = `${channel.path} ${channel.description} ${channel.at}`.toLowerCase();
    return words.every((word) => where.includes(word));
  };
}

const deviceOf = (path: string): string => path.slice(0, path.lastIndexOf('/'));
const badness = (quality: number): number => (isBad(quality) ? 0 : quality === 0 ? 3 : quality === notYetRead ? 2 : 1);
const byText = (a: string, b: string): number => (a < b ? -1 : a > b ? 1 : 0);

export function arrange(columns: Columns, choice: Choice): Rows {
  const { value, acquired_ms, quality } = columns;
  const fits = matcher(choice.filter);
  const found: Channel[] = [];
  for (const channel of columns.channels.values())
    if ((!choice.onlyBad || isBad(quality[channel.id] ?? notYetRead)) && fits(channel)) found.push(channel);
  const sign = choice.descending ? -1 : 1;
  const number = (x: number | undefined): number => (x === undefined || Number.isNaN(x) ? -Infinity : x);
  const sorts: Record<SortKey, (a: Channel, b: Channel) => number> = {
    channel: (a, b) => byText(a.path, b.path),
    value: (a, b) => number(value[a.id]) - number(value[b.id]) || 0,
    quality: (a, b) => badness(quality[a.id] ?? notYetRead) - badness(quality[b.id] ?? notYetRead),
    age: (a, b) => (acquired_ms[b.id] ?? 0) - (acquired_ms[a.id] ?? 0),
    refresh: (a, b) => a.refresh_ms - b.refresh_ms,
  };
  const sort = sorts[choice.sort];
  const rank = (channel: Channel): number => (choice.pinned.has(channel.path) ? 0 : 1);
  found.sort((a, b) =>
    rank(a) - rank(b) || (choice.group && rank(a) ? byText(deviceOf(a.path), deviceOf(b.path)) : 0) ||
    (choice.badFirst ? badness(quality[a.id] ?? notYetRead) - badness(quality[b.id] ?? notYetRead) : 0) ||
    sign * sort(a, b) || byText(a.path, b.path));
  const rows: number[] = [], headings: string[] = [];
  let heading: string | undefined;
  for (const channel of found) {
    const device = rank(channel) ? deviceOf(channel.path) : '';
    if (choice.group && device !== heading) {
      heading = device;
      rows.push(-1 - headings.length);
      headings.push(device);
    }
    rows.push(channel.id);
  }
  return { rows: Int32Array.from(rows), headings, channels: found.length };
}
