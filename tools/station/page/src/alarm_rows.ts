// Filters and sorts alarms; those that need attention are first. Pure.

import { alarmKey } from './plant';
import type { Alarm } from './types';

export const sections = ['unacknowledged', 'acknowledged', 'shelved', 'maintenance'] as const;
export type Section = (typeof sections)[number];

export const priorities = ['critical', 'high', 'medium', 'low'] as const;

// A shelved alarm, or one in maintenance, needs no attention in any state.
export function sectionOf(alarm: Alarm, now_ms: number): Section {
  if (isShelved(alarm, now_ms)) return 'shelved';
  if (alarm.suppressed) return 'maintenance';
  return alarm.state === 'unacknowledged' || alarm.state === 'returned' ? 'unacknowledged' : 'acknowledged';
}

export const isShelved = (alarm: Alarm, now_ms: number): boolean => (alarm.shelved_until_ms ?? 0) > now_ms;
export const wantsSomebody = (alarm: Alarm, now_ms: number): boolean => sectionOf(alarm, now_ms) === 'unacknowledged';

function fits(alarm: Alarm, words: readonly string[]): boolean {
  const text = `${alarmKey(alarm)} ${alarm.priority} ${alarm.note} ${alarm.acknowledged_by}`.toLowerCase();
  return words.every((word) => text.includes(word));
}

export interface AlarmChoice {
  filter: string;
  section: Section | undefined;  // undefined: all sections
}

export interface ArrangedAlarms {
  alarms: Alarm[];
  counts: Record<Section, number>;  // of all alarms that match the filter
}

export function arrangeAlarms(alarms: Iterable<Alarm>, choice: AlarmChoice, now_ms: number): ArrangedAlarms {
  const words = choice.filter.toLowerCase().split(/\s+/).filter(Boolean);
  const counts: Record<Section, number> = { unacknowledged: 0, acknowledged: 0, shelved: 0, maintenance: 0 };
  const found: { alarm: Alarm; rank: number }[] = [];
  for (const alarm of alarms) {
    if (words.length && !fits(alarm, words)) continue;
    const section = sectionOf(alarm, now_ms);
    counts[section]++;
    if (choice.section && choice.section !== section) continue;
    found.push({ alarm, rank: sections.indexOf(section) * 8 + priorities.indexOf(alarm.priority) });
  }
  found.sort((a, b) => a.rank - b.rank || b.alarm.since_ms - a.alarm.since_ms || alarmKey(a.alarm).localeCompare(alarmKey(b.alarm)));
  return { alarms: found.map(({ alarm }) => alarm), counts };
}

// Keeps the rows of `shown` at their places while the user points at one: known alarms have their new contents, alarms that are
// no longer present stay as clear, and new ones are at the end.
export function steadyAlarms(shown: readonly Alarm[], present: ReadonlyMap<string, Alarm>, arranged: readonly Alarm[]): Alarm[] {
  const keys = new Set(shown.map(alarmKey));
  return [...shown.map((alarm) => present.get(alarmKey(alarm)) ?? { ...alarm, state: 'clear' as const, active: false }),
    ...arranged.filter((alarm) => !keys.has(alarmKey(alarm)))];
}

// Returns the value farthest beyond the limit.
export const worstOf = (limit: string, values: readonly (number | null | undefined)[]): number | null => {
  const known = values.filter((value): value is number => typeof value === 'number' && Number.isFinite(value));
  return known.length ? (limit.startsWith('low') ? Math.min(...known) : Math.max(...known)) : null;
};
