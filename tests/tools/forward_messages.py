"""Decodes the messages of fieldcast-forward without generated code, for checks that share nothing with the product.

https://protobuf.dev/programming-guides/encoding/ and tools/forward/payload/forward.proto, version 1.
"""

import itertools
import struct

VARINT, FIXED64, LENGTH, FIXED32 = 0, 1, 2, 5
BOOLEAN, INTEGER, NATURAL, REAL, SINGLE, TEXT = range(6)


class Malformed(ValueError):
    pass


def fields(data):
    """Yields (number, value) of each field; the value is an integer, or bytes."""
    at = 0
    while at < len(data):
        tag, at = varint(data, at)
        number, kind = tag >> 3, tag & 7
        if kind == VARINT:
            value, at = varint(data, at)
        elif kind == FIXED64:
            value, at = int.from_bytes(data[at:at + 8], "little"), at + 8
        elif kind == FIXED32:
            value, at = int.from_bytes(data[at:at + 4], "little"), at + 4
        elif kind == LENGTH:
            length, at = varint(data, at)
            value, at = data[at:at + length], at + length
            if len(value) != length:
                raise Malformed("a field is longer than the message")
        else:
            raise Malformed(f"wire type {kind}")
        yield number, value


def varint(data, at):
    number = shift = 0
    while True:
        if at >= len(data):
            raise Malformed("the message ends within a number")
        byte = data[at]
        at += 1
        number |= (byte & 127) << shift
        if byte < 128:
            return number, at
        shift += 7


def varints(data):
    """All numbers of a packed column."""
    if data.isascii():
        return list(data)  # one byte each
    numbers, number, shift = [], 0, 0
    for byte in data:
        number |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(number)
            number = shift = 0
    if shift:
        raise Malformed("a column ends within a number")
    return numbers


def signed(numbers):
    return [(number >> 1) ^ -(number & 1) for number in numbers]


class Batch:
    """`channels`: [(index, number of samples)]. `sequences` and `times` (ns): one item for each sample, channel by channel."""

    def __init__(self, data):
        columns = {}
        for number, value in fields(data):
            columns[number] = columns.get(number, b"") + value if isinstance(value, bytes) and number != 15 else value
        if columns.get(1) != 1:
            raise Malformed(f"schema {columns.get(1)}")
        self.epoch, self.catalogue, self.columns = columns.get(2, 0), columns.get(3, 0), columns
        indices, at = [], 0
        pairs = varints(columns.get(4, b""))
        for skipped, present in zip(pairs[::2], pairs[1::2]):
            indices.extend(range(at + skipped, at + skipped + present))
            at += skipped + present
        counts = varints(columns.get(5, b"")) or [1] * len(indices)
        if len(counts) != len(indices):
            raise Malformed(f"{len(indices)} channels, but {len(counts)} counts")
        self.channels = list(zip(indices, counts))
        self.sequences = list(itertools.accumulate(signed(varints(columns.get(6, b"")))))
        instants = list(itertools.accumulate(signed(varints(columns.get(7, b"")))))
        self.times = [instants[index] for index in itertools.accumulate(signed(varints(columns.get(8, b""))))]
        if not sum(counts) == len(self.sequences) == len(self.times):
            raise Malformed(f"{sum(counts)} samples, {len(self.sequences)} sequences, {len(self.times)} times")

    def numbers(self):
        """The values of a batch that consists of 32- and 64-bit floating-point numbers only; None for another batch."""
        kinds = varints(self.columns.get(9, b""))
        columns = {REAL: struct.iter_unpack("<d", self.columns.get(13, b"")), SINGLE: struct.iter_unpack("<f", self.columns.get(14, b""))}
        values = []
        for kind, count in zip(kinds[::2], kinds[1::2]):
            if kind not in columns:
                return None
            values.extend(value for (value,) in itertools.islice(columns[kind], count))
        return values


def catalogue_channels(data):
    """The names of the channels of a Catalogue, by index."""
    return [next(value for number, value in fields(channel) if number == 1).decode()
            for number, channel in fields(data) if number == 6]


def name_of(token):
    """The name in a token of a subject, where `=2E` is a dot."""
    parts = token.split("=")
    return parts[0] + "".join(chr(int(part[:2], 16)) + part[2:] for part in parts[1:])
