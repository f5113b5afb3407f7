#include "tools/forward/settings/kafka_keys.hpp"

#include "config/document/scalars.hpp"
#include "tools/forward/settings/login_keys.hpp"
#include "tools/forward/settings/servers_key.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::MapReader;
using config::Node;
using config::Rows;

constexpr std::pair<std::string_view, KafkaMechanism> kMechanisms[] = {
    {"scram-sha-512", KafkaMechanism::kScramSha512},
    {"scram-sha-256", KafkaMechanism::kScramSha256},
    {"plain", KafkaMechanism::kPlain}};

const Rows<KafkaTopics>& topic_rows() {
  const auto topic = [](const char* name, const char* fallback, const char* what,
                        std::string KafkaTopics::*target) {
    return field<KafkaTopics>({.name = name, .fallback = fallback, .text = what}, target,
                              config::NameRule{});
  };
  static const Rows<KafkaTopics> rows(
      "topics", "'topics'",
      {
          topic("samples", "`fieldcast`", "of samples", &KafkaTopics::samples),
          topic("late-samples", "`fieldcast-late`", "of late samples", &KafkaTopics::late_samples),
          topic("alarms", "`fieldcast-alarm`", "of alarms", &KafkaTopics::alarms),
          topic("catalogues", "`fieldcast-catalogue`", "of catalogues; a compacted topic",
                &KafkaTopics::catalogues),
          topic("audit", "`fieldcast-audit`", "of the audit", &KafkaTopics::audit),
      });
  return rows;
}

const Rows<KafkaSpec>& kafka_rows() {
  const auto other = [](const char* name, const char* fallback, const char* what) {
    return config::Field<KafkaSpec>{
        {.name = name, .fallback = fallback, .text = what, .schema = "{}"}};
  };
  static const Rows<KafkaSpec> rows(
      "kafka", "'kafka'",
      {
          other("servers", "`[kafka://127.0.0.1:9092]`",
                "of one cluster, each `kafka://HOST:PORT` or `tls://HOST:PORT`; off this machine "
                "with TLS"),
          other("authority", "those of the system",
                "a PEM file with the authorities of the brokers' certificates"),
          other("certificate", "none", "a PEM file with the certificate of this client"),
          other("key", "none", "a PEM file with its private key"),
          field<KafkaSpec>({.name = "user", .fallback = "none", .text = "with `password-file`"},
                           &KafkaSpec::user, config::TextRule{256}),
          other("password-file", "none", "a file whose first line is the password"),
          field<KafkaSpec>({.name = "mechanism",
                            .fallback = "`scram-sha-512`",
                            .text = "how the password is proved (SASL)"},
                           &KafkaSpec::mechanism, config::ChoiceRule<KafkaMechanism>{kMechanisms}),
          field<KafkaSpec>({.name = "without-tls",
                            .fallback = "`false`",
                            .text = "allows `kafka://` off this machine: values are readable in "
                                    "the network, with `plain` also the password"},
                           &KafkaSpec::without_tls, config::FlagRule{}),
          field<KafkaSpec>({.name = "acknowledgement",
                            .fallback = "`30s`",
                            .text = "a message without an acknowledgement in this time is sent "
                                    "again"},
                           &KafkaSpec::acknowledgement,
                           config::DurationRule{std::chrono::seconds{1}, std::chrono::minutes{5}}),
          other("topics", "", "their names; create them before, or let the brokers create them"),
      });
  return rows;
}

// The library uses one transport for all brokers.
void check_transport(MapReader& map, const KafkaSpec& spec) {
  bool has_tls = false, has_plain = false;
  for (const std::string& server : spec.servers)
    (server.starts_with("tls://") ? has_tls : has_plain) = true;
  if (has_tls && has_plain)
    map.fault("servers", "servers with and without TLS", "kafka:// for all, or tls:// for all");
  if (!has_tls && (!spec.authority.empty() || !spec.certificate.empty()))
    map.fault("servers", "'authority' or 'certificate' without a server tls://HOST:PORT",
              "servers: [tls://HOST:PORT]");
}

}  // namespace

OutletSpec read_kafka(MapReader& file, const Node& section, config::Library& library) {
  KafkaSpec spec;
  MapReader map(section, kafka_rows(), file.faults());
  kafka_rows().read(map, spec);
  read_servers(map, "kafka", spec.without_tls, spec.servers);
  read_files(map, library,
             {{"authority", &spec.authority},
              {"certificate", &spec.certificate},
              {"key", &spec.key},
              {"password-file", &spec.password_file}});
  check_pair(map, "certificate", spec.certificate, "key", spec.key, "both, as PEM files");
  check_pair(map, "user", spec.user, "password-file", spec.password_file, "both");
  check_transport(map, spec);
  topic_rows().read_section(map, "topics", spec.topics);
  return spec;
}

void document_kafka(const AddKeys& add) {
  add("kafka.", kafka_rows());
  add("kafka.topics.", topic_rows());
}

}  // namespace fieldcast::forward
