"""Tests the outlets `mqtt` and `sparkplug` of fieldcast-forward beyond their common contract (e2e_outlets.py): a simulated plant, a
bridge, the forwarder, mosquitto, and consumers of another kind.

usage: e2e_mqtt.py BIN_DIR SOURCE_DIR NODE_MODULES
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import mosquitto
import sparkplug
from forwarding import Forwarder
from nats import free_port
from plant import Plant, wait_until

BIN_DIR = SOURCE_DIR = NODE_MODULES = ""
NODE = shutil.which("node") or shutil.which("nodejs")

CONFIG = """
bridge: e2e
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { refresh: 200ms }
    devices:
      - name: press.1
        address: 1
        channels:
          - { name: temperature, at: "holding:100", type: float32, unit: °C }
          - { name: setpoint, at: "holding:200", type: int16, access: read-write, limits: { high: 100 } }
          - { name: scaled, at: "holding:201", type: int16, scale: 0.1 }
          - { name: running, at: "coil:3", type: bool }
      - name: mill
        address: 2
        channels:
          - { name: level, at: "input-register:3", type: uint16 }
"""

plant = None


def setUpModule():
    global plant
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG))


class MqttCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-mqtt-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def broker(self, listener="", **options):
        broker = mosquitto.Broker(self.folder, free_port(), listener=listener, **options)
        self.addCleanup(broker.kill)
        return broker.start()

    def consumer(self, broker, topic="#", options=(), name="consumer"):
        consumer = mosquitto.Consumer(broker, (topic,), options, name)
        self.addCleanup(consumer.stop)
        time.sleep(1.5)  # until it has subscribed
        return consumer

    def forwarder(self, section):
        forwarder = Forwarder(BIN_DIR, self.folder, f"site: north\ndds: {{ domain: {plant.domain} }}\nqueue: {{ path: queue.db }}\n"
                                                    f"gather: {{ time: 200ms }}\nsend: {{ late-after: 1s }}\n{section}\n")
        self.addCleanup(forwarder.stop)
        return forwarder

    def explained(self, forwarder, broker):
        return lambda: forwarder.log() + broker.log()


class Plain(MqttCase):
    def test_last_values_and_discovery_wait_for_a_new_subscriber_and_the_will_follows_a_kill(self):
        broker = self.broker()
        forwarder = self.forwarder(f"mqtt: {{ servers: [mqtt://127.0.0.1:{broker.port}], retain: true, discovery: true }}")
        forwarder.start()
        wait_until(lambda: "connected to" in forwarder.log(), 20, self.explained(forwarder, broker))
        self.assertEqual(plant.cli("write", "line/press.1/setpoint=101").code, 0)
        time.sleep(3)
        late = self.consumer(broker)

        def retained():
            return {message.topic: message.payload for message in late.received() if message.retained == "1"}
        wait_until(lambda: any(topic.startswith("fieldcast-alarm/") for topic in retained()), 20, self.explained(forwarder, broker))
        found = retained()
        self.assertEqual(found["fieldcast-status/north"], b"online")
        self.assertEqual(json.loads(found["fieldcast/north/line/press.1/temperature"])["unit"], "°C")
        self.assertEqual(json.loads(found["fieldcast/north/line/press.1/setpoint"])["value"], 101)
        self.assertTrue(json.loads(found["fieldcast-alarm/north/line/press.1/setpoint/high"])["active"])
        self.assertEqual(len(json.loads(found["fieldcast-catalogue/north/line/press.1"])["channels"]), 4)
        sensor = json.loads(found["homeassistant/sensor/fieldcast_north_line_press-2E1_temperature/config"])
        self.assertEqual((sensor["device_class"], sensor["state_topic"]), ("temperature", "fieldcast/north/line/press.1/temperature"))
        self.assertIn("homeassistant/binary_sensor/fieldcast_north_line_press-2E1_running/config", found)
        forwarder.kill()

        def states():
            return [message.payload for message in late.received() if message.topic == "fieldcast-status/north"]
        wait_until(lambda: states()[-1] == b"offline", 20, lambda: str(states()))
        forwarder.start()
        wait_until(lambda: states()[-1] == b"online", 20, self.explained(forwarder, broker))
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        wait_until(lambda: states()[-1] == b"offline", 20, lambda: str(states()))
        self.assertEqual(plant.cli("write", "line/press.1/setpoint=1").code, 0)

    def test_a_device_is_offline_while_its_bridge_does_not_run(self):
        broker = self.broker()
        consumer = self.consumer(broker, "fieldcast-status/#")
        forwarder = self.forwarder(f"mqtt: {{ servers: [mqtt://127.0.0.1:{broker.port}], retain: true }}")
        forwarder.start()

        def states():
            return [message.payload for message in consumer.received() if message.topic == "fieldcast-status/north/line/press.1"]
        wait_until(lambda: states() == [b"online"], 20, self.explained(forwarder, broker))
        plant.bridge.kill()
        plant.bridge.wait()
        wait_until(lambda: states()[-1] == b"offline", 40, self.explained(forwarder, broker))
        plant.kill_bridge()  # starts it again
        wait_until(lambda: states()[-1] == b"online", 40, self.explained(forwarder, broker))
        self.assertEqual(forwarder.stop(), 0, forwarder.log())

    def test_tls_checks_both_sides(self):
        def openssl(*arguments):
            subprocess.run(["openssl", *arguments], check=True, capture_output=True, cwd=self.folder)
        for name in ("ca", "foreign"):
            openssl("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.pem")
        for name in ("server", "client"):
            openssl("req", "-newkey", "rsa:2048", "-nodes", "-subj", f"/CN={name}", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", f"{name}.key",
                    "-out", f"{name}.csr")
            with open(os.path.join(self.folder, "names"), "w", encoding="utf-8") as file:
                file.write("subjectAltName=IP:127.0.0.1\n")
            openssl("x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", "2", "-extfile", "names",
                    "-out", f"{name}.pem")
            os.chmod(os.path.join(self.folder, f"{name}.key"), 0o600)
        path = self.folder
        broker = self.broker(f"cafile {path}/ca.pem\ncertfile {path}/server.pem\nkeyfile {path}/server.key\nrequire_certificate true")
        consumer = self.consumer(broker, options=("--cafile", f"{path}/ca.pem", "--cert", f"{path}/client.pem", "--key", f"{path}/client.key"))
        address = f"mqtt: {{ servers: [mqtts://127.0.0.1:{broker.port}], certificate: client.pem, key: client.key, authority: "
        wrong = self.forwarder(address + "foreign.pem }")
        wrong.start()
        wait_until(lambda: "cannot connect" in wrong.log(), 20, self.explained(wrong, broker))
        self.assertEqual(wrong.stop(), 0, wrong.log())
        self.assertNotIn("connected to", wrong.log())
        right = self.forwarder(address + "ca.pem }")
        right.start()
        wait_until(lambda: any(message.topic.startswith("fieldcast/") for message in consumer.received()), 20, self.explained(right, broker))
        self.assertEqual(right.stop(), 0, right.log())

    def test_a_missing_right_is_reported_and_nothing_is_removed(self):
        acl = os.path.join(self.folder, "acl")
        with open(acl, "w", encoding="utf-8") as file:
            file.write("topic write fieldcast-status/#\n")
        broker = self.broker(f"acl_file {acl}")
        forwarder = self.forwarder(f"mqtt: {{ servers: [mqtt://127.0.0.1:{broker.port}] }}")
        forwarder.start()
        wait_until(lambda: "check the rights" in forwarder.log(), 20, self.explained(forwarder, broker))
        self.assertEqual(forwarder.stop(), 0)
        self.assertRegex(forwarder.log(), r"stopped: .* [1-9]\d* messages wait .* 0 refused")


class Sparkplug(MqttCase):
    def start(self, more="", commands=""):
        broker = self.broker()
        consumer = self.consumer(broker, "spBv1.0/#")
        forwarder = self.forwarder(f"sparkplug: {{ servers: [mqtt://127.0.0.1:{broker.port}], group: plants{more} }}\n{commands}")
        forwarder.start()
        return broker, consumer, forwarder

    @staticmethod
    def host(consumer):
        host = sparkplug.Host()
        for message in consumer.received():
            host.on_message(message.topic, message.payload)
        return host

    def wait_for(self, condition, consumer, forwarder, broker):
        wait_until(lambda: condition(self.host(consumer)), 20, self.explained(forwarder, broker))
        return self.host(consumer)

    @staticmethod
    def kinds(host):
        return [kind for kind, _, _ in host.order]

    def test_births_data_rebirth_and_deaths(self):
        for more in ("", ", version: 3.1.1", ", qos: 1"):
            with self.subTest(more=more):
                self.setUp()
                self.births(*self.start(more), int("qos" in more))

    def births(self, broker, consumer, forwarder, qos):
        host = self.wait_for(lambda host: len(host.samples) > 30 and len(host.births) == 2, consumer, forwarder, broker)
        self.assertEqual(host.faults, [])
        self.assertEqual(self.kinds(host)[:2], ["NBIRTH", "DBIRTH"])
        press = host.births["line:press.1"]
        self.assertEqual({name: metric.datatype for name, metric in press.items()},
                         {"temperature": 9, "setpoint": 2, "scaled": 10, "running": 11, "Alarms/setpoint/high": 11})
        self.assertEqual(press["temperature"].properties["engUnit"], "°C")
        self.assertEqual(press["setpoint"].properties["high"], 100.0)
        self.assertEqual({message.qos for message in consumer.received() if "/DDATA/" in message.topic}, {str(qos)})
        self.assertEqual({message.qos for message in consumer.received() if "BIRTH/" in message.topic}, {"0"})
        # A rebirth
        births = self.kinds(host).count("NBIRTH")
        broker.publish("spBv1.0/plants/NCMD/north", sparkplug.rebirth_request())
        host = self.wait_for(lambda host: self.kinds(host).count("NBIRTH") > births and len(host.births) == 2, consumer, forwarder, broker)
        self.assertEqual((host.faults, host.bd_seq), ([], 0))
        self.assertIsNotNone(host.births["line:press.1"]["temperature"].value, "the last value is known")
        broker.publish("spBv1.0/plants/DCMD/north/line:press.1", b"\x08\x01")
        wait_until(lambda: "DCMD/north/line:press.1: MQTT does not name the user" in forwarder.log(), 20, self.explained(forwarder, broker))
        # Death by the will, and in order
        forwarder.kill()
        host = self.wait_for(lambda host: not host.online, consumer, forwarder, broker)
        self.assertEqual(self.kinds(host)[-1], "NDEATH")
        forwarder.start()
        samples = len(host.samples)
        host = self.wait_for(lambda host: host.online and len(host.samples) > samples + 10, consumer, forwarder, broker)
        self.assertEqual(host.bd_seq, 1, "the number of the connection continues after a restart")
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        host = self.wait_for(lambda host: not host.online, consumer, forwarder, broker)
        self.assertEqual(host.faults, [])
        self.assertEqual(self.kinds(host).count("NDEATH"), 2, self.explained(forwarder, broker)())
        self.decode_again(consumer)

    def test_a_host_writes_a_channel_if_commands_are_allowed(self):
        broker, consumer, forwarder = self.start(commands='commands: { user: scada, allow: [{ user: scada, channels: ["line/*/setpoint"] }] }\n')
        host = self.wait_for(lambda host: len(host.births) == 2 and len(host.samples) > 10, consumer, forwarder, broker)
        press = host.births["line:press.1"]
        self.assertFalse(press["setpoint"].properties["readOnly"])
        self.assertTrue(press["temperature"].properties["readOnly"])
        topic = "spBv1.0/plants/DCMD/north/line:press.1"

        def command(value, at_ms=None):
            return sparkplug.device_command(press["setpoint"].alias, value, int(at_ms or time.time() * 1000))

        def wait_for_value(value):
            self.wait_for(lambda host: any(sample.name == "setpoint" and sample.value == value for sample in host.samples), consumer, forwarder, broker)

        def wait_for_log(text):
            wait_until(lambda: text in forwarder.log(), 20, self.explained(forwarder, broker))
        first = command(-42)
        broker.publish(topic, first)
        wait_for_value(-42)
        if NODE and os.path.isdir(os.path.join(NODE_MODULES, "sparkplug-payload")):
            encoded = subprocess.run([NODE, os.path.join(SOURCE_DIR, "tests/tools/forward/sparkplug-decoder/encode.mjs"), NODE_MODULES], check=True, capture_output=True,
                                     input=json.dumps({"timestamp": int(time.time() * 1000), "metrics": [{"name": "setpoint", "type": "Int16", "value": 43}]}).encode())
            broker.publish(topic, encoded.stdout)
        else:
            broker.publish(topic, command(43))
        wait_for_value(43)
        # A repeated message is not run again, an old one and one without a right are refused.
        broker.publish(topic, first)
        broker.publish(topic, command(44, (time.time() - 60) * 1000))
        wait_for_log("the command is older than the birth of the device")
        broker.publish("spBv1.0/plants/DCMD/north/line:mill", sparkplug.device_command(host.births["line:mill"]["level"].alias, 1, int(time.time() * 1000)))
        wait_for_log("user 'scada' has no right to write line/mill/level at this site")
        watched = plant.cli("watch", "line/press.1/setpoint", "--once", "--json").json_lines()
        self.assertEqual([sample["value"] for sample in watched if "value" in sample][-1:], [43])
        self.assertEqual(self.host(consumer).faults, [])

    def decode_again(self, consumer):
        """The package of Eclipse Tahu decodes the same."""
        if not NODE or not os.path.isdir(os.path.join(NODE_MODULES, "sparkplug-payload")):
            print("the second decoder is skipped: no node, or no npm package sparkplug-payload")
            return
        messages = [message for message in consumer.received() if "/NCMD/" not in message.topic and "/DCMD/" not in message.topic]
        done = subprocess.run([NODE, os.path.join(SOURCE_DIR, "tests/tools/forward/sparkplug-decoder/decode.mjs"), NODE_MODULES],
                              input="".join(message.payload.hex() + "\n" for message in messages), capture_output=True, text=True, check=True)
        names = {1: "Int8", 2: "Int16", 3: "Int32", 4: "Int64", 5: "UInt8", 6: "UInt16", 8: "UInt64", 9: "Float", 10: "Double", 11: "Boolean", 12: "String"}
        types, values = {}, 0
        for message, line in zip(messages, done.stdout.splitlines(), strict=True):
            ours, theirs = sparkplug.Payload(message.payload, types), json.loads(line)
            self.assertEqual((ours.seq, ours.timestamp), (theirs.get("seq"), theirs["timestamp"]))
            for one, other in zip(ours.metrics, theirs.get("metrics", []), strict=True):
                self.assertEqual((one.name, one.alias, one.timestamp), (other.get("name"), other.get("alias"), other["timestamp"]))
                self.assertEqual(one.properties, {key: item["value"] for key, item in other.get("properties", {}).items()})
                if one.datatype is not None:  # of a birth
                    types[one.alias] = one.datatype
                    self.assertEqual((names[one.datatype], one.value), (other["type"], other["value"]))
                    values += one.value is not None
        self.assertGreater(values, 8)

    def test_records_wait_for_the_primary_host(self):
        broker, consumer, forwarder = self.start(", primary-host: scada")

        def state(online, timestamp):
            broker.publish("spBv1.0/STATE/scada", json.dumps({"online": online, "timestamp": timestamp}).encode(), "-r", "-q", "1")
        wait_until(lambda: "connected to" in forwarder.log(), 20, self.explained(forwarder, broker))
        time.sleep(3)
        self.assertEqual(self.kinds(self.host(consumer)), [], "the host is not online")
        state(True, 1000)
        host = self.wait_for(lambda host: len(host.samples) > 30, consumer, forwarder, broker)
        self.assertTrue(any(sample.is_historical for sample in host.samples), "they waited for more than a second")
        state(False, 999)
        time.sleep(1)
        self.assertTrue(self.host(consumer).online, "the will of an earlier session of the host")
        state(False, 1000)
        host = self.wait_for(lambda host: not host.online, consumer, forwarder, broker)
        samples = len(host.samples)
        time.sleep(3)
        self.assertEqual(len(self.host(consumer).samples), samples)
        state(True, 2000)
        host = self.wait_for(lambda host: host.online and len(host.samples) > samples + 60, consumer, forwarder, broker)
        self.assertEqual(host.faults, [])
        self.assertGreaterEqual(host.bd_seq, 1)
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        # No gap: the temperature changes at each reading, about 200 ms.
        times = sorted({sample.timestamp for sample in self.host(consumer).samples if sample.name == "temperature"})
        self.assertLess(max(after - before for before, after in zip(times, times[1:])), 1500)


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR, NODE_MODULES = sys.argv[1:4]
    if reason := mosquitto.reason_to_skip():
        print(reason)
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
