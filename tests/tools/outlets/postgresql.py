"""PostgreSQL; the consumer is psql."""

import glob
import os
import pwd
import shutil
import signal
import subprocess
import time

import outlets
from plant import wait_until

# A superuser installs it: a table of samples gets a constraint when it is created.
REFUSAL = """
create function refuse() returns event_trigger language plpgsql as $$ begin
  if to_regclass('fieldcast.samples') is not null and not exists (select from pg_constraint where conname = 'no_press') then
    alter table fieldcast.samples add constraint no_press check (value = trunc(value));
  end if;
end $$;
create event trigger refuse on ddl_command_end when tag in ('CREATE TABLE') execute function refuse();
"""


class Engine:
    name = "postgresql"
    has_unique_samples = True
    keeps_order = False  # of arrival: the table has none
    acknowledgement = 12  # seconds until the outlet closes a connection without a response

    @staticmethod
    def programs():
        found = sorted(glob.glob("/usr/lib/postgresql/*/bin"))
        return found[-1] if found else None

    @staticmethod
    def reason_to_skip():
        return None if Engine.programs() and shutil.which("psql") else "no PostgreSQL here; tools/install.sh test brings it"

    def __init__(self, folder, port):
        self.folder, self.port = folder, port
        os.chmod(folder, 0o711)  # the server does not run as root
        self.data = os.path.join(folder, "data")
        self.server = outlets.ServerProcess(os.path.join(folder, "postgres.log"))
        self.options = {}
        os.mkdir(self.data, 0o700)
        if os.getuid() == 0:
            user = pwd.getpwnam("postgres")
            os.chown(self.data, user.pw_uid, user.pw_gid)
            self.options = {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
        subprocess.run([os.path.join(self.programs(), "initdb"), "-D", self.data, "-U", "postgres", "-A", "scram-sha-256", "--auth-local=trust",
                        "-E", "UTF8", "--locale=C", "--no-sync"], check=True, capture_output=True, cwd="/", **self.options)
        self.is_new = True

    def start(self):
        self.server.start(os.path.join(self.programs(), "postgres"), "-D", self.data, "-p", str(self.port), "-k", self.data,
                          "-c", "listen_addresses=127.0.0.1", "-c", "dynamic_shared_memory_type=mmap", "-c", "fsync=off", "-c", "shared_buffers=32MB", cwd="/", **self.options)
        wait_until(lambda: self.server.check() or self.psql("select 1", "postgres", check=False).returncode == 0, 20, self.server.log)
        if self.is_new:
            self.psql(f"create role north login password '{outlets.RIGHT_PASSWORD}'", "postgres")
            self.psql("create database fieldcast owner north", "postgres")
        self.is_new = False

    def psql(self, sql, database="fieldcast", check=True, seconds=20):
        return subprocess.run(["psql", "-X", "-h", self.data, "-p", str(self.port), "-U", "postgres", "-d", database, "-v", "ON_ERROR_STOP=1",
                               "-AtF", "\t", "-c", sql], check=check, capture_output=True, text=True, timeout=seconds)

    def family(self):
        """The server and its children."""
        found = [self.server.process.pid]
        for path in glob.glob("/proc/[0-9]*/stat"):
            try:
                with open(path, encoding="utf-8", errors="replace") as file:
                    text = file.read()
            except OSError:
                continue
            if int(text.rpartition(")")[2].split()[1]) == self.server.process.pid:
                found.append(int(path.split("/")[2]))
        return found

    def signal(self, number):
        for pid in self.family():
            try:
                os.kill(pid, number)
            except ProcessLookupError:
                pass

    def stop(self):
        if self.server.process is not None and self.server.process.poll() is None:
            self.signal(signal.SIGKILL)
            self.server.process.wait()
            time.sleep(0.2)

    def pause(self):
        self.signal(signal.SIGSTOP)

    def resume(self):
        self.signal(signal.SIGCONT)

    def section(self, login="right"):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD if login == "right" else outlets.WRONG_PASSWORD)
        return f"""postgresql:
  server: 127.0.0.1:{self.port}
  user: north
  password-file: password
  create: true
"""

    def correct_login(self):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD)

    def samples(self):
        done = self.psql("select bus || '/' || device || '/' || channel, epoch, sequence, value, quality from fieldcast.sample_history "
                         "order by epoch, sequence", check=False)
        if done.returncode != 0:
            return []  # the tables do not exist yet
        rows = [line.split("\t") for line in done.stdout.splitlines()]
        return [(path, int(epoch), int(sequence), float(value or "nan"), quality) for path, epoch, sequence, value, quality in rows]

    def refuse_one(self):
        self.psql(REFUSAL)
        return "no_press"

    def log(self):
        return self.server.log() if os.path.exists(self.server.log_file) else ""
