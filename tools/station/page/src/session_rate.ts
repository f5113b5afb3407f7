// Rate of a programming session, from its reports: a bridge sends one each second in which bytes passed. Pure.

import type { Session } from './types';

const quietMs = 3000;  // without a report for this time nothing passes
const bytesOf = (session: Session): number => session.bytes_to_device + session.bytes_from_device;

export class SessionRates {
  private readonly last = new Map<string, { session: Session; at: number; perSecond: number }>();

  // `at`: monotonic time of the arrival in milliseconds.
  report(path: string, session: Session, at: number): void {
    const known = this.last.get(path);
    if (!known || known.session.since_ms !== session.since_ms) this.last.set(path, { session, at, perSecond: 0 });
    else if (bytesOf(session) > bytesOf(known.session)) {
      const seconds = Math.max(1, (at - known.at) / 1000);
      this.last.set(path, { session, at, perSecond: (bytesOf(session) - bytesOf(known.session)) / seconds });
    }
  }

  // Bytes a second in both directions; 0 for a session that is not open.
  of(path: string, at: number): number {
    const known = this.last.get(path);
    return known && at - known.at < quietMs ? known.perSecond : 0;
  }

  clear(): void {
    this.last.clear();
  }
}
