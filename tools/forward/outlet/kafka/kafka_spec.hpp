// How a forwarder reaches a Kafka cluster. A plain value.
#pragma once

#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast::forward {

// SASL, by the names of librdkafka.
enum class KafkaMechanism : std::uint8_t { kScramSha512, kScramSha256, kPlain };

struct KafkaTopics {
  std::string samples = "fieldcast", late_samples = "fieldcast-late", alarms = "fieldcast-alarm",
              catalogues = "fieldcast-catalogue", audit = "fieldcast-audit";
  friend bool operator==(const KafkaTopics&, const KafkaTopics&) = default;
};

struct KafkaSpec {
  std::vector<std::string> servers{"kafka://127.0.0.1:9092"};
  std::string authority;  // PEM file that signed the brokers' certificates; empty: the system's
  std::string certificate, key;  // PEM files of this client
  std::string user, password_file;
  KafkaMechanism mechanism = KafkaMechanism::kScramSha512;
  bool without_tls = false;  // plain text off the loopback, explicitly configured
  Duration acknowledgement = std::chrono::seconds{30};  // then a message is sent again
  KafkaTopics topics;
  friend bool operator==(const KafkaSpec&, const KafkaSpec&) = default;
};

}  // namespace fieldcast::forward
