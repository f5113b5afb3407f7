"""Tests the notifications of fieldcast-station against an SMTP server of Debian with TLS and a login
(python3-aiosmtpd), and against a web server that fails on purpose.

usage: e2e_notify.py BIN_DIR
"""

import asyncio
import contextlib
import datetime
import email
import email.policy
import hashlib
import hmac
import http.server
import json
import os
import signal
import socket
import sqlite3
import ssl
import subprocess
import sys
import threading
import time
import unittest

import e2e_station
from e2e_station import Browser, Station
from plant import Plant, modbus_line, wait_until

try:
    from aiosmtpd.controller import Controller
    from aiosmtpd.smtp import SMTP, AuthResult
except ImportError:
    print("skipped: python3-aiosmtpd is not installed (tools/install.sh)")
    sys.exit(77)

BIN_DIR = ""
SECONDS = 60
PASSWORD, KEY = "a pass word of mail", "the key of the signature"
CHANNELS = ("mail", "dead", "window", "hang", "hook", "flood-1", "flood-2", "flood-3", "flood-4")

CONFIG = """
bridge: e2e
store: { path: {run}/bridge.db }""" + modbus_line() + "".join(
    f'          - {{ name: {name}, at: "holding:{place}", type: int16, access: read-write, limits: {{ high: 20000 }} }}\n'
    for place, name in enumerate(CHANNELS))

plant = None


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def setUpModule():
    global plant
    e2e_station.BIN_DIR = BIN_DIR
    plant = Plant(BIN_DIR, CONFIG)
    plant.__enter__()
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj",
                    "/CN=mail", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", path("mail.key"), "-out", path("mail.pem")],
                   check=True, capture_output=True)
    for name, text in (("password", PASSWORD), ("wrong", "no such word"), ("key", KEY)):
        with open(path(name), "w", encoding="utf-8") as file:
            file.write(text + "\n")
        os.chmod(path(name), 0o600)


def tearDownModule():
    plant.__exit__(None, None, None)


def path(name):
    return os.path.join(plant.run, name)


class Inbox:
    """The handler of the SMTP server. `hold`: a mail is received, but the response waits."""

    def __init__(self):
        self.mails, self.hold, self.refused = [], threading.Event(), set()
        self.hold.set()

    async def handle_RCPT(self, server, session, envelope, address, options):
        if address in self.refused:
            return "550 no such mailbox"
        envelope.rcpt_tos.append(address)
        return "250 OK"

    async def handle_DATA(self, server, session, envelope):
        self.mails.append((envelope.mail_from, envelope.rcpt_tos, email.message_from_bytes(envelope.content, policy=email.policy.default)))
        while not self.hold.is_set():
            await asyncio.sleep(0.05)
        return "250 OK"


class Smtp:
    def __init__(self, inbox, port, controller=Controller):
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(path("mail.pem"), path("mail.key"))

        def check(server, session, envelope, mechanism, data):
            return AuthResult(success=(data.login, data.password) == (b"station", PASSWORD.encode()))
        self.controller = controller(inbox, hostname="127.0.0.1", port=port, tls_context=context, require_starttls=True, auth_required=True,
                                     authenticator=check)

    def __enter__(self):
        self.controller.start()
        return self

    def __exit__(self, *fault):
        self.controller.stop()


class LateGreeting(SMTP):
    """Greets after 4 s, as a server that lets impatient senders of spam betray themselves (postscreen of Postfix: 6 s)."""

    async def _handle_client(self):
        await asyncio.sleep(4)
        await super()._handle_client()


class LateController(Controller):
    def factory(self):
        return LateGreeting(self.handler, **self.SMTP_kwargs)


class Hook:
    """A web server that answers each POST by the next of `answers`, the last one for ever."""

    def __init__(self, *answers):
        self.requests, self.beats, self.elsewhere, left = [], 0, [], list(answers)
        owner = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                if self.path == "/beat":
                    owner.beats += 1
                else:
                    owner.elsewhere.append(self.path)
                self.send_response(200)
                self.end_headers()

            def do_POST(self):
                if self.path != "/hook":
                    owner.elsewhere.append(self.path)
                body = self.rfile.read(int(self.headers["Content-Length"]))
                owner.requests.append((dict(self.headers), body))
                answer = left.pop(0) if len(left) > 1 else left[0]
                if answer == "cut":
                    self.connection.shutdown(socket.SHUT_RDWR)
                    return
                if answer == "hang":
                    time.sleep(12)
                    return
                self.send_response(answer)
                if answer == 302:
                    self.send_header("Location", "/elsewhere")
                self.end_headers()

            def log_message(self, *text):
                pass
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_port}"

    def __enter__(self):
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *fault):
        self.server.shutdown()
        self.server.server_close()


def configuration(name, port, rules, hook="http://127.0.0.1:9", password="password", more=""):
    return f"""
web: {{ local-role: operator }}
store: {{ path: {path(name)}.db }}
notify:
  link: https://station.plant/
  mail: {{ server: "smtp://127.0.0.1:{port}", from: station@plant.example, authority: {path("mail.pem")}, user: station,
          password-file: {path(password)} }}
  targets:
    - {{ name: crew, mail: [ann@plant.example, bob@plant.example] }}
    - {{ name: chat, webhook: "{hook}/hook", secret-file: {path("key")} }}
  rules: {rules}
{more}"""


def station(name, text):
    return Station(plant, name, text, "--listen", "127.0.0.1:0")


def kill(running):
    running.process.kill()
    running.process.wait(SECONDS)


def write(channel, value):
    result = plant.cli("write", f"line/press/{channel}={value}")
    assert result.code == 0, result


def state(running):
    return Browser(running).get("/api/notifications")


def acknowledge(running, channel):
    alarm = {"bus": "line", "device": "press", "channel": channel, "limit": "high"}
    status, text = Browser(running).ask("POST", "/api/alarms/acknowledge", {"alarms": [alarm], "note": "seen"})
    assert status in (200, 202), (status, text)


def to(inbox, address):
    return [mail for _, recipients, mail in inbox.mails if recipients == [address]]


def settle():
    """Longer than a turn of the rules and the first pauses of a sender."""
    time.sleep(4)


class Notifications(unittest.TestCase):
    def test_1_a_mail_arrives_once_and_its_end_too(self):
        inbox, port = Inbox(), free_port()
        text = configuration("mail", port, '[{ name: all, to: [crew], patterns: ["line/press/mail"], cleared: true }]')
        with Smtp(inbox, port), station("mail", text) as running:
            write("mail", 20001)
            wait_until(lambda: to(inbox, "ann@plant.example") and to(inbox, "bob@plant.example"), SECONDS, running.log)
            sender, _, _ = inbox.mails[0]
            mail = to(inbox, "ann@plant.example")[0]
            self.assertEqual(sender, "station@plant.example")
            self.assertEqual(mail["Subject"], "ALARM medium: line/press/mail high = 20001")
            self.assertEqual((mail["To"], mail["Auto-Submitted"]), ("ann@plant.example", "auto-generated"))
            self.assertRegex(mail["Message-ID"], r"^<[0-9a-f]{32}@plant\.example>$")
            body = mail.get_content()
            self.assertIn("https://station.plant/#/alarms?alarm=line%2Fpress%2Fmail%2Fhigh", body)
            self.assertIn("rule all", body)
            # The bridge restarts and continues the alarm: it is the same one.
            plant.bridge.send_signal(signal.SIGTERM)
            self.assertEqual(plant.bridge.wait(SECONDS), 0)
            plant.bridge = plant._start("fieldcast-bridge")
            wait_until(plant._status, SECONDS, lambda: plant.log("fieldcast-bridge"))
            settle()
            self.assertEqual(len(inbox.mails), 2)
            wait_until(lambda: state(running)["sent"] == 2, SECONDS, running.log)
            acknowledge(running, "mail")
            write("mail", 0)
            wait_until(lambda: len(inbox.mails) == 4, SECONDS, running.log)
            self.assertTrue(to(inbox, "bob@plant.example")[1]["Subject"].startswith("RETURNED medium: line/press/mail"))
            settle()
            self.assertEqual(len(inbox.mails), 4)
            found = state(running)
            self.assertEqual({message["state"] for message in found["messages"]}, {"sent"})
            self.assertEqual([target["error"] for target in found["targets"]], ["", ""])
            self.assertNotIn(PASSWORD, running.log())

    def test_2_a_dead_server_and_a_killed_station_lose_and_repeat_nothing(self):
        inbox, port = Inbox(), free_port()
        text = configuration("dead", port, '[{ name: all, to: [crew], patterns: ["line/press/dead"] }]')
        with station("dead", text) as running:
            write("dead", 20001)
            wait_until(lambda: state(running)["failed"] >= 2 and state(running)["waiting"] == 2, SECONDS, running.log)
            self.assertIn("crew: a message was not delivered", running.log())
            kill(running)
            running.__enter__()
            wait_until(lambda: state(running)["waiting"] == 2, SECONDS, running.log)
            inbox.refused.add("bob@plant.example")  # it does not stop the mail to ann
            with Smtp(inbox, port):
                wait_until(lambda: to(inbox, "ann@plant.example"), SECONDS, running.log)
                wait_until(lambda: [m for m in state(running)["messages"] if "550" in m["error"]], SECONDS, running.log)
                inbox.refused.clear()
                wait_until(lambda: state(running)["waiting"] == 0, SECONDS, running.log)
                kill(running)
                running.__enter__()
                settle()
                self.assertEqual(sorted(recipients[0] for _, recipients, _ in inbox.mails), ["ann@plant.example", "bob@plant.example"])

    def test_3_killed_between_the_acceptance_and_the_store_a_mail_comes_again_with_its_id(self):
        inbox, port = Inbox(), free_port()
        text = configuration("window", port, '[{ name: all, to: [crew], patterns: ["line/press/window"] }]')
        with Smtp(inbox, port), station("window", text) as running:
            inbox.hold.clear()
            write("window", 20001)
            wait_until(lambda: inbox.mails, SECONDS, running.log)  # received, the response waits
            kill(running)
            inbox.hold.set()
            running.__enter__()
            wait_until(lambda: state(running)["sent"] == 2, SECONDS, running.log)
            first = inbox.mails[0]
            again = [mail for _, recipients, mail in inbox.mails if recipients == first[1]]
            self.assertEqual(len(again), 2)
            self.assertEqual({mail["Message-ID"] for mail in again}, {first[2]["Message-ID"]})
            self.assertEqual(len(inbox.mails), 3)
            settle()
            self.assertEqual(len(inbox.mails), 3)

    def test_3_a_server_that_hangs_does_not_delay_the_stop(self):
        inbox, port = Inbox(), free_port()
        text = configuration("hang", port, '[{ name: all, to: [crew], patterns: ["line/press/hang"] }]')
        with Smtp(inbox, port), station("hang", text) as running:
            inbox.hold.clear()
            write("hang", 20001)
            wait_until(lambda: inbox.mails, SECONDS, running.log)
            began = time.monotonic()
            running.process.send_signal(signal.SIGTERM)
            self.assertEqual(running.process.wait(SECONDS), 0, running.log())
            self.assertLess(time.monotonic() - began, 8)
            inbox.hold.set()
            running.__enter__()  # nobody knows whether the mail was accepted: it is sent again
            wait_until(lambda: state(running)["sent"] == 2, SECONDS, running.log)

    def test_4_a_webhook_that_fails_in_every_way_gets_the_message_in_the_end(self):
        with Hook(500, 302, "cut", "hang", 200) as hook:
            beat = f'  heartbeat: {{ url: "{hook.url}/beat", every: 1s, method: get }}\n'
            text = configuration("hook", free_port(), '[{ name: all, to: [chat], patterns: ["line/press/hook"] }]', hook.url, more=beat)
            with station("hook", text) as running:
                write("hook", 20001)
                wait_until(lambda: len(hook.requests) >= 2, SECONDS, running.log)
                self.assertIn("response 500", running.log())
                wait_until(lambda: state(running)["sent"] == 1, 2 * SECONDS, running.log)
                settle()
                self.assertEqual(len(hook.requests), 5)
                self.assertEqual(hook.elsewhere, [])
                self.assertIn("redirects are not followed", running.log())
                headers, body = hook.requests[-1]
                wanted = "sha256=" + hmac.new(KEY.encode(), body, hashlib.sha256).hexdigest()
                self.assertEqual(headers["Fieldcast-Signature"], wanted)
                self.assertEqual({request[0]["Fieldcast-Id"] for request in hook.requests}, {json.loads(body)["id"]})
                message = json.loads(body)
                self.assertEqual((message["kind"], message["bus"], message["channel"], message["limit"], message["value"]),
                                 ("raised", "line", "hook", "high", 20001))
                self.assertEqual(message["link"], "https://station.plant/#/alarms?alarm=line%2Fpress%2Fhook%2Fhigh")
                self.assertNotIn(KEY, running.log())
                self.assertGreater(hook.beats, 3)
                os.kill(running.process.pid, signal.SIGSTOP)  # the station hangs: no heartbeat
                time.sleep(0.5)
                before = hook.beats
                time.sleep(3)
                self.assertEqual(hook.beats, before)
                os.kill(running.process.pid, signal.SIGCONT)
                wait_until(lambda: hook.beats > before, SECONDS, running.log)
                status, text = Browser(running).ask("GET", "/metrics")
                self.assertIn("fieldcast_station_notifications_sent_total 1\n", text)
                self.assertIn("fieldcast_station_notifications_failed_total 4\n", text)

    def test_5_an_engineer_reads_the_rules_and_sends_a_test(self):
        inbox, port = Inbox(), free_port()
        rules = '[{ name: night, to: [crew], patterns: ["line/press/none"], priority: high, hours: ["mon-fri 18:00-06:00", sat-sun], escalate: [{ after: 30min, to: [chat] }] }]'
        text = configuration("rules", port, rules)
        with Smtp(inbox, port), station("rules", text.replace("local-role: operator", "local-role: engineer")) as running:
            rule = state(running)["rules"][0]
            self.assertEqual((rule["name"], rule["to"], rule["priority"], rule["hours"], rule["escalate"]),
                             ("night", ["crew"], "high", ["mon-fri 18:00-06:00", "sat-sun"], [{"after_ms": 1800000.0, "to": ["chat"]}]))
            send = lambda target: Browser(running).ask("POST", "/api/notifications/test", {"target": target})[0]
            self.assertEqual((send("nobody"), send(7), send("crew")), (404, 404, 200))
            wait_until(lambda: to(inbox, "ann@plant.example"), SECONDS, running.log)
            self.assertTrue(to(inbox, "ann@plant.example")[0]["Subject"].startswith("TEST"))
            wait_until(lambda: state(running)["messages"][0]["state"] == "sent", SECONDS, running.log)
            self.assertEqual(len(inbox.mails), 1)
        with station("rules", text) as running:
            self.assertEqual(Browser(running).ask("POST", "/api/notifications/test", {"target": "crew"})[0], 403)

    def test_5_a_flood_is_one_digest(self):
        with Hook(200) as hook:
            rules = '[{ name: all, to: [chat], patterns: ["line/press/flood-*"], digest: 1, digest-within: 10s }]'
            with station("flood", configuration("flood", free_port(), rules, hook.url)) as running:
                for number in range(1, 5):
                    write(f"flood-{number}", 20001)
                wait_until(lambda: len(hook.requests) == 2, SECONDS, running.log)
                kinds = [json.loads(body)["kind"] for _, body in hook.requests]
                self.assertEqual(kinds, ["raised", "digest"])
                lines = json.loads(hook.requests[1][1])["lines"].splitlines()
                self.assertEqual(len(lines), 3, lines)
            kept = sqlite3.connect(path("flood.db"))
            self.assertEqual(kept.execute("select count(*) from notifications where state = 'sent'").fetchone(), (2,))
            kept.close()

    def test_6_check_and_test_messages(self):
        def run(text, *arguments):
            file = path("check.yaml")
            with open(file, "w", encoding="utf-8") as out:
                out.write(f"station: check\ndds: {{ domain: {plant.domain} }}\n{text}")
            return subprocess.run([os.path.join(BIN_DIR, "fieldcast-station"), "--config", file, *arguments], capture_output=True, text=True,
                                  timeout=SECONDS)
        inbox, port = Inbox(), free_port()
        text = configuration("check", port, "[{ name: all, to: [crew] }]")
        self.assertEqual(run(text, "--check").stdout, "in order\n")
        self.assertIn("'nobody' is not a target", run(text.replace("to: [crew]", "to: [nobody]"), "--check").stderr)
        os.chmod(path("password"), 0o644)
        refused = run(text, "--check")
        os.chmod(path("password"), 0o600)
        self.assertEqual(refused.returncode, 3)
        self.assertIn("password", refused.stderr)
        self.assertEqual(run(text, "--notify-test", "crew").returncode, 4)  # no server
        with Smtp(inbox, port):
            done = run(text, "--notify-test", "crew")
            self.assertEqual((done.returncode, done.stdout), (0, "the server has accepted the message\n"), done.stderr)
            self.assertTrue(to(inbox, "ann@plant.example")[0]["Subject"].startswith("TEST"))
            wrong = run(text.replace(f"password-file: {path('password')}", f"password-file: {path('wrong')}"), "--notify-test", "crew")
            self.assertEqual(wrong.returncode, 4)
            self.assertNotIn("no such word", wrong.stdout + wrong.stderr)
            foreign = run(text.replace(f", authority: {path('mail.pem')}", ""), "--notify-test", "crew")
            self.assertEqual(foreign.returncode, 4)  # an unknown authority
            self.assertIn("certificate", foreign.stderr)
        self.assertEqual(len(inbox.mails), 1)
        with Smtp(inbox, port, LateController):
            late = run(text, "--notify-test", "crew")
            self.assertEqual((late.returncode, late.stdout), (0, "the server has accepted the message\n"), late.stderr)
        self.assertEqual(len(inbox.mails), 2)
        self.assertEqual(run(text, "--notify-test", "nobody").returncode, 2)

    def test_7_reports_are_made_once_and_missed_ones_are_made_up(self):
        inbox, port, folder = Inbox(), free_port(), path("reports")
        text = configuration("reports", port, '[{ name: none, to: [crew], patterns: ["no"] }]', more=f"""
record: {{ patterns: [line] }}
reports:
  - {{ name: energy, channels: [line], at: "00:00", format: csv, to: {folder} }}
  - {{ name: office, channels: [line], at: "00:00", mail: [crew] }}
""")

        def day(ago):
            return (datetime.date.today() - datetime.timedelta(ago)).isoformat()

        def files():
            return sorted(os.listdir(folder)) if os.path.isdir(folder) else []
        yesterday = f"energy_{day(1)}.csv"
        with Smtp(inbox, port), station("reports", text) as running:
            wait_until(lambda: files() == [yesterday] and len(inbox.mails) == 2, SECONDS, running.log)
            mail = to(inbox, "bob@plant.example")[0]
            self.assertEqual(mail["Subject"], f"Report office {day(1)} of the station reports")
            attached = list(mail.iter_attachments())[0]
            self.assertEqual(attached.get_filename(), f"office_{day(1)}.xlsx")
            self.assertTrue(attached.get_content().startswith(b"PK"))
            wait_until(lambda: state(running)["waiting"] == 0, SECONDS, running.log)
            wait_until(lambda: Browser(running).get("/api/history?channel=line/press/mail")["series"][0]["known"], SECONDS, running.log)
            kill(running)
            os.remove(os.path.join(folder, yesterday))
            running.__enter__()
            settle()
            self.assertEqual((files(), len(inbox.mails)), ([], 2))
            kill(running)
            # As if the station had been off for two days.
            with contextlib.closing(sqlite3.connect(path("reports.db"))) as store:
                store.execute("update report_runs set period = ?", (day(3),))
                store.commit()
            running.__enter__()
            wait_until(lambda: files() == [f"energy_{day(2)}.csv", yesterday] and len(inbox.mails) == 4, SECONDS, running.log)
            with open(os.path.join(folder, yesterday), encoding="utf-8") as file:
                self.assertIn(f"\nline/press/mail,,{day(1)}T00:00:00", file.read())
            runs = Browser(running).get("/api/reports")["runs"]
            self.assertEqual(len([run for run in runs if run["period"] == day(1)]), 2, runs)
            settle()
            self.assertEqual(len(inbox.mails), 4)  # those of yesterday were sent before

if __name__ == "__main__":
    BIN_DIR = os.path.abspath(sys.argv[1])
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=2)
