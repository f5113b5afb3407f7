"""Prometheus with its receiver of remote write; the consumer is its query language over HTTP."""

import collections
import json
import os
import threading
import urllib.parse

from outlets.http_engine import HttpEngine

# bcrypt of outlets.RIGHT_PASSWORD, 5 rounds
HASH = "$2b$05$abcdefghijklmnopqrstuuZ0Fx87Pb/Aqb0E90lfvCwzXnaFKUHpS"


class Engine(HttpEngine):
    name = "prometheus"
    PACKAGE, PROGRAM, READY, PATH = "prometheus", "prometheus", "/-/ready", "/api/v1/write"

    def __init__(self, folder, port):
        super().__init__(folder, port)
        self.window = "30m"

    def start(self):
        for name, text in (("prometheus.yml", f"storage: {{ tsdb: {{ out_of_order_time_window: {self.window} }} }}\n"),
                           ("web.yml", f"basic_auth_users: {{ north: {HASH} }}\n")):
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        self.run(f"--config.file={self.folder}/prometheus.yml", f"--storage.tsdb.path={self.folder}/data",
                 f"--web.listen-address=127.0.0.1:{self.port}", f"--web.config.file={self.folder}/web.yml", "--web.enable-remote-write-receiver")

    def samples(self):
        """A sample is the values of one time in both series. The epoch is not there."""
        points = collections.defaultdict(dict)
        query = urllib.parse.quote('{__name__=~"fieldcast_(value|sequence)",bus="line"}[1h]')
        for series in json.loads(self.request(f"/api/v1/query?query={query}"))["data"]["result"]:
            labels = series["metric"]
            path = "/".join(labels[name] for name in ("bus", "device", "channel"))
            for at, value in series["values"]:
                points[path, at, labels["quality"]][labels["__name__"]] = float(value)
        return [(path, 0, int(point["fieldcast_sequence"]), point["fieldcast_value"], quality)
                for (path, _, quality), point in sorted(points.items()) if len(point) == 2]

    def refuse_one(self):
        """Late samples, which the server accepts only with a window for them."""
        self.stop()
        self.window = "0s"
        self.start()
        for seconds, call in ((6, self.pause), (10, self.resume)):
            timer = threading.Timer(seconds, call)
            timer.daemon = True
            timer.start()
        return "out of order sample"
