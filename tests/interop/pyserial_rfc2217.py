"""A server of RFC 2217 by pyserial for one terminal and one client at a time.

usage: pyserial_rfc2217.py PORT DEVICE [FIXED_BAUD]     prints READY; FIXED_BAUD: the line keeps this rate
"""

import contextlib
import os
import select
import socket
import sys
import termios

import serial
import serial.rfc2217


class Terminal(serial.Serial):
    """A pseudo-terminal has no modem lines: they are on, and ignore what is set. It is always 8N, which glibc reports as a fault."""

    cts = dsr = cd = property(lambda _: True)
    ri = property(lambda _: False)
    fixed = None

    def _update_dtr_state(self):
        pass

    _update_rts_state = _update_break_state = _update_dtr_state

    def _reconfigure_port(self, *more, **named):
        with contextlib.suppress(termios.error):
            super()._reconfigure_port(*more, **named)

    @property
    def baudrate(self):
        return self.fixed or serial.Serial.baudrate.fget(self)

    @baudrate.setter
    def baudrate(self, value):
        serial.Serial.baudrate.fset(self, self.fixed or value)


class Connection:
    def __init__(self, peer):
        self.peer = peer

    def write(self, data):
        self.peer.sendall(data)


def serve(line, peer):
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    manager = serial.rfc2217.PortManager(line, Connection(peer))
    while True:
        for ready in select.select([peer, line.fd], [], [])[0]:
            if ready is peer:
                data = peer.recv(4096)
                if not data:
                    return
                line.write(b"".join(manager.filter(data)))
            else:
                peer.sendall(b"".join(manager.escape(os.read(line.fd, 4096))))


def main():
    port, device = int(sys.argv[1]), sys.argv[2]
    if len(sys.argv) > 3:
        Terminal.fixed = int(sys.argv[3])
    line = Terminal(device, timeout=0)
    with socket.create_server(("127.0.0.1", port)) as listener:
        print("READY", flush=True)
        while True:
            peer, _ = listener.accept()
            with peer:
                with contextlib.suppress(ConnectionError):
                    serve(line, peer)


if __name__ == "__main__":
    main()
