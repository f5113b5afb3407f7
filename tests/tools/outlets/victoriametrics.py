"""VictoriaMetrics with the section `influxdb`; the consumer is its export over HTTP.

It keeps the last seconds in memory only, so a cut ends it in order.
"""

import base64
import collections
import json
import os
import signal
import urllib.parse
import urllib.request

import outlets
from plant import wait_until


class Engine:
    name = "victoriametrics"
    has_unique_samples = True
    precision = 1e-9  # it stores decimal numbers
    keeps_order = False  # of arrival: samples are ordered by time

    @staticmethod
    def program():
        return outlets.program("victoria-metrics", "victoria-metrics", "usr/bin/victoria-metrics")

    @staticmethod
    def reason_to_skip():
        return None if Engine.program() else "no victoria-metrics here; tools/install.sh ci brings it"

    def __init__(self, folder, port):
        self.folder, self.port = folder, port
        self.server = outlets.ServerProcess(os.path.join(folder, "victoria-metrics.log"))

    def start(self):
        self.server.start(self.program(), f"-storageDataPath={self.folder}/data", f"-httpListenAddr=127.0.0.1:{self.port}",
                          "-httpAuth.username=north", f"-httpAuth.password={outlets.RIGHT_PASSWORD}", "-dedup.minScrapeInterval=1ms")
        wait_until(self.listens, 20, self.server.log)

    def listens(self):
        self.server.check()
        try:
            return self.get("/health") == b"OK"
        except OSError:
            return False

    def get(self, path):
        login = base64.b64encode(f"north:{outlets.RIGHT_PASSWORD}".encode()).decode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", headers={"Authorization": "Basic " + login})
        with urllib.request.urlopen(request, timeout=20) as response:
            return response.read()

    def stop(self):
        if self.server.process is not None and self.server.process.poll() is None:
            self.server.process.send_signal(signal.SIGTERM)
            self.server.process.wait(20)

    def pause(self):
        self.server.pause()

    def resume(self):
        self.server.resume()

    def section(self, login="right"):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD if login == "right" else outlets.WRONG_PASSWORD)
        return f"""influxdb:
  server: http://127.0.0.1:{self.port}
  user: north
  password-file: password
  acknowledgement: 1s
"""

    def correct_login(self):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD)

    def samples(self):
        """A sample is the values of one time in its metrics."""
        points = collections.defaultdict(dict)
        match = urllib.parse.quote('{__name__=~"fieldcast_(value|epoch|sequence)"}')
        for line in self.get(f"/api/v1/export?match[]={match}").splitlines():
            series = json.loads(line)
            labels = series["metric"]
            path = "/".join(labels[name] for name in ("bus", "device", "channel"))
            for at, value in zip(series["timestamps"], series["values"]):
                points[path, at, labels["quality"]][labels["__name__"]] = value
        return [(path, point["fieldcast_epoch"], int(point["fieldcast_sequence"]), point["fieldcast_value"], quality)
                for (path, _, quality), point in sorted(points.items()) if len(point) == 3]

    def refuse_one(self):
        return None

    def log(self):
        return self.server.log() if os.path.exists(self.server.log_file) else ""
