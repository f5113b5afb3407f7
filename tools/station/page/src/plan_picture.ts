// The geometry of a read plan: time and duration of the reads of each group, and the channels of each read. Pure; times are in
// milliseconds from the start of the timetable.

import type { PlanGroup, PlanPoint, ReadPlan } from './types';

export interface Read {
  index: number;  // number of the read in the hyperperiod, from 0
  begin_ms: number;
  end_ms: number;
}

// Mean duration of a read, computed from the load of the group: the plan has no duration for each read.
export const readTime_ms = (group: PlanGroup): number => group.load * (group.period_ms ?? 0);

export const readCount = (group: PlanGroup, hyperperiod_ms: number): number =>
  group.period_ms ? Math.max(1, Math.round(hyperperiod_ms / group.period_ms)) : 0;

export function readOf(group: PlanGroup, index: number, hyperperiod_ms: number): Read | undefined {
  const count = readCount(group, hyperperiod_ms);
  if (!count || group.phase_ms === null) return undefined;
  const wrapped = ((index % count) + count) % count;
  const end_ms = (group.phase_ms % group.period_ms!) + wrapped * group.period_ms!;
  return { index: wrapped, begin_ms: end_ms - readTime_ms(group), end_ms };
}

export function readNear(group: PlanGroup, at_ms: number, hyperperiod_ms: number): Read | undefined {
  if (!group.period_ms || group.phase_ms === null) return undefined;
  const middle_ms = (group.phase_ms % group.period_ms) - readTime_ms(group) / 2;
  const last = readCount(group, hyperperiod_ms) - 1;
  return readOf(group, Math.max(0, Math.min(last, Math.round((at_ms - middle_ms) / group.period_ms))), hyperperiod_ms);
}

// Returns the points of a read; a slower point is only in every m-th read.
export function pointsOf(group: PlanGroup, read: Read): PlanPoint[] {
  const tolerance_ms = 1e-3;
  return group.points.filter((point) => {
    if (point.period_ms === null || point.phase_ms === null) return false;
    const off = Math.abs(read.end_ms - point.phase_ms) % point.period_ms;
    return Math.min(off, point.period_ms - off) < tolerance_ms;
  });
}

// "holding 100..139, coil 0..7"
export function rangeText(points: readonly PlanPoint[]): string {
  const areas = new Map<string, { first: number; last: number }>();
  for (const point of points) {
    const last = point.first + Math.max(1, point.count) - 1;
    const range = areas.get(point.area);
    if (!range) areas.set(point.area, { first: point.first, last });
    else {
      range.first = Math.min(range.first, point.first);
      range.last = Math.max(range.last, last);
    }
  }
  return [...areas].map(([area, { first, last }]) => `${area} ${first === last ? first : `${first}..${last}`}`).join(', ');
}

export type Span = readonly [from: number, to: number];

// Returns the marks of the reads in pixels, at least `least` wide. Marks that touch are joined, so there are at most as many as pixels.
export function marksOf(groups: readonly PlanGroup[], hyperperiod_ms: number, width: number, least = 1.5): Span[] {
  const scale = width / hyperperiod_ms;
  const spans: [number, number][] = [];
  const add = (from: number, to: number): void => {
    spans.push([from * scale, Math.min(width, Math.max(to * scale, from * scale + least))]);
  };
  for (const group of groups)
    for (let index = 0; index < readCount(group, hyperperiod_ms); index++) {
      const read = readOf(group, index, hyperperiod_ms);
      if (!read) break;
      if (read.begin_ms < 0) add(hyperperiod_ms + read.begin_ms, hyperperiod_ms);  // it began in the previous table
      add(Math.max(0, read.begin_ms), read.end_ms);
    }
  spans.sort((a, b) => a[0] - b[0]);
  const merged: [number, number][] = [];
  for (const span of spans) {
    const last = merged.at(-1);
    if (last && span[0] <= last[1] + 0.25) last[1] = Math.max(last[1], span[1]);
    else merged.push([...span]);
  }
  return merged;
}

export const pathOf = (spans: readonly Span[], top: number, height: number): string =>
  spans.map(([from, to]) => `M${from.toFixed(1)} ${top}h${(to - from).toFixed(1)}v${height}H${from.toFixed(1)}z`).join('');

// Sorts by device, area and address; groups without a period are last.
export function orderedGroups(plan: ReadPlan): PlanGroup[] {
  const order = (group: PlanGroup): number => group.points[0]?.first ?? 0;
  return [...plan.groups].sort((a, b) => Number(a.period_ms === null) - Number(b.period_ms === null) || a.device.localeCompare(b.device) ||
    (a.points[0]?.area ?? '').localeCompare(b.points[0]?.area ?? '') || order(a) - order(b));
}

// Returns at most `most` instants for the axis, at round distances.
export function axisTicks(hyperperiod_ms: number, most: number): number[] {
  const raw = hyperperiod_ms / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= raw) ?? 10 * power;
  const ticks: number[] = [];
  for (let n = 0; n * step <= hyperperiod_ms; n++) ticks.push(n * step);
  return ticks;
}
