"""InfluxDB 1 (influxd of Debian); the consumer is its query language over HTTP."""

import json
import os
import urllib.parse

import outlets
from nats import free_port
from outlets.http_engine import HttpEngine

CONFIG = """
reporting-disabled = true
bind-address = "127.0.0.1:{rpc}"
[meta]
  dir = "{folder}/meta"
[data]
  dir = "{folder}/data"
  wal-dir = "{folder}/wal"
  max-values-per-tag = {tags}
[http]
  bind-address = "127.0.0.1:{port}"
  auth-enabled = true
  log-enabled = false
[monitor]
  store-enabled = false
"""


class Engine(HttpEngine):
    name = "influxdb"
    PACKAGE, PROGRAM, READY, LOGIN = "influxdb", "influxd", "/ping", "admin:admin"

    def __init__(self, folder, port):
        super().__init__(folder, port)
        self.tags, self.is_new = 100000, True

    def start(self):
        config = os.path.join(self.folder, "influxdb.conf")
        with open(config, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(folder=self.folder, port=self.port, rpc=free_port(), tags=self.tags))
        self.run("-config", config)
        if self.is_new:
            self.query("CREATE USER admin WITH PASSWORD 'admin' WITH ALL PRIVILEGES")
            self.query("CREATE DATABASE fieldcast")
            self.query(f"CREATE USER north WITH PASSWORD '{outlets.RIGHT_PASSWORD}'")
            self.query("GRANT WRITE ON fieldcast TO north")
        self.is_new = False

    def query(self, text):
        return json.loads(self.request("/query?db=fieldcast&epoch=ns", urllib.parse.urlencode({"q": text}).encode()))["results"][0]

    def samples(self):
        found = []
        for series in self.query("SELECT epoch, sequence, value FROM fieldcast WHERE bus = 'line' GROUP BY bus, device, channel, quality").get("series", []):
            path = "/".join(series["tags"][name] for name in ("bus", "device", "channel"))
            # InfluxDB shows the fields of a point that is being written one by one.
            found += [(path, epoch, sequence, value, series["tags"]["quality"]) for _, epoch, sequence, value in series["values"]
                      if epoch is not None and sequence is not None]
        return sorted(found)

    def refuse_one(self):
        """The channel `level` is a value of a tag too many."""
        self.stop()
        self.tags = 3
        self.start()
        for channel in ("temperature", "setpoint", "running"):
            self.request("/write?db=fieldcast", f"fieldcast,bus=other,channel={channel} other=1".encode())
        return "max-values-per-tag"
