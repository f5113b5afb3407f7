"""VictoriaMetrics with the section `influxdb`; the consumer is its export over HTTP.

It keeps the last seconds in memory only, so a cut ends it in order.
"""

import collections
import json
import signal
import urllib.parse

import outlets
from outlets.http_engine import HttpEngine


class Engine(HttpEngine):
    name, section_name = "victoriametrics", "influxdb"
    precision = 1e-9  # it stores decimal numbers
    PACKAGE, PROGRAM, READY = "victoria-metrics", "victoria-metrics", "/health"

    def start(self):
        self.run(f"-storageDataPath={self.folder}/data", f"-httpListenAddr=127.0.0.1:{self.port}",
                 "-httpAuth.username=north", f"-httpAuth.password={outlets.RIGHT_PASSWORD}", "-dedup.minScrapeInterval=1ms")

    def stop(self):
        if self.server.process is not None and self.server.process.poll() is None:
            self.server.process.send_signal(signal.SIGTERM)
            self.server.process.wait(20)

    def samples(self):
        """A sample is the values of one time in its metrics."""
        points = collections.defaultdict(dict)
        match = urllib.parse.quote('{__name__=~"fieldcast_(value|epoch|sequence)"}')
        for line in self.request(f"/api/v1/export?match[]={match}").splitlines():
            series = json.loads(line)
            labels = series["metric"]
            path = "/".join(labels[name] for name in ("bus", "device", "channel"))
            for at, value in zip(series["timestamps"], series["values"]):
                points[path, at, labels["quality"]][labels["__name__"]] = value
        return [(path, point["fieldcast_epoch"], int(point["fieldcast_sequence"]), point["fieldcast_value"], quality)
                for (path, _, quality), point in sorted(points.items()) if len(point) == 3]
