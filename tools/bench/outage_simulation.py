#!/usr/bin/env python3
"""Simulates many sites that send their backlog to one centre after a common outage.

usage: tools/bench/outage_simulation.py [--sites 1000] [--samples 10000] [--outage 3600] [--uplink 250] [--round-trip 50] [--devices 100]
           [--live-bytes 8.0] [--late-bytes 6.6] [--live-message 1200] [--message-cost 23] [--byte-cost 0.01] [--cores 4] [--connects 600]
           [--late-after 10] [--late-window 1] [--observe S] [--step 0.05] [--seed 1]

A fluid model in steps of --step seconds, four times as long after the first minute. Its rules are those of the forwarder (tools/forward/send,
outlet/nats):
- A site tries to connect each 1 to 1.5 s. The centre accepts --connects a second; an attempt that waits longer than 3 s is repeated.
- A connected site publishes --samples a second, of --live-bytes each on the wire, in messages of --live-message bytes. They are sent first.
  Those of the last --late-after seconds before it was connected are live too.
- Late messages have 16 kB at most, one of each of --devices in flight, and as many bytes in flight as the window allows: it grows by what
  was acknowledged while that needs at most 0.25 s longer than the fastest one, else it is halved. --late-window 0: without this bound.
- An uplink has --uplink kB/s, at half of the sites; a quarter has half of this, and a quarter twice as much.
- The centre is one queue, served by --cores processors, with --message-cost us for a message and --byte-cost us for a byte
  (tools/bench/ingest_bench.py measures both).
Prints the time until 50 %, 99 % and all sites have no backlog, and the delay of samples that were published after their site was connected:
from the time when a message is full, without the time for which it is gathered. --observe: only of this many seconds.
"""

import argparse
import collections
import heapq
import random
import sys

RETRY, JITTER, CONNECT_LIMIT = 1.0, 0.5, 3.0  # seconds
LEAST, MOST, TARGET = 16 << 10, 8 << 20, 0.25  # of the window for late samples: bytes, bytes, seconds
LATE_MESSAGE = 16_000  # bytes
UPLINKS = [0.5, 1, 1, 2]  # factors
LIMIT = 24 * 3600  # seconds of simulated time
FINE, COARSE = 60, 4  # seconds with short steps; how much longer the later steps are


def connected_at(sites, connects, draw):
    """The times at which the sites are connected, in seconds after the return of the centre. The centre also spends its time on attempts that
    were given up meanwhile, so too many sites may never be connected: then infinity."""
    attempts = [(draw.uniform(0, RETRY + JITTER), site) for site in range(sites)]
    heapq.heapify(attempts)
    found, free = [float("inf")] * sites, 0.0
    while attempts:
        at, site = heapq.heappop(attempts)
        if at > LIMIT:
            break
        free = max(free, at) + 1 / connects
        if free - at > CONNECT_LIMIT:
            heapq.heappush(attempts, (at + CONNECT_LIMIT + RETRY + draw.uniform(0, JITTER), site))
        else:
            found[site] = free
    return found


class Site:
    def __init__(self, options, uplink, connected):
        self.uplink, self.connected, self.round_trip = uplink, connected, options.round_trip / 1000
        self.demand = options.samples * options.live_bytes  # bytes a second
        recent = min(options.late_after, options.outage + connected)
        self.backlog = options.samples * (options.outage + connected - recent) * options.late_bytes
        self.live = self.demand * recent  # bytes that wait at the site
        self.bound = options.devices * LATE_MESSAGE
        self.window, self.is_bounded, self.reduced = float(LEAST), options.late_window, -1e9
        if not self.is_bounded:
            self.window = float(self.bound)

    def step(self, now, step, wait):
        """One step; `wait`: seconds in the queue of the centre. Returns (live bytes, late bytes, seconds of delay of live ones)."""
        self.live += self.demand * step
        live = min(self.live, self.uplink * step)
        self.live -= live
        free = self.uplink * step - live
        late, ahead = 0.0, 0.0
        if self.backlog > 0 and free > 0:
            flight = min(self.window, self.bound, self.backlog + LATE_MESSAGE)
            rate = max(free / step, 1.0)
            shortest = self.round_trip + wait + LATE_MESSAGE / self.uplink
            response = max(shortest, flight / rate)
            late = min(self.backlog, free, flight / response * step)
            self.backlog -= late
            ahead = max(0.0, flight / rate - shortest) if flight / rate > shortest else 0.0
            if self.is_bounded:
                self._adapt(late, response, now)
        return live, late, self.round_trip / 2 + wait + ahead + self.live / self.uplink

    def _adapt(self, acknowledged, response, now):
        if response <= self.round_trip + LATE_MESSAGE / self.uplink + TARGET:
            self.window = min(MOST, self.window + acknowledged)
        elif now - self.reduced > response:
            self.window, self.reduced = max(LEAST, self.window / 2), now


def simulate(options):
    """(times at which the backlogs end, {delay in ms: samples}, most seconds of work in the queue of the centre, connection times)"""
    draw = random.Random(options.seed)
    connects = connected_at(options.sites, options.connects, draw)
    if max(connects) > LIMIT:
        raise SystemExit("not all sites are ever connected: the centre accepts too few connections a second")
    sites = [Site(options, options.uplink * 1000 * UPLINKS[number % len(UPLINKS)] if options.sites > 1 else options.uplink * 1000, at)
             for number, at in enumerate(connects)]
    waiting, active = sorted(sites, key=lambda site: -site.connected), []
    done, delays, queue, highest, now = [], collections.Counter(), 0.0, 0.0, 0.0
    message, byte = options.message_cost / 1e6, options.byte_cost / 1e6
    quiet = 0.0  # work of the sites without a backlog, in a second
    quiet_sites = 0
    of_one = options.samples * options.live_bytes * (message / options.live_message + byte)
    while (waiting or active) and now < LIMIT:
        step = options.step * (1 if now < FINE else COARSE)
        now += step
        while waiting and waiting[-1].connected <= now:
            active.append(waiting.pop())
        work, left = quiet * step, []
        for site in active:
            live, late, delay = site.step(now, step, queue / options.cores)
            if now <= options.observe:
                delays[round(1000 * delay)] += site.demand * step
            work += live * (message / options.live_message + byte) + late * (message / LATE_MESSAGE + byte)
            if site.backlog > 0:
                left.append(site)
            else:
                done.append(now)
                quiet, quiet_sites = quiet + of_one, quiet_sites + 1
        if now <= options.observe:
            delays[round(1000 * (options.round_trip / 2000 + queue / options.cores))] += quiet_sites * options.samples * options.live_bytes * step
        active = left
        queue = max(0.0, queue + work - options.cores * step)
        highest = max(highest, queue / options.cores)
    return done, delays, highest, connects


def quantile(delays, part):
    left = part * sum(delays.values())
    for delay in sorted(delays):
        left -= delays[delay]
        if left <= 0:
            return delay
    return max(delays)


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in [("sites", 1000), ("devices", 100), ("seed", 1), ("late-window", 1)]:
        parser.add_argument("--" + name, type=int, default=default)
    for name, default in [("samples", 10_000), ("outage", 3600), ("uplink", 250), ("round-trip", 50), ("live-bytes", 8.0), ("late-bytes", 6.6),
                          ("live-message", 1200), ("message-cost", 23), ("byte-cost", 0.01), ("cores", 4), ("connects", 600),
                          ("late-after", 10), ("observe", LIMIT), ("step", 0.05)]:
        parser.add_argument("--" + name, type=float, default=default)
    return parser.parse_args(arguments)


def main():
    options = options_of(sys.argv[1:])
    done, delays, highest, connects = simulate(options)
    load = options.sites * options.samples * options.live_bytes * (options.message_cost / options.live_message + options.byte_cost) / 1e6
    print(f"{options.sites} sites of {options.samples:.0f} samples a second, outage of {options.outage:.0f} s: live samples use {load:.2f} of "
          f"{options.cores:g} cores and {options.sites * options.samples * options.live_bytes / 1e6:.1f} MB/s")
    print(f"connected: all after {max(connects):.1f} s")
    if len(done) < options.sites:
        print(f"{options.sites - len(done)} sites still have a backlog after {LIMIT} s: an uplink or the centre is too slow")
    else:
        print("without a backlog: " + ", ".join(f"{name} after {done[min(len(done) - 1, int(part * len(done)))]:.0f} s"
                                                for name, part in [("50 %", 0.5), ("99 %", 0.99), ("all", 1)]))
    print(f"delay of live samples: p50 {quantile(delays, 0.5)} ms, p99 {quantile(delays, 0.99)} ms, most {max(delays)} ms; "
          f"longest queue at the centre {1000 * highest:.0f} ms")


if __name__ == "__main__":
    main()
