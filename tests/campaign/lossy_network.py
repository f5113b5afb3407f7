"""Hosts in separate network namespaces, connected by a switch that loses, doubles and delays frames and partitions the network.

    with LossyNetwork(["a", "b"], seed=1) as network:
        network.loss = 0.05
        network.cut({"a"})          # from all others
        network.run("a", [..])      # a process on that host: a subprocess.Popen
        network.address("a")        # "10.77.0.1"

The switch is this process: each host has a TAP device whose other end is read and written here, so no module of the kernel's traffic
control is needed. Only root may make namespaces; otherwise NotPermitted is raised. The context manager removes namespaces and devices.
"""

import ctypes
import fcntl
import heapq
import os
import random
import select
import struct
import subprocess
import threading
import time

TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 0x0002, 0x1000
CLONE_NEWNET = 0x40000000
MOST_WAITING = 20_000  # frames; further frames are lost


class NotPermitted(Exception):
    pass


def ip(*words):
    done = subprocess.run(["ip", *words], capture_output=True, text=True)
    if done.returncode != 0:
        raise NotPermitted(f"ip {' '.join(words)}: {done.stderr.strip()}")


class LossyNetwork:
    def __init__(self, hosts, seed):
        self.hosts, self.random = list(hosts), random.Random(seed)
        self.prefix = f"fc{os.getpid() % 100000}"
        self.loss = self.doubled = self.delayed = 0.0
        self.longest_delay = 0.03  # seconds, of a delayed frame
        self.isolated = set()  # hosts that reach only each other
        self.counts = {"frames": 0, "lost": 0, "doubled": 0, "delayed": 0, "cut": 0}
        self.taps, self.where, self.waiting, self.number = {}, {}, [], 0
        self.processes, self.over = [], threading.Event()

    def __enter__(self):
        try:
            for number, host in enumerate(self.hosts, 1):
                ip("netns", "add", self.namespace(host))
                self.taps[host] = self.make_tap(host)
                for words in (("link", "set", "lo", "up"), ("addr", "add", self.address(host) + "/24", "dev", "wire"),
                              ("link", "set", "wire", "up"), ("route", "add", "224.0.0.0/4", "dev", "wire")):
                    ip("-n", self.namespace(host), *words)
        except (NotPermitted, OSError) as reason:
            self.take_down()
            raise NotPermitted(str(reason)) from reason
        self.thread = threading.Thread(target=self.switch, daemon=True)
        self.thread.start()
        return self

    def __exit__(self, *_):
        for process in self.processes:
            if process.poll() is None:
                process.kill()
                process.wait()
        self.over.set()
        self.thread.join(5)
        self.take_down()

    def take_down(self):
        for tap in self.taps.values():
            os.close(tap)
        for host in self.hosts:
            subprocess.run(["ip", "netns", "del", self.namespace(host)], capture_output=True)

    def namespace(self, host):
        return f"{self.prefix}-{host}"

    def address(self, host):
        return f"10.77.{os.getpid() % 200}.{self.hosts.index(host) + 1}"

    def make_tap(self, host):
        """Makes the device `wire` in the host's namespace; this process keeps its descriptor."""
        libc = ctypes.CDLL(None, use_errno=True)
        with open("/proc/self/ns/net", encoding="utf-8") as home, open(f"/run/netns/{self.namespace(host)}", encoding="utf-8") as there:
            if libc.setns(there.fileno(), CLONE_NEWNET) != 0:
                raise OSError(ctypes.get_errno(), "setns")
            try:
                tap = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
                fcntl.ioctl(tap, TUNSETIFF, struct.pack("16sH", b"wire", IFF_TAP | IFF_NO_PI))
            finally:
                libc.setns(home.fileno(), CLONE_NEWNET)
        return tap

    def run(self, host, command, **options):
        process = subprocess.Popen(["ip", "netns", "exec", self.namespace(host), *command], **options)
        self.processes.append(process)
        return process

    def cut(self, hosts):
        self.isolated = set(hosts)

    def mend(self):
        self.isolated = set()

    def switch(self):
        hosts = {tap: host for host, tap in self.taps.items()}
        poll = select.epoll()
        for tap in hosts:
            poll.register(tap, select.EPOLLIN)
        while not self.over.is_set():
            timeout = 0.1
            if self.waiting:
                timeout = max(0.0, min(timeout, self.waiting[0][0] - time.monotonic()))
            for tap, _ in poll.poll(timeout):
                for _ in range(64):
                    try:
                        frame = os.read(tap, 2000)
                    except OSError:
                        break
                    self.pass_on(hosts[tap], frame)
            while self.waiting and self.waiting[0][0] <= time.monotonic():
                _, _, to, frame = heapq.heappop(self.waiting)
                self.deliver(to, frame)
        poll.close()

    def pass_on(self, sender, frame):
        self.counts["frames"] += 1
        self.where[frame[6:12]] = sender
        known = self.where.get(frame[0:6])
        for to in [known] if known else [host for host in self.hosts if host != sender]:
            if to == sender:
                continue
            if (to in self.isolated) != (sender in self.isolated):
                self.counts["cut"] += 1
                continue
            if self.random.random() < self.loss:
                self.counts["lost"] += 1
                continue
            times = 1
            if self.random.random() < self.doubled:
                times = 2
                self.counts["doubled"] += 1
            for _ in range(times):
                if self.random.random() < self.delayed and len(self.waiting) < MOST_WAITING:
                    self.counts["delayed"] += 1
                    self.number += 1
                    heapq.heappush(self.waiting, (time.monotonic() + self.random.uniform(0.001, self.longest_delay), self.number, to, frame))
                else:
                    self.deliver(to, frame)

    def deliver(self, to, frame):
        try:
            os.write(self.taps[to], frame)
        except OSError:
            self.counts["lost"] += 1
