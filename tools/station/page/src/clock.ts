// Estimates the station's clock from the times in its messages. A message is late by an unknown time, never early, so the largest
// observed difference is the best estimate. It expires after a while, since clocks drift and are set. Pure except for this machine's clock.

const window_ms = 30_000;

export class StationClock {
  private since_ms = 0;
  private largest_ms = -Infinity;  // in this window
  private before_ms = -Infinity;  // in the previous window
  private offset_ms = 0;

  constructor(private readonly own: () => number = Date.now) {}

  now(): number { return this.own() + this.offset_ms; }

  // station_ms: Unix time at which the message was made.
  observe(station_ms: number): void {
    const own = this.own(), difference = station_ms - own;
    if (!(difference > -Infinity)) return;
    if (own - this.since_ms > window_ms || own < this.since_ms) {
      this.before_ms = this.largest_ms;
      this.largest_ms = -Infinity;
      this.since_ms = own;
    }
    this.largest_ms = Math.max(this.largest_ms, difference);
    this.offset_ms = Math.max(this.largest_ms, this.before_ms);
  }

  // Forgets the differences, as a different station may respond after a reconnect.
  restart(): void {
    this.largest_ms = this.before_ms = -Infinity;
  }
}
