#!/usr/bin/env python3
"""Measures what a JetStream node needs for messages like those of fieldcast-forward: processor, disk and memory.

usage: tools/bench/ingest_bench.py [--nodes 1] [--bytes 1040] [--samples 150] [--subjects 1000] [--flight 256] [--seconds 10] [--rate 0]
                                   [--connects 0] [--tls]

Publishes messages of --bytes random bytes, which stand for --samples samples, with message ids, round-robin to --subjects subjects of a stream
with one replica for each node, and waits for acknowledgements with --flight messages in flight. --rate: messages a second; 0: as many as
possible, which also measures this program. Prints processor seconds of each node for 1 000 messages, the bytes of the stream on the disk for a
message, and the memory of the nodes. --connects: measures processor time of new connections instead, with --tls by certificates of ECDSA P-256.
"""

import argparse
import os
import ssl
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
from forward_sites import folder_bytes, memory_of  # noqa: E402
from nats import NatsClient, NatsServer, cluster  # noqa: E402
from plant import Failure, wait_until  # noqa: E402

TICKS = os.sysconf("SC_CLK_TCK")


def run_seconds(process):
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def create(node, replicas):
    def created():
        try:
            with NatsClient(node.port, 5) as client:
                return client.request("$JS.API.STREAM.CREATE.FIELDCAST", {
                    "name": "FIELDCAST", "subjects": ["fieldcast.>"], "num_replicas": replicas, "duplicate_window": 600_000_000_000})
        except (Failure, OSError):
            return None
    wait_until(created, 30, "the stream cannot be created")


def publish(options, node):
    """Returns (acknowledged messages, seconds)."""
    with NatsClient(node.port) as client:
        client.subscribe("ack.>")
        data = [os.urandom(options.bytes) for _ in range(64)]
        begin, sent, done = time.monotonic(), 0, 0
        while (now := time.monotonic() - begin) < options.seconds or done < sent:
            allowed = int(now * options.rate) if options.rate else sys.maxsize
            parts = []
            while sent - done < options.flight and sent < allowed and now < options.seconds:
                head = f"NATS/1.0\r\nNats-Msg-Id: site-{sent % options.subjects}/bus-0/18b1f2c3d4e5f607/{sent:016x}\r\n\r\n"
                body = data[sent % 64]
                line = f"HPUB fieldcast.site-{sent % options.subjects}.bus-0.unit-0 ack.{sent} {len(head)} {len(head) + len(body)}\r\n"
                parts.append((line + head).encode() + body + b"\r\n")
                sent += 1
            if parts:
                client.send(b"".join(parts))
            if done < sent:
                for _ in range(max(1, (sent - done) // 2)):
                    if b'"error"' in client.receive().data:
                        raise Failure("a message was refused")
                    done += 1
            else:
                time.sleep(0.001)
        return done, time.monotonic() - begin


def connect(options, node, folder):
    """Processor seconds of the node for one connection."""
    before = run_seconds(node.process)
    for _ in range(options.connects):
        if options.tls:
            context = ssl.create_default_context(cafile=os.path.join(folder, "ca.pem"))
            context.check_hostname = False
            context.load_cert_chain(os.path.join(folder, "ca.pem"), os.path.join(folder, "ca.key"))
            NatsClient(node.port, tls=context).close()
        else:
            NatsClient(node.port).close()
    return (run_seconds(node.process) - before) / options.connects


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in [("nodes", 1), ("bytes", 1040), ("samples", 150), ("subjects", 1000), ("flight", 256), ("seconds", 10), ("rate", 0),
                          ("connects", 0)]:
        parser.add_argument("--" + name, type=int, default=default)
    parser.add_argument("--tls", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="fieldcast-ingest-") as folder:
        more = ""
        if options.tls:
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2",
                            "-subj", "/CN=ca", "-keyout", "ca.key", "-out", "ca.pem"], check=True, capture_output=True, cwd=folder)
            more = f'tls {{ cert_file: "{folder}/ca.pem", key_file: "{folder}/ca.key", ca_file: "{folder}/ca.pem", verify: true }}'
        nodes = cluster(folder, options.nodes) if options.nodes > 1 else [NatsServer(folder, more)]
        try:
            for node in nodes:
                node.start()
            if options.connects:
                print(f"{1e6 * connect(options, nodes[0], folder):.0f} us of processor for a connection{' with TLS' if options.tls else ''}")
                return
            create(nodes[0], options.nodes)
            print("memory before: " + ", ".join(f"{memory_of(node.process) / 1e6:.0f} MB" for node in nodes))
            before = [run_seconds(node.process) for node in nodes]
            count, seconds = publish(options, nodes[0])
            used = [run_seconds(node.process) - start for node, start in zip(nodes, before)]
            time.sleep(1)
            with NatsClient(nodes[0].port) as client:
                stream = client.request("$JS.API.STREAM.INFO.FIELDCAST")["state"]
            print(f"{count / seconds:.0f} messages a second ({count * options.samples / seconds / 1e6:.2f} million samples), "
                  f"{stream['messages']} stored; "
                  f"processor of the nodes: {', '.join(f'{1e6 * number / count:.0f}' for number in used)} us a message, "
                  f"{sum(used) / seconds:.2f} cores; disk of a node: {folder_bytes(nodes[0].folder) / count:.0f} bytes a message "
                  f"({folder_bytes(nodes[0].folder) / count / options.samples:.2f} a sample); memory "
                  f"{', '.join(f'{memory_of(node.process) / 1e6:.0f} MB' for node in nodes)}")
        finally:
            for node in nodes:
                node.kill()


if __name__ == "__main__":
    main()
