// The order of buses on the overview: those that need attention first. Pure. The ranks are classes, so that buses do not change
// places with each small change of a number.

import type { Bus } from './types';

export interface BusNeed {
  contested: boolean;
  alarms: number;  // unacknowledged
  bad: number;  // channels
  missed: number;  // refreshes in the last minute
}

export function rankOf(bus: Bus, need: BusNeed): number {
  if (need.contested || (bus.state !== 'running' && bus.state !== 'leased')) return 0;
  if (need.alarms) return 1;
  if (bus.stretch > 1.005 || bus.planned_load > 1) return 2;
  if (need.bad) return 3;
  return need.missed ? 4 : 5;
}

export const worstFirst = <T extends { bus: Bus; need: BusNeed }>(rows: readonly T[]): T[] =>
  [...rows].sort((a, b) => rankOf(a.bus, a.need) - rankOf(b.bus, b.need) || a.bus.bus.localeCompare(b.bus.bus));
