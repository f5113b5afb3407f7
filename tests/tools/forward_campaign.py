"""The fault campaign of fieldcast-forward: kills and cuts while samples flow from many sites to a cluster of JetStream, and a check of what arrived.

usage: forward_campaign.py --bin BIN_DIR [--minutes M] [--sites N] [--channels C] [--seed S] [--nodes 3] [--folder DIR] [--stores] [--backfill]
                           [--lines YAML]

Each site publishes C channels once a second (bench_bridge, which records them) in a DDS domain of its own. Faults are drawn from the seed
(forward_faults.py): kill -9 of nodes, of forwarders and of bridges, and one cut of the uplinks of half of the sites. Every second site has a
round trip of 200 ms, and as root every fourth one also loses 5 % of the packets in each direction. At the end, a consumer that shares no code with
the forwarder reads the stream, and forward_checker.py compares it with the records.

--stores: each bridge stores its samples, and the checker also compares what arrived with its store: a sample that arrived must be there, except
within 1 s before the bridge was killed. --backfill, which implies --stores: samples that were published while a forwarder did not run must arrive
too, and of the samples around the end of a bridge those that its store has.

Missing samples are allowed only in these times, and are counted apart: while a forwarder did not run, from 2.5 s before its kill to 8 s after
its start; from 1 s before a bridge was killed to 8 s after its start; and in the first seconds of the campaign. --lines: further lines of forward.yaml. --folder: keeps logs, queues and records there.
Exit code: 0 in order, 1 a violation, 2 wrong usage.
"""

import argparse
import heapq
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time

import nats
import networks
from forward_checker import Checker, Window
from forward_faults import BRIDGE, CUT, FORWARDER, NODE, schedule
from forward_messages import Batch, catalogue_channels, name_of
from forward_sites import Site, Uplink, folder_bytes, memory_of
from plant import Failure, wait_until

GATHER = 1.0  # seconds, the default of gather.time
UNCOMMITTED = GATHER + 1.5  # seconds before a kill of the forwarder in which a sample may be gathered, but not queued
UNSENT = 1.0  # seconds before the end of a bridge in which DDS may not have sent a sample yet
REJOIN = 8.0  # seconds until a restarted participant of DDS receives all samples again
ROUND_TRIP = 0.2  # seconds
LOSS = 5  # per cent
MEASURE = 5.0  # seconds between two readings of memory and backlog
DRAIN_SECONDS = 120
FILL_SECONDS = 120  # until a gap at the end of the campaign is filled from the store
NOT_RUNNING, BRIDGE_ENDED, STARTING = "the forwarder did not run", "a bridge ended or started", "the campaign started"


def measured(channel, sequence):
    """The value that bench_bridge publishes."""
    noise = ((sequence * 0x9E3779B97F4A7C15 + channel) * 0xBF58476D1CE4E5B9 & (1 << 64) - 1) >> 40
    return struct.unpack("f", struct.pack("f", 50 + 20 * math.sin(sequence / 60 + channel) + noise * 1e-8))[0]


def lose_packets(ports):
    """Loses packets to and from these ports, in this network namespace."""
    numbers = ", ".join(str(port) for port in ports)
    networks.system("nft", "-f", "-", stdin=f"""
        table inet loss {{
          chain input {{
            type filter hook input priority 0
            tcp dport {{ {numbers} }} numgen random mod 100 < {LOSS} counter drop
            tcp sport {{ {numbers} }} numgen random mod 100 < {LOSS} counter drop
          }}
        }}""")


class Campaign:
    def __init__(self, options, folder, is_private):
        self.options, self.folder = options, folder
        os.mkdir(os.path.join(folder, "nodes"))
        self.nodes = nats.cluster(os.path.join(folder, "nodes"), options.nodes, options.nats) if options.nodes > 1 \
            else [nats.NatsServer(os.path.join(folder, "nodes"), program=options.nats)]
        self.sites, self.windows, self.lossy, self.said = [], {}, [], []
        self.not_drained = []  # texts
        self.is_private = is_private

    def start(self):
        for node in self.nodes:
            node.start()
        options = self.options
        more = f"send: {{ late-after: {10 if options.minutes >= 5 else 3}s }}\n" + options.lines.replace("\\n", "\n")
        for number in range(options.sites):
            uplink = Uplink(self.nodes, 0 if number % 2 else ROUND_TRIP)
            self.sites.append(Site(options.bin, self.folder, f"site-{number}", options.channels, uplink, more, 3 if options.nodes > 2 else 1,
                                   options.stores))
        self.lossy = self.sites[2::4] if self.is_private else []
        if self.lossy:
            lose_packets([port for site in self.lossy for port in site.uplink.ports])
        for site in self.sites:
            site.start_forwarder()
        for site in self.sites:
            site.wait_until_connected()
            site.start_bridge()
            self.windows[site] = []
        time.sleep(REJOIN)
        for site in self.sites:
            self.windows[site].append(Window(0, time.time_ns(), STARTING))

    def run(self):
        """Injects the faults; returns when the time has elapsed and all is repaired."""
        began, seconds = time.monotonic(), self.options.minutes * 60
        events = []
        for number, fault in enumerate(schedule(self.options.seed, seconds, len(self.sites), len(self.nodes))):
            heapq.heappush(events, (fault.at, 2 * number, fault, self.inject))
            heapq.heappush(events, (fault.end, 2 * number + 1, fault, self.repair))
        measure_at = 0.0
        while (now := time.monotonic() - began) < seconds:
            if events and events[0][0] <= now:
                at, _, fault, action = heapq.heappop(events)
                action(fault, at)
            elif now >= measure_at:
                for site in self.sites:
                    site.measure()
                measure_at = now + MEASURE
            else:
                time.sleep(0.05)

    def say(self, at, text):
        self.said.append(f"  {at:7.1f} s  {text}")
        print(self.said[-1], file=sys.stderr, flush=True)

    def inject(self, fault, at):
        now = time.time_ns()
        if fault.kind == NODE:
            self.nodes[fault.target].kill()
            self.say(at, f"node-{fault.target} killed for {fault.down} s")
            return
        site = self.sites[fault.target]
        if fault.kind == CUT:
            site.uplink.cut()
        else:
            before, reason, kill, is_bridge = UNSENT, BRIDGE_ENDED, site.kill_bridge, True
            if fault.kind == FORWARDER:
                before, reason, kill, is_bridge = UNCOMMITTED, NOT_RUNNING, site.kill_forwarder, False
            kill()
            self.windows[site].append(Window(now - int(before * 1e9), now + 10 ** 18, reason,  # until repair() sets its end
                                             unless_stored=self.options.backfill, loses_stored=is_bridge))
        self.say(at, f"{site.name}: {fault.kind} {'for' if fault.kind == CUT else 'killed for'} {fault.down} s")

    def repair(self, fault, _):
        if fault.kind == NODE:
            self.nodes[fault.target].start()
            return
        site = self.sites[fault.target]
        if fault.kind == CUT:
            site.uplink.join()
            return
        (site.start_forwarder if fault.kind == FORWARDER else site.start_bridge)()
        self.windows[site][-1].end = time.time_ns() + int(REJOIN * 1e9)

    def finish(self):
        """Waits until the gaps are filled, ends the bridges, waits until every forwarder has sent its queue, and ends them."""
        if self.options.backfill:
            end = time.monotonic() + FILL_SECONDS
            while any(site.open_gaps() for site in self.sites) and time.monotonic() < end:
                time.sleep(1)
        for site in self.sites:
            self.windows[site].append(Window(time.time_ns() - int(UNSENT * 1e9), time.time_ns() + 10 ** 18, BRIDGE_ENDED))
            site.stop_bridge()
        time.sleep(GATHER + 1)
        end, left = time.monotonic() + DRAIN_SECONDS, self.sites
        while left and time.monotonic() < end:
            waiting = [site for site in left if not site.is_empty()]
            time.sleep(1)
            left = [site for site in left if site in waiting or not site.is_empty()]
        self.not_drained = [f"{site.name}: {site.log()[-500:]}" for site in left]

    def messages(self, stream):
        """The messages of a stream, when it has a leader."""
        def has_leader():
            try:
                with nats.NatsClient(self.nodes[0].port) as client:
                    return client.request(f"$JS.API.STREAM.INFO.{stream}")
            except (Failure, OSError):
                return None
        wait_until(has_leader, 60, f"{stream} has no leader")
        with nats.NatsClient(self.nodes[0].port, 60) as client:
            yield from client.pages(stream)

    def check(self):
        """{site: (its result, violations)}, number of messages, bytes of samples in them."""
        catalogues = {}
        for message in self.messages("KV_fieldcast-catalogue"):
            site, _, _, identity = message.subject.split(".")[2:]
            catalogues[site, int(identity, 16)] = [int(name.rpartition("-")[2]) for name in catalogue_channels(message.data)]
        checkers = {site.name: Checker() for site in self.sites}
        for site in self.sites:
            for (channel, epoch), times in site.published().items():
                checkers[site.name].publish(channel, epoch, times)
            if self.options.stores:
                self.compare_store(site, checkers[site.name])
        count = size = 0
        for message in self.messages("FIELDCAST"):
            count, size = count + 1, size + len(message.data)
            kind, site, _, _ = map(name_of, message.subject.split("."))
            self.check_batch(checkers[site], Batch(message.data), catalogues, site, kind == "fieldcast-late")
        windows = {site.name: self.expected_windows(site) for site in self.sites}
        refills = {site.name: [window for window in self.windows[site] if self.options.backfill and window.reason == NOT_RUNNING]
                   for site in self.sites}
        return {name: checker.result(windows[name], refills[name]) for name, checker in checkers.items()}, count, size

    def expected_windows(self, site):
        return [window for window in self.windows[site] if not (self.options.backfill and window.reason == NOT_RUNNING)]

    @staticmethod
    def compare_store(site, checker):
        for channel, epoch, rows in site.stored():
            checker.store(channel, epoch, [(sequence, at) for sequence, at, _ in rows])
            # The values of one sample in sixteen.
            for sequence, _, value in rows[::16]:
                if value != measured(channel, sequence):
                    checker.wrong_in_store(channel, epoch, sequence)

    @staticmethod
    def check_batch(checker, batch, catalogues, site, late):
        names, values, at = catalogues[site, batch.catalogue], batch.numbers(), 0
        for index, count in batch.channels:
            channel, part = names[index], slice(at, at + count)
            checker.arrive(channel, batch.epoch, batch.sequences[part], batch.times[part], late)
            # The value of one sample of each channel in a message.
            if values is None or values[at] != measured(channel, batch.sequences[at]):
                checker.wrong(channel, batch.epoch, batch.sequences[at])
            at += count

    def report(self, results, count, size):
        """Prints the report; returns the number of violated rules and sites."""
        options = self.options
        print(f"fieldcast-forward, fault campaign: {options.minutes:g} min, {options.sites} sites of {options.channels} channels x 1 s, "
              f"{options.nodes} node(s), seed {options.seed}")
        print(f"round trip of {1000 * ROUND_TRIP:.0f} ms: {len(self.sites[::2])} sites; loss of {LOSS} % in each direction: " +
              (f"{len(self.lossy)} sites" if self.is_private else "not possible, needs root"))
        print("faults:", *self.said, sep="\n")
        print("site        published    arrived       late duplicates  excused missing reordered unknown  backlog  memory")
        failed = len(self.not_drained)
        for site in self.sites:
            result = results[site.name]
            failed += bool(result.violations())
            print(f"{site.name:10} {result.published:10} {result.arrived:10} {result.late:10} {result.duplicates:10} "
                  f"{sum(result.excused.values()):8} {len(result.missing):7} {len(result.reordered):9} {len(result.unknown):7} "
                  f"{max(site.backlogs(), default=0):8} {site.memory / 1e6:4.0f} MB")
            for text, number, examples in result.violations():
                print(f"  VIOLATION: {number} samples {text}, for example {examples}")
        for text in self.not_drained:
            print("VIOLATION: a queue is not empty at the end: " + text)
        total = list(results.values())
        excused = {reason: sum(result.excused[reason] for result in total) for reason in (STARTING, NOT_RUNNING, BRIDGE_ENDED)}
        print(f"all: {sum(result.published for result in total)} published, {sum(result.arrived for result in total)} arrived "
              f"({sum(result.late for result in total)} late), {sum(result.duplicates for result in total)} duplicates removed, "
              f"{sum(len(result.missing) for result in total)} missing, {sum(len(result.reordered) for result in total)} out of order, "
              f"{sum(result.refilled for result in total)} fetched late behind newer late ones")
        print("excused: " + ", ".join(f"{number} while {reason}" for reason, number in excused.items()))
        if options.stores:
            print(f"stores of the bridges: {sum(result.stored for result in total)} samples, {sum(len(result.not_stored) for result in total)} arrived "
                  f"but not stored, {sum(len(result.stored_wrong) for result in total)} wrong")
        print(f"{count} messages, {size / max(1, sum(result.arrived for result in total)):.2f} bytes of payload a sample; memory of the nodes "
              + ", ".join(f"{memory_of(node.process) / 1e6:.0f} MB" for node in self.nodes)
              + f"; disk of a node {folder_bytes(self.nodes[0].folder) / 1e6:.1f} MB")
        print("in order" if not failed else "NOT in order")
        return failed

    def close(self):
        for site in self.sites:
            site.close()
        for node in self.nodes:
            node.kill()


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--minutes", type=float, default=1)
    for name, default in [("sites", 3), ("channels", 50), ("seed", 1), ("nodes", 3)]:
        parser.add_argument("--" + name, type=int, default=default)
    parser.add_argument("--folder")
    parser.add_argument("--stores", action="store_true")
    parser.add_argument("--backfill", action="store_true")
    parser.add_argument("--lines", default="")
    parser.add_argument("--nats", default=nats.PROGRAM or "", help="the program nats-server")
    options = parser.parse_args(arguments)
    options.stores |= options.backfill
    return options


def main():
    options = options_of(sys.argv[1:])
    if not os.path.exists(options.nats):
        print("no nats-server here; tools/install.sh test brings it")
        return 77
    is_private = os.geteuid() == 0
    if is_private:
        networks.enter(own_run=False)
        subprocess.run(["mount", "-t", "tmpfs", "shm", "/dev/shm"], check=True)  # killed participants leave files there
    folder = options.folder or tempfile.mkdtemp(prefix="fieldcast-forward-campaign-")
    os.makedirs(folder, exist_ok=True)
    campaign = Campaign(options, folder, is_private)
    try:
        campaign.start()
        campaign.run()
        campaign.finish()
        results, count, size = campaign.check()
        return 1 if campaign.report(results, count, size) else 0
    finally:
        campaign.close()
        if not options.folder:
            shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
