"""Runs simulated sites, their forwarders and a JetStream server until Ctrl-C, for trials by hand.

usage: run_sites.py N --bin BIN_DIR [--channels C] [--nodes 1] [--round-trip MS] [--seconds S] [--nats PROGRAM]
"""

import argparse
import os
import shutil
import signal
import sys
import tempfile
import time

import nats
from forward_sites import Site, Uplink
from plant import Failure

STATE_SECONDS = 10


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sites", type=int)
    parser.add_argument("--bin", required=True)
    for name, default in [("channels", 100), ("nodes", 1), ("round-trip", 0), ("seconds", 0)]:
        parser.add_argument("--" + name, type=int, default=default)
    parser.add_argument("--nats", default=nats.PROGRAM or "")
    options = parser.parse_args(arguments)
    if not 1 <= options.sites <= 80:
        parser.error("N is the number of sites, 1 to 80: each needs a DDS domain of its own")
    return options


def start(options, folder, sites, nodes):
    os.mkdir(os.path.join(folder, "nodes"))
    nodes += nats.cluster(os.path.join(folder, "nodes"), options.nodes, options.nats) if options.nodes > 1 \
        else [nats.NatsServer(os.path.join(folder, "nodes"), program=options.nats)]
    for node in nodes:
        node.start()
    print("JetStream: " + ", ".join(f"nats://127.0.0.1:{node.port}" for node in nodes), flush=True)
    for number in range(1, options.sites + 1):
        uplink = Uplink(nodes, options.round_trip / 1000 if options.round_trip else None)
        sites.append(Site(options.bin, folder, f"site-{number}", options.channels, uplink, replicas=3 if options.nodes > 2 else 1))
    print(f"files: {folder}\n\nsite      DDS domain  channels  bridge  forwarder")
    for site in sites:
        site.start_forwarder()
        site.start_bridge()
        print(f"{site.name:10}{site.domain:10}{site.channels:10}{site.bridge.pid:8}{site.forwarder.pid:11}", flush=True)
    print(f"\n{options.sites * options.channels} samples a second. One site: {options.bin}/fieldcast watch --domain {sites[0].domain}. Ctrl-C ends it.",
          flush=True)


def run(options, sites, nodes):
    """Prints the state until the time has elapsed; returns 0 if every site's samples are in the stream."""
    end = time.monotonic() + options.seconds if options.seconds else float("inf")
    while (now := time.monotonic()) < end:
        time.sleep(min(STATE_SECONDS, end - now))
        print(state(sites, nodes), flush=True)
    return 0 if subjects(nodes) >= len(sites) else 1


def state(sites, nodes):
    for site in sites:
        site.measure()
    waiting = [site.backlogs()[-1] if site.backlogs() else 0 for site in sites]
    try:
        with nats.NatsClient(nodes[0].port) as client:
            found = client.request("$JS.API.STREAM.INFO.FIELDCAST")["state"]
            text = f"{found['messages']} messages, {found['bytes'] / 1e6:.1f} MB in the stream"
    except (Failure, OSError) as failure:
        text = str(failure)
    return f"{text}; {sum(waiting)} wait at the sites, at most {max(waiting)} at one"


def subjects(nodes):
    """The number of sites with samples in the stream."""
    with nats.NatsClient(nodes[0].port) as client:
        found = client.request("$JS.API.STREAM.INFO.FIELDCAST", {"subjects_filter": "fieldcast.>"})["state"]
    return len({subject.split(".")[1] for subject in found.get("subjects", ())})


def main():
    options = options_of(sys.argv[1:])
    if not os.path.exists(options.nats):
        print("no nats-server here; tools/install.sh test brings it")
        return 77
    for number in (signal.SIGINT, signal.SIGTERM):  # a shell starts jobs in the background with SIGINT ignored
        signal.signal(number, signal.default_int_handler)
    folder, sites, nodes = tempfile.mkdtemp(prefix="fieldcast-sites-"), [], []
    try:
        start(options, folder, sites, nodes)
        return run(options, sites, nodes)
    except KeyboardInterrupt:
        return 130
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        for site in sites:
            site.close()
        for node in nodes:
            node.kill()
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
