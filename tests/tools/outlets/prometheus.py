"""Prometheus with its receiver of remote write; the consumer is its query language over HTTP."""

import base64
import collections
import json
import os
import threading
import urllib.parse
import urllib.request

import outlets
from plant import wait_until

# bcrypt of outlets.RIGHT_PASSWORD, 5 rounds
HASH = "$2b$05$abcdefghijklmnopqrstuuZ0Fx87Pb/Aqb0E90lfvCwzXnaFKUHpS"


class Engine:
    name = "prometheus"
    has_unique_samples = True
    keeps_order = False  # of arrival: samples are ordered by time

    @staticmethod
    def program():
        return outlets.program("prometheus", "prometheus", "usr/bin/prometheus")

    @staticmethod
    def reason_to_skip():
        return None if Engine.program() else "no prometheus here; tools/install.sh ci brings it"

    def __init__(self, folder, port):
        self.folder, self.port, self.window = folder, port, "30m"
        self.server = outlets.ServerProcess(os.path.join(folder, "prometheus.log"))

    def start(self):
        for name, text in (("prometheus.yml", f"storage: {{ tsdb: {{ out_of_order_time_window: {self.window} }} }}\n"),
                           ("web.yml", f"basic_auth_users: {{ north: {HASH} }}\n")):
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        self.server.start(self.program(), f"--config.file={self.folder}/prometheus.yml", f"--storage.tsdb.path={self.folder}/data",
                          f"--web.listen-address=127.0.0.1:{self.port}", f"--web.config.file={self.folder}/web.yml", "--web.enable-remote-write-receiver",
                          cwd=self.folder)
        wait_until(self.listens, 20, self.server.log)

    def listens(self):
        self.server.check()
        try:
            return self.get("/-/ready") is not None
        except OSError:
            return False

    def get(self, path):
        login = base64.b64encode(f"north:{outlets.RIGHT_PASSWORD}".encode()).decode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", headers={"Authorization": "Basic " + login})
        with urllib.request.urlopen(request, timeout=20) as response:
            return response.read()

    def stop(self):
        self.server.kill()

    def pause(self):
        self.server.pause()

    def resume(self):
        self.server.resume()

    def section(self, login="right"):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD if login == "right" else outlets.WRONG_PASSWORD)
        return f"""prometheus:
  server: http://127.0.0.1:{self.port}/api/v1/write
  user: north
  password-file: password
  acknowledgement: 1s
"""

    def correct_login(self):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD)

    def samples(self):
        """A sample is the values of one time in both series. The epoch is not there."""
        points = collections.defaultdict(dict)
        query = urllib.parse.quote('{__name__=~"fieldcast_(value|sequence)",bus="line"}[1h]')
        for series in json.loads(self.get(f"/api/v1/query?query={query}"))["data"]["result"]:
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

    def log(self):
        return self.server.log() if os.path.exists(self.server.log_file) else ""
