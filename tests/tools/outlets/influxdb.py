"""InfluxDB 1 (influxd of Debian); the consumer is its query language over HTTP."""

import base64
import json
import os
import urllib.parse
import urllib.request

import outlets
from nats import free_port
from plant import wait_until

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


class Engine:
    name = "influxdb"
    has_unique_samples = True
    keeps_order = False  # of arrival: points are ordered by time

    @staticmethod
    def program():
        return outlets.program("influxd", "influxdb", "usr/bin/influxd")

    @staticmethod
    def reason_to_skip():
        return None if Engine.program() else "no influxd here; tools/install.sh ci brings it"

    def __init__(self, folder, port):
        self.folder, self.port, self.tags = folder, port, 100000
        self.server = outlets.ServerProcess(os.path.join(folder, "influxd.log"))
        self.is_new = True

    def start(self):
        config = os.path.join(self.folder, "influxdb.conf")
        with open(config, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(folder=self.folder, port=self.port, rpc=free_port(), tags=self.tags))
        self.server.start(self.program(), "-config", config)
        wait_until(self.listens, 20, self.server.log)
        if self.is_new:
            self.query("CREATE USER admin WITH PASSWORD 'admin' WITH ALL PRIVILEGES")
            self.query("CREATE DATABASE fieldcast")
            self.query(f"CREATE USER north WITH PASSWORD '{outlets.RIGHT_PASSWORD}'")
            self.query("GRANT WRITE ON fieldcast TO north")
        self.is_new = False

    def listens(self):
        self.server.check()
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/ping", timeout=2):
                return True
        except OSError:
            return False

    def query(self, text):
        return json.loads(self.post("/query?db=fieldcast&epoch=ns", urllib.parse.urlencode({"q": text}).encode()))["results"][0]

    def post(self, path, body):
        login = base64.b64encode(b"admin:admin").decode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", data=body, headers={"Authorization": "Basic " + login})
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
        return f"""influxdb:
  server: http://127.0.0.1:{self.port}
  user: north
  password-file: password
  acknowledgement: 1s
"""

    def correct_login(self):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD)

    def samples(self):
        found = []
        for series in self.query("SELECT epoch, sequence, value FROM fieldcast WHERE bus = 'line' GROUP BY bus, device, channel, quality").get("series", []):
            path = "/".join(series["tags"][name] for name in ("bus", "device", "channel"))
            found += [(path, epoch, sequence, value, series["tags"]["quality"]) for _, epoch, sequence, value in series["values"]]
        return sorted(found)

    def refuse_one(self):
        """The channel `level` is a value of a tag too many."""
        self.stop()
        self.tags = 3
        self.start()
        for channel in ("temperature", "setpoint", "running"):
            self.post("/write?db=fieldcast", f"fieldcast,bus=other,channel={channel} other=1".encode())
        return "max-values-per-tag"

    def log(self):
        return self.server.log() if os.path.exists(self.server.log_file) else ""
