"""A host application of Sparkplug B for tests. It decodes protobuf by itself, with the field numbers of the specification, and so shares
no code with the forwarder. sparkplug_decoder.mjs is a second decoder, of the project Eclipse Tahu.

Eclipse Sparkplug Specification 3.0.0, 6.4.1
"""

import collections
import struct

INT32, INT64, DOUBLE = 3, 4, 10


def fields(data):
    """[(number, value)] of a protobuf message; values are whole numbers or bytes."""
    found, at = [], 0

    def varint():
        nonlocal at
        number = shift = 0
        while True:
            byte = data[at]
            at += 1
            number |= (byte & 0x7F) << shift
            if byte < 0x80:
                return number
            shift += 7
    while at < len(data):
        key = varint()
        kind = key & 7
        if kind == 0:
            value = varint()
        else:
            size = {1: 8, 5: 4}.get(kind) or varint()
            value = data[at:at + size]
            at += size
        found.append((key >> 3, value))
    return found


def all_of(data, number):
    return [value for name, value in fields(data) if name == number]


def first(data, number, default=None):
    return next(iter(all_of(data, number)), default)


class Metric:
    def __init__(self, data, types):
        name, alias = first(data, 1), first(data, 2)
        self.name, self.alias, self.timestamp, self.datatype = name and name.decode(), alias, first(data, 3), first(data, 4)
        self.is_historical, self.is_null = bool(first(data, 5, 0)), bool(first(data, 7, 0))
        datatype = self.datatype or types.get(alias)
        self.properties = {}
        if (properties := first(data, 9)) is not None:
            for key, value in zip(all_of(properties, 1), all_of(properties, 2), strict=True):
                self.properties[key.decode()] = self._property(value)
        # Without its birth, the type of a metric is unknown.
        self.value = None if self.is_null or datatype is None else self._value(data, datatype)

    @staticmethod
    def _property(data):
        values = [(number, value) for number, value in fields(data) if number not in (1, 2)]
        (number, value), = values
        return {3: lambda: value, 6: lambda: struct.unpack("<d", value)[0], 7: lambda: bool(value), 8: lambda: value.decode()}[number]()

    @staticmethod
    def _value(data, datatype):
        (number, value), = [(number, value) for number, value in fields(data) if 10 <= number <= 15]
        # The field that belongs to the data type.
        wanted = {1: 10, 2: 10, 3: 10, 4: 11, 5: 10, 6: 10, 7: 10, 8: 11, 9: 12, 10: 13, 11: 14, 12: 15}[datatype]
        if number != wanted:
            raise AssertionError(f"field {number} for the data type {datatype}")
        if datatype in (1, 2, 3):
            return value - 2**32 if value >= 2**31 else value
        if datatype == INT64:
            return value - 2**64 if value >= 2**63 else value
        if datatype == 9:
            return struct.unpack("<f", value)[0]
        if datatype == DOUBLE:
            return struct.unpack("<d", value)[0]
        if datatype == 11:
            return bool(value)
        return value.decode() if datatype == 12 else value


class Payload:
    def __init__(self, data, types):
        self.timestamp, self.seq = first(data, 1), first(data, 3)
        self.metrics = [Metric(metric, types) for metric in all_of(data, 2)]


Sample = collections.namedtuple("Sample", "device name timestamp value quality is_historical")


class Host:
    """Follows one edge node. `faults`: what a host would answer with a request for a rebirth."""

    def __init__(self):
        self.samples, self.faults, self.order = [], [], []
        self.births, self.names, self.types = {}, {}, {}
        self.bd_seq = self.seq = None
        self.online = False
        self.quality = {}

    def on_message(self, topic, data):
        _, _, kind, *rest = topic.split("/")
        if kind in ("NCMD", "DCMD") or "STATE" in topic:
            return
        device = rest[1] if len(rest) > 1 else None
        payload = Payload(data, self.types)
        self.order.append((kind, device, payload))
        getattr(self, "_" + kind.lower())(device, payload)

    def _count(self, kind, payload):
        if payload.seq != (self.seq + 1) % 256 if self.seq is not None else True:
            self.faults.append(f"{kind} with seq {payload.seq} after {self.seq}")
        self.seq = payload.seq

    def _nbirth(self, _, payload):
        metrics = {metric.name: metric for metric in payload.metrics}
        self.bd_seq, self.seq, self.online, self.births = metrics["bdSeq"].value, payload.seq, True, {}
        self.names = {}  # a restarted node may assign other aliases
        if payload.seq != 0 or metrics["Node Control/Rebirth"].value is not False or metrics["Node Control/Rebirth"].alias is not None:
            self.faults.append("a wrong NBIRTH")

    def _ndeath(self, _, payload):
        if payload.seq is not None or [metric.name for metric in payload.metrics] != ["bdSeq"]:
            self.faults.append("a wrong NDEATH")
        if payload.metrics[0].value == self.bd_seq:
            self.online, self.births = False, {}

    def _dbirth(self, device, payload):
        self._count("DBIRTH", payload)
        self.births[device] = {metric.name: metric for metric in payload.metrics}
        for metric in payload.metrics:
            other = self.names.setdefault(metric.alias, (device, metric.name))
            if other != (device, metric.name):
                self.faults.append(f"alias {metric.alias} of {other} and {device} {metric.name}")
            self.types[metric.alias] = metric.datatype
            self.quality[metric.alias] = metric.properties.get("Quality", 192)

    def _ddeath(self, device, payload):
        self._count("DDEATH", payload)
        self.births.pop(device, None)

    def _ddata(self, device, payload):
        self._count("DDATA", payload)
        if not self.online or device not in self.births:
            self.faults.append(f"DDATA of {device} without a birth")
        times = [metric.timestamp for metric in payload.metrics if not metric.is_historical]
        if times != sorted(times):
            self.faults.append("metrics that are not in the order of time")
        for metric in payload.metrics:
            if metric.name is not None or metric.datatype is not None:
                self.faults.append("DDATA with a name or a data type")
            if metric.alias not in self.names:
                self.faults.append(f"the unknown alias {metric.alias}")
                continue
            quality = metric.properties.get("Quality", 192)
            if not metric.is_historical:
                if "Quality" not in metric.properties and self.quality.get(metric.alias) != 192:
                    self.faults.append("a quality that is good again is not sent")
                self.quality[metric.alias] = quality
            owner, name = self.names[metric.alias]
            self.samples.append(Sample(owner, name, metric.timestamp, metric.value, quality, metric.is_historical))


def varint(number):
    encoded = b""
    while number > 0x7F:
        encoded += bytes([number & 0x7F | 0x80])
        number >>= 7
    return encoded + bytes([number])


def device_command(alias, value, at_ms):
    """The payload of DCMD that writes a whole number by an alias."""
    metric = b"\x10" + varint(alias) + b"\x20" + varint(INT32) + b"\x50" + varint(value % 2**32)
    return b"\x08" + varint(at_ms) + b"\x12" + varint(len(metric)) + metric


def rebirth_request():
    """The payload of NCMD with Node Control/Rebirth = true."""
    name = b"Node Control/Rebirth"
    metric = b"\x0a" + bytes([len(name)]) + name + b"\x20\x0b" + b"\x70\x01"
    return b"\x08\x80\xe8\x92\xa6\x87\x33" + b"\x12" + bytes([len(metric)]) + metric
