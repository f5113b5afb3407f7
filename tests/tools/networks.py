"""Creates networks for a test: machines in namespaces, links between them, and a firewall. All are
removed when the test ends.

    networks.enter()                      # in main(): enters new namespaces, or exits with 77
    wire = Wire("far")                    # a machine "far" at 10.99.1.2; this one is 10.99.1.1
    wire.far.run("program", ..)           # runs it there

Needs root.
"""

import os
import subprocess
import sys

PRIVATE = "FIELDCAST_TEST_PRIVATE"  # set: this process is in namespaces of its own


def system(*command, stdin=None):
    subprocess.run(command, check=True, capture_output=True, input=stdin, text=True)


def enter(need="make networks of its own", own_run=True):
    """Runs this program again in new namespaces, by default with an empty /run; returns there."""
    if os.geteuid() != 0:
        print("only root can " + need)
        sys.exit(77)
    if PRIVATE not in os.environ:
        os.environ[PRIVATE] = "1"
        os.execvp("unshare", ["unshare", "--mount", "--net", "--pid", "--fork", "--mount-proc", "--kill-child", "--", sys.executable, *sys.argv])
    if own_run:
        system("mount", "-t", "tmpfs", "networks", "/run")
    system("ip", "link", "set", "lo", "up")


class Machine:
    """A machine with its own network; if `name` is None, the network of this process."""

    def __init__(self, name=None):
        self.name = name
        if name:
            system("ip", "netns", "add", name)
            self.run("ip", "link", "set", "lo", "up")

    def around(self, *command):
        return (["ip", "netns", "exec", self.name] if self.name else []) + list(command)

    def run(self, *command, stdin=None):
        system(*self.around(*command), stdin=stdin)

    def start(self, *command, **options):
        return subprocess.Popen(self.around(*command), **options)


HERE = Machine()


class Wire:
    """Links this machine, or `near`, to a new one: 10.99.NUMBER.1 and .2."""

    count = 0

    def __init__(self, name, near=HERE):
        Wire.count += 1
        self.near, self.far = near, Machine(name)
        self.device = f"to-{name}"
        self.near_address, self.far_address = f"10.99.{Wire.count}.1", f"10.99.{Wire.count}.2"
        back = f"from-{name}"
        near.run("ip", "link", "add", self.device, "type", "veth", "peer", "name", back, "netns", name)
        for machine, device, address in [(near, self.device, self.near_address), (self.far, back, self.far_address)]:
            machine.run("ip", "address", "add", f"{address}/24", "dev", device)
            machine.run("ip", "link", "set", device, "up")

    def cut(self, is_cut=True):
        """Drops packets in both directions, like a cable that is unplugged behind a switch."""
        if is_cut:
            self.near.run("nft", "-f", "-", stdin=f"""
                table netdev cut_{self.device} {{
                  chain in {{ type filter hook ingress device "{self.device}" priority 0; policy drop; }}
                  chain out {{ type filter hook egress device "{self.device}" priority 0; policy drop; }}
                }}""")
        else:
            self.near.run("nft", "delete", "table", "netdev", f"cut_{self.device}")

    def bytes(self):
        """Returns the byte counts (sent from this end, received here)."""
        out = subprocess.run(self.near.around("cat", "/proc/net/dev"), check=True, capture_output=True, text=True).stdout
        fields = next(text for text in out.splitlines() if text.strip().startswith(self.device + ":")).split(":")[1].split()
        return int(fields[8]), int(fields[0])


class Firewall:
    """Allows only TCP connections to one port of the inner machine."""

    def __init__(self, port):
        self.outside = Wire("firewall")
        self.machine = self.outside.far
        self.inside = Wire("inner", near=self.machine)
        self.inner = self.inside.far
        self.machine.run("sysctl", "-w", "net.ipv4.ip_forward=1")
        system("ip", "route", "add", "10.99.0.0/16", "via", self.outside.far_address)
        self.inner.run("ip", "route", "add", "10.99.0.0/16", "via", self.inside.near_address)
        self.machine.run("nft", "-f", "-", stdin=f"""
            table inet filter {{
              chain forward {{
                type filter hook forward priority 0; policy drop;
                ct state established,related accept
                ip daddr {self.inside.far_address} tcp dport {port} accept
                counter
              }}
            }}""")
