"""Sparkplug B over mosquitto. A payload contains neither epoch nor sequence: a sample is identified by its channel, the millisecond of
its acquisition, and whether it is good, because a value that becomes uncertain keeps its time. The contract test takes this number as the
sequence (key_of). Bad values are null and without the kind of the fault: they are not compared."""

import outlets.mqtt
import sparkplug

QUALITIES = {192: "GOOD", 500: "UNCERTAIN"}


class Engine(outlets.mqtt.Engine):
    name = "sparkplug"
    has_unique_samples = False  # a message is sent again if its confirmation was lost
    TOPICS = ("spBv1.0/#",)

    def __init__(self, folder, port):
        super().__init__(folder, port)
        self.host = sparkplug.Host()
        self.seen = 0

    @staticmethod
    def key_of(sample):
        if sample["quality"] not in QUALITIES.values():
            return None
        return sample["acquired_at"] // 1_000_000 * 2 + (sample["quality"] != "GOOD")

    def samples(self):
        if self.consumer is None:
            return []
        messages = self.consumer.received()
        for message in messages[self.seen:]:
            self.host.on_message(message.topic, message.payload)
        self.seen = len(messages)
        return [(sample.device.replace(":", "/") + "/" + sample.name, "", sample.timestamp * 2 + (sample.quality != 192), sample.value, QUALITIES[sample.quality])
                for sample in self.host.samples if sample.quality in QUALITIES and not sample.name.startswith("Alarms/")]

    def refuse_one(self):
        """DBIRTH of the device with more channels is larger than this limit of the server."""
        self.stop()
        self.broker.set_limit(250)
        self.start()
        return "limits the size of a packet"
