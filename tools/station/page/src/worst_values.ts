// The worst value of each alarm since it was raised, from the store of the station and from the values that arrive. The bridge reports
// only the value that raised or cleared an alarm.

import { worstOf } from './alarm_rows';
import { query, request } from './api';
import type { Context } from './context';
import { alarmKey } from './plant';
import type { Alarm, History } from './types';

const mostAlarms = 40;  // of the first rows; the value of others is that of the bridge and of this page
const points = 1000;

export class WorstValues {
  private readonly known = new Map<string, { since_ms: number; worst: number | null }>();
  private readonly asked = new AbortController();

  constructor(private readonly context: Context, private readonly arrived: () => void) {}

  // Requests the stored values of alarms that are new here.
  load(alarms: readonly Alarm[]): void {
    for (const alarm of alarms.slice(0, mostAlarms))
      if (this.known.get(alarmKey(alarm))?.since_ms !== alarm.since_ms) void this.read(alarm);
  }

  // `now`: the channel's present value, if it is good.
  of(alarm: Alarm, now: number | undefined): number | null {
    const entry = this.known.get(alarmKey(alarm));
    const worst = worstOf(alarm.limit, [entry?.worst, alarm.value, alarm.active ? now : undefined]);
    if (entry) entry.worst = worst;
    return worst;
  }

  close(): void { this.asked.abort(); }

  private async read(alarm: Alarm): Promise<void> {
    const entry = { since_ms: alarm.since_ms, worst: alarm.value };
    this.known.set(alarmKey(alarm), entry);
    if (!this.context.me.store || !alarm.since_ms) return;
    const channel = `${alarm.bus}/${alarm.device}/${alarm.channel}`;
    try {
      const { series } = await request<History>(
        query('/api/history', { channel, from: Math.floor(alarm.since_ms), to: Math.ceil(this.context.now()), points }), undefined, this.asked.signal);
      const values = alarm.limit.startsWith('low') ? series[0]?.min : series[0]?.max;
      entry.worst = worstOf(alarm.limit, [entry.worst, ...(values ?? [])]);
      this.arrived();
    } catch {
      // without stored values, the worst one is that of the bridge and of this page
    }
  }
}
