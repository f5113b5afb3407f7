// Measures the age of values when they were painted: the last few thousand, for the bench and the browser's console
// (`fieldcastMeter`). The age is taken after the animation frame has been passed to the browser.

const kept = 8192;

class Meter {
  readonly ages_ms = new Float32Array(kept);
  count = 0;
  now: () => number = Date.now;
  private readonly open: number[] = [];
  private readonly channel = new MessageChannel();

  constructor() {
    this.channel.port1.onmessage = () => {
      const now = this.now();
      for (const acquired_ms of this.open) this.ages_ms[this.count++ % kept] = now - acquired_ms;
      this.open.length = 0;
    };
  }

  // REQUIRES: called in an animation frame.
  painted(acquired_ms: number): void {
    if (acquired_ms > 0 && this.open.push(acquired_ms) === 1) this.channel.port2.postMessage(0);
  }
}

export const meter = new Meter();
(globalThis as { fieldcastMeter?: Meter }).fieldcastMeter = meter;
