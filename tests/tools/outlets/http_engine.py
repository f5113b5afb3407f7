"""What the engines with a login and a query language over HTTP have in common."""

import base64
import os
import urllib.request

import outlets
from plant import wait_until


class HttpEngine:
    """A subclass has `name`, `section_name` if it differs, PACKAGE, PROGRAM, LOGIN of the consumer, READY, the path of
    the request that succeeds when the server listens, and PATH of the requests of the outlet; and start()."""

    has_unique_samples = True
    keeps_order = False  # of arrival: samples are ordered by time
    PACKAGE, PROGRAM, READY, PATH = "", "", "", ""
    LOGIN = f"north:{outlets.RIGHT_PASSWORD}"

    @classmethod
    def program(cls):
        return outlets.program(cls.PROGRAM, cls.PACKAGE, "usr/bin/" + cls.PROGRAM)

    @classmethod
    def reason_to_skip(cls):
        return None if cls.program() else f"no {cls.PROGRAM} here; tools/install.sh ci brings it"

    def __init__(self, folder, port):
        self.folder, self.port = folder, port
        self.server = outlets.ServerProcess(os.path.join(folder, self.PROGRAM + ".log"))

    def run(self, *arguments):
        """Starts the program and waits until it listens."""
        self.server.start(self.program(), *arguments, cwd=self.folder)
        wait_until(self.listens, 20, self.server.log)

    def listens(self):
        self.server.check()
        try:
            return self.request(self.READY) is not None
        except OSError:
            return False

    def request(self, path, body=None):
        """The response to GET, or to POST with a body."""
        login = base64.b64encode(self.LOGIN.encode()).decode()
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
        return f"""{getattr(self, "section_name", self.name)}:
  server: http://127.0.0.1:{self.port}{self.PATH}
  user: north
  password-file: password
  acknowledgement: 1s
"""

    def correct_login(self):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD)

    def refuse_one(self):
        return None

    def log(self):
        return self.server.log() if os.path.exists(self.server.log_file) else ""
