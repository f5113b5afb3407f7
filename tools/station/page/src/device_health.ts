// Health of a device, with the reason. Pure.

import type { Bus, Counts, Device, Session } from './types';

export const deviceStates = ['offline', 'degraded', 'unknown', 'online'] as const;

export type Reason =
  | { kind: 'programmed'; who: string }
  | { kind: 'bus-closed' | 'failing'; cause: string }
  | { kind: 'bus-leased' | 'refuses' | 'not-read' | 'fine'; n: number };

export const mostFrequent = (counts: Counts): string | undefined =>
  Object.entries(counts).reduce<[string, number] | undefined>((best, each) => (!best || each[1] > best[1] ? each : best), undefined)?.[0];

// Returns the cause that grew most between two reports; undefined if none did.
export function grownCause(before: Counts, after: Counts): string | undefined {
  const growth: Counts = {};
  for (const [cause, n] of Object.entries(after)) if (n > (before[cause] ?? 0)) growth[cause] = n - (before[cause] ?? 0);
  return mostFrequent(growth);
}

// `recent`: the last cause of its failures, if this page has received one.
export function reasonOf(device: Device, bus: Bus | undefined, session: Session | undefined, recent: string | undefined): Reason {
  if (session?.state === 'open') return { kind: 'programmed', who: session.who };
  if (bus?.state === 'closed') return { kind: 'bus-closed', cause: bus.closed_because ?? 'PORT_CLOSED' };
  if (bus?.state === 'leased') return { kind: 'bus-leased', n: 0 };
  const cause = recent ?? mostFrequent(device.causes);
  if (device.state === 'offline') return { kind: 'failing', cause: cause ?? 'NO_ANSWER' };
  if (device.state === 'unknown') return { kind: 'not-read', n: 0 };
  if (device.refused.length && (device.state === 'online' || !recent)) return { kind: 'refuses', n: device.refused.length };
  if (device.state === 'degraded' && cause) return { kind: 'failing', cause };
  return { kind: 'fine', n: 0 };
}

export const pathOf = (device: { bus: string; device: string }): string => `${device.bus}/${device.device}`;
export const failedShare = (device: Device): number => (device.exchanges ? device.failures / device.exchanges : 0);

// Sorts devices, worst state first.
export const orderedDevices = (devices: Iterable<Device>): Device[] =>
  [...devices].sort((a, b) => rank(a) - rank(b) || pathOf(a).localeCompare(pathOf(b)));
const rank = (device: Device): number => {
  const index = (deviceStates as readonly string[]).indexOf(device.state);
  return index < 0 ? 2 : index;
};
