"""Draws the faults of the campaign of fieldcast-forward from a seed. Pure."""

import dataclasses
import random

NODE, FORWARDER, BRIDGE, CUT = "node", "forwarder", "bridge", "cut"
APART = 10  # seconds between the faults of one site, and from the restart of a node to the next kill
CUT_SHARE = 1 / 3  # of the time
FIRST = 0.05  # part of the time before the first fault
LAST = 0.8  # part of the time until the last fault has ended
TRIES = 200


@dataclasses.dataclass(frozen=True, order=True)
class Fault:
    """`at`: seconds from the start; `down`: how long until it is repaired. `target`: number of a node or site."""
    at: float
    kind: str
    target: int
    down: float

    @property
    def end(self):
        return self.at + self.down


def schedule(seed, seconds, sites, nodes):
    """Faults in the order of their times: one common cut of half of the sites, kills of nodes one after the other, and kills of
    forwarders and bridges, also of sites that are cut."""
    draw = random.Random(seed)
    begin, end = seconds * FIRST, seconds * LAST
    faults = []
    cut_at = round(draw.uniform(begin, begin + (end - begin - seconds * CUT_SHARE) / 2), 1)
    for site in sorted(draw.sample(range(sites), max(1, sites // 2))):
        faults.append(Fault(cut_at, CUT, site, round(seconds * CUT_SHARE, 1)))
    faults += _of_nodes(draw, begin, end, nodes)
    kills = max(1, round(sites * seconds / 1200))
    for kind in (FORWARDER, BRIDGE):
        for _ in range(kills):
            fault = _of_a_site(draw, kind, begin, end, sites, faults)
            if fault:
                faults.append(fault)
    return sorted(faults)


def _of_nodes(draw, begin, end, nodes):
    if nodes < 2:
        return []
    faults, at = [], begin + draw.uniform(0, 0.1) * (end - begin)
    pause = max(APART, (end - begin) / 10)
    while True:
        down = min(draw.uniform(3, 20), (end - begin) / 6)
        if at + down > end:
            return faults
        faults.append(Fault(round(at, 1), NODE, draw.randrange(nodes), round(down, 1)))
        at += down + draw.uniform(pause + 0.2, 2 * pause)


def _of_a_site(draw, kind, begin, end, sites, others):
    """A kill that is not near to another kill of its site; None if there is no time left for it."""
    for _ in range(TRIES):
        fault = Fault(round(draw.uniform(begin, end - 5), 1), kind, draw.randrange(sites), round(draw.uniform(0.5, 4), 1))
        mine = [other for other in others if other.target == fault.target and other.kind in (FORWARDER, BRIDGE)]
        if all(fault.at > other.end + APART or fault.end < other.at - APART for other in mine):
            return fault
    return None
