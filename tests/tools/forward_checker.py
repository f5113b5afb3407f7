"""Compares what arrived in the stream with what was published. Pure: no files, sockets or clocks.

    checker = Checker()
    checker.publish("press/speed", 7, [100, 200, 300])       # times of the sequences 1, 2, 3 in epoch 7
    checker.arrive("press/speed", 7, [1, 2], [100, 200], late=False)
    checker.result([]).missing                               # [("press/speed", 7, 3)]

Rules: every published sample arrives; a repeated one, by channel, epoch and sequence, is counted and removed; within the live and
within the late samples of a channel, epoch and sequence ascend; nothing arrives that was not published, or with another time or value.
Late samples from a time in which the forwarder did not run are fetched afterwards: they may follow newer late ones, and are counted.
With the store of a bridge: it has every sample that arrived, each once, and nothing that was not published.
"""

import bisect
import collections

GAPS = 2  # of a channel within a window: one before and one after the last value, which a restarted reader receives
EXAMPLES = 5


class Window:
    """A time in which samples may be missing, and why. Times in nanoseconds since 1970, both included.

    `unless_stored`: only samples that are not in the store of the bridge may be missing. `loses_stored`: the store may lack samples too.
    """

    def __init__(self, begin, end, reason, unless_stored=False, loses_stored=False):
        self.begin, self.end, self.reason = begin, end, reason
        self.unless_stored, self.loses_stored = unless_stored, loses_stored

    def __repr__(self):
        return f"Window({self.begin}, {self.end}, {self.reason!r})"


class Result:
    def __init__(self):
        self.published = self.arrived = self.duplicates = self.late = self.stored = self.refilled = 0
        self.not_stored, self.stored_wrong = [], []  # arrived, but not in the store; in the store, but twice or not as published
        self.missing, self.reordered, self.unknown, self.scattered = [], [], [], []
        self.excused = collections.Counter()  # missing samples by the reason of their window

    def violations(self):
        """[(text, count, examples)] of broken rules."""
        found = [("missing", self.missing), ("out of order", self.reordered), ("not published, or with another time or value", self.unknown),
                 ("arrived, but not in the store of the bridge", self.not_stored),
                 ("in the store of the bridge twice, or not as published", self.stored_wrong), (f"more than {GAPS} gaps within one window", self.scattered)]
        return [(text, len(places), places[:EXAMPLES]) for text, places in found if places]


class Checker:
    def __init__(self):
        self.times = {}  # (channel, epoch): times by sequence
        self.seen = {}  # (channel, epoch): a byte for each sequence
        self.kept = {}  # the same for the store of the bridge; empty: it has none
        self.last = {}  # (channel, late): the greatest (epoch, sequence) so far
        self.late_reordered = set()  # those of Result.reordered that were late
        self.gathered = Result()

    def publish(self, channel, epoch, times):
        """`times`: of the sequences 1, 2, ..; the list may grow until the first arrive()."""
        self.times[channel, epoch] = times

    def arrive(self, channel, epoch, sequences, times, late):
        """Samples in the order of the stream. `times`: of their acquisition."""
        result, key = self.gathered, (channel, epoch)
        published = self.times.get(key, ())
        seen = self.seen.get(key)
        if seen is None:
            seen = self.seen[key] = bytearray(len(published) + 1)
        last = self.last.get((channel, late), (0, 0))
        for sequence, at in zip(sequences, times):
            if not 0 < sequence <= len(published) or published[sequence - 1] != at:
                result.unknown.append((channel, epoch, sequence))
            elif seen[sequence]:
                result.duplicates += 1
            else:
                seen[sequence] = 1
                result.arrived += 1
                result.late += late
                if (epoch, sequence) < last:
                    result.reordered.append((channel, epoch, sequence))
                    if late:
                        self.late_reordered.add((channel, epoch, sequence))
                else:
                    last = (epoch, sequence)
        self.last[channel, late] = last

    def wrong(self, channel, epoch, sequence):
        """The value of this sample is not the published one."""
        self.gathered.unknown.append((channel, epoch, sequence))

    def store(self, channel, epoch, rows):
        """`rows`: (sequence, time of acquisition) of all samples of the channel and epoch in the store of the bridge."""
        result, published = self.gathered, self.times.get((channel, epoch), ())
        kept = self.kept[channel, epoch] = bytearray(len(published) + 1)
        for sequence, at in rows:
            if not 0 < sequence <= len(published) or published[sequence - 1] != at or kept[sequence]:
                result.stored_wrong.append((channel, epoch, sequence))
            else:
                kept[sequence] = 1
                result.stored += 1

    def wrong_in_store(self, channel, epoch, sequence):
        """The value of this sample in the store is not the published one."""
        self.gathered.stored_wrong.append((channel, epoch, sequence))

    def result(self, windows, refills=()):
        """The result so far; missing samples within `windows` are counted apart, and late ones that were fetched for `refills`."""
        result = self.gathered
        refilled = {place for place in self.late_reordered
                    if any(window.begin <= self.times[place[:2]][place[2] - 1] <= window.end for window in refills)}
        result.refilled += len(refilled)
        result.reordered = [place for place in result.reordered if place not in refilled]
        result.published = sum(len(times) for times in self.times.values())
        ordered = sorted(windows, key=lambda window: window.begin)
        gaps = collections.Counter()
        for key in sorted(self.times):
            times, seen = self.times[key], self.seen.get(key, b"")
            sequence = 1
            while sequence <= len(times):
                sequence = seen.find(0, sequence) if sequence < len(seen) else sequence
                if sequence < 0 or sequence > len(times):
                    break
                sequence = self._gap(key, times, seen, sequence, ordered, gaps)
        if self.kept:
            self._compare_store([window for window in ordered if window.loses_stored])
        result.scattered = [(channel, repr(window)) for (channel, window), count in gaps.items() if count > GAPS]
        return result

    def _compare_store(self, windows):
        for key in sorted(self.seen):
            times, kept = self.times.get(key, ()), self.kept.get(key, b"")
            for sequence, arrived in enumerate(self.seen[key]):
                if arrived and not (sequence < len(kept) and kept[sequence]):
                    at = times[sequence - 1]
                    if not any(window.begin <= at <= window.end for window in windows):
                        self.gathered.not_stored.append((*key, sequence))

    def _gap(self, key, times, seen, first, windows, gaps):
        """Adds the missing samples from `first` to the next one that arrived; returns the sequence after them."""
        touched, kept = set(), self.kept.get(key, b"")
        sequence = first
        while sequence <= len(times) and (sequence >= len(seen) or not seen[sequence]):
            at = times[sequence - 1]
            is_stored = sequence < len(kept) and kept[sequence]
            window = next((window for window in windows[:bisect.bisect_right(windows, at, key=lambda window: window.begin)]
                           if at <= window.end and not (is_stored and window.unless_stored)), None)
            if window is None:
                self.gathered.missing.append((*key, sequence))
            else:
                self.gathered.excused[window.reason] += 1
                touched.add(window)
            sequence += 1
        for window in touched:
            gaps[key[0], window] += 1
        return sequence
