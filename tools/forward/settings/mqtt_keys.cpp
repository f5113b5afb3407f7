#include "tools/forward/settings/mqtt_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::Field;
using config::MapReader;
using config::Node;
using config::Rows;

constexpr std::size_t kMostMqttServers = 16;
constexpr Duration kLeastMqttWait = std::chrono::seconds{1};
constexpr Duration kMostMqttWait = std::chrono::minutes{5};
constexpr std::string_view kMqttServerForm = "mqtt://HOST:PORT or mqtts://HOST:PORT";
constexpr std::pair<std::string_view, MqttVersion> kMqttVersions[] = {{"5", MqttVersion::k5},
                                                                      {"3.1.1", MqttVersion::k311}};

void read_servers(MapReader& map, MqttServers& spec) {
  const Node* node = map.find("servers");
  if (node == nullptr) return;
  if (!config::is_list(*node, "servers", 1, kMostMqttServers,
                       fmt::format("a list of 1 to {}, each {}", kMostMqttServers, kMqttServerForm),
                       map.faults(), config::as_list(*node)))
    return;
  spec.servers.clear();
  for (const Node* item : node->items) {
    const std::string* text = config::scalar_of(*item, "server", kMqttServerForm, map.faults());
    if (text == nullptr) continue;
    const auto address = server_address_from(*text, kMqttSchemes);
    if (!address) {
      map.faults().add(item->position, address.error(), kMqttServerForm);
      continue;
    }
    if (!address->tls && !address->on_loopback && !spec.without_tls) {
      map.faults().add(item->position,
                       fmt::format("server '{}' is off this machine and without TLS", *text),
                       "mqtts://HOST:PORT, or without-tls: true if the network is trusted",
                       "mqtts" + text->substr(text->find("://")));
    }
    spec.servers.push_back({address->host, address->port, address->tls});
  }
}

// The file must exist; the access to its content is checked when it is used.
void read_files(MapReader& map, MqttServers& spec, config::Library& library) {
  for (const auto& [key, target] :
       {std::pair{"authority", &spec.authority}, std::pair{"certificate", &spec.certificate},
        std::pair{"key", &spec.key}, std::pair{"password-file", &spec.password_file}}) {
    std::string path;
    if (map.read(key, path, config::TextRule{config::kMaxPath}))
      *target = library.check_file(*map.find(key));
  }
}

void check_login(MapReader& map, const MqttServers& spec) {
  const auto both = [&map](const char* a, const char* b, bool has_a, bool has_b) {
    if (has_a == has_b) return;
    map.fault(has_a ? a : b, fmt::format("'{}' without '{}'", has_a ? a : b, has_a ? b : a),
              "both");
  };
  both("certificate", "key", !spec.certificate.empty(), !spec.key.empty());
  both("user", "password-file", !spec.user.empty(), !spec.password_file.empty());
  const bool uses_tls = std::any_of(spec.servers.begin(), spec.servers.end(),
                                    [](const MqttServer& server) { return server.tls; });
  if (!uses_tls && (!spec.authority.empty() || !spec.certificate.empty()))
    map.fault("servers", "'authority' or 'certificate' without a server mqtts://HOST:PORT",
              "servers: [mqtts://HOST:PORT]");
}

// One level of a topic.
void check_level(MapReader& map, const char* key, const std::string& text) {
  if (text.find_first_of("+#/$") == text.npos) return;
  map.fault(key, fmt::format("{} '{}' contains '+', '#', '/' or '$'", key, text),
            "letters, digits, '-', '_' and '.'");
}

// The keys of the connection, before those of the section.
template <class Spec>
std::vector<Field<Spec>> with_servers(std::vector<Field<Spec>> own) {
  const auto text = [](const char* name, const char* fallback, const char* what) {
    return Field<Spec>{{.name = name, .fallback = fallback, .text = what, .schema = "{}"}};
  };
  std::vector<Field<Spec>> all{
      text("servers", "`[mqtt://127.0.0.1:1883]`",
           "tried in turn, each `mqtt://HOST:PORT` or `mqtts://HOST:PORT`; off this machine with "
           "TLS"),
      text("authority", "those of the system",
           "a PEM file with the authorities of the servers' certificates"),
      text("certificate", "none", "a PEM file with the certificate of this client"),
      text("key", "none", "a PEM file with its private key"),
      field<Spec>({.name = "user", .fallback = "none", .text = "with `password-file`"}, &Spec::user,
                  config::TextRule{256}),
      text("password-file", "none", "a file whose first line is the password"),
      field<Spec>(
          {.name = "without-tls",
           .fallback = "`false`",
           .text = "allows `mqtt://` off this machine: values and the login are readable in "
                   "the network"},
          &Spec::without_tls, config::FlagRule{}),
      field<Spec>({.name = "version",
                   .fallback = "`5`",
                   .text = "of MQTT: `5` or `3.1.1`; with 3.1.1 a server cannot report that it "
                           "refuses a message"},
                  &Spec::version, config::ChoiceRule<MqttVersion>{kMqttVersions}),
      field<Spec>({.name = "client-id",
                   .fallback = "`fieldcast-forward-SITE`",
                   .text = "a server disconnects an older client with the same one"},
                  &Spec::client_id, config::NameRule{}),
      field<Spec>({.name = "acknowledgement",
                   .fallback = "`5s`",
                   .text = "without an acknowledgement in this time, the connection is made again, "
                           "and the messages are sent again"},
                  &Spec::acknowledgement, config::DurationRule{kLeastMqttWait, kMostMqttWait}),
  };
  for (Field<Spec>& each : own) all.push_back(std::move(each));
  return all;
}

const Rows<MqttSpec>& mqtt_rows() {
  static const Rows<MqttSpec> rows(
      "mqtt", "'mqtt'",
      with_servers<MqttSpec>({
          field<MqttSpec>({.name = "prefix",
                           .fallback = "`fieldcast`",
                           .text = "begins the first level of all topics"},
                          &MqttSpec::prefix, config::NameRule{}),
          field<MqttSpec>(
              {.name = "retain",
               .fallback = "`false`",
               .text = "the server keeps the last value of each channel, and sends it to "
                       "new subscribers"},
              &MqttSpec::retain, config::FlagRule{}),
          field<MqttSpec>({.name = "discovery",
                           .fallback = "`false`",
                           .text = "publishes messages by which Home Assistant finds the channels"},
                          &MqttSpec::discovery, config::FlagRule{}),
          field<MqttSpec>({.name = "discovery-prefix",
                           .fallback = "`homeassistant`",
                           .text = "the first level of their topics"},
                          &MqttSpec::discovery_prefix, config::NameRule{}),
      }));
  return rows;
}

const Rows<SparkplugSpec>& sparkplug_rows() {
  static const Rows<SparkplugSpec> rows(
      "sparkplug", "'sparkplug'",
      with_servers<SparkplugSpec>({
          field<SparkplugSpec>({.name = "group", .fallback = "`fieldcast`", .text = "the group id"},
                               &SparkplugSpec::group, config::NameRule{}),
          field<SparkplugSpec>({.name = "edge-node",
                                .fallback = "the name of the site",
                                .text = "the edge node id; unique in the group"},
                               &SparkplugSpec::edge_node, config::NameRule{}),
          field<SparkplugSpec>({.name = "primary-host",
                                .fallback = "none",
                                .text = "the id of the host application for which the queue waits "
                                        "while it is offline"},
                               &SparkplugSpec::primary_host, config::TextRule{256}),
          field<SparkplugSpec>(
              {.name = "qos",
               .fallback = "`0`",
               .text = "of messages with data: `0` as the specification demands, or "
                       "`1`"},
              &SparkplugSpec::qos, config::WholeRule{0, 1}),
      }));
  return rows;
}

template <class Spec>
Spec read(MapReader& map, const Rows<Spec>& rows, config::Library& library) {
  Spec spec;
  rows.read(map, spec);
  read_servers(map, spec);
  read_files(map, spec, library);
  check_login(map, spec);
  return spec;
}

}  // namespace

OutletSpec read_mqtt(MapReader& file, const Node& section, config::Library& library) {
  MapReader map(section, mqtt_rows(), file.faults());
  return read(map, mqtt_rows(), library);
}

void document_mqtt(const AddKeys& add) { add("mqtt.", mqtt_rows()); }

OutletSpec read_sparkplug(MapReader& file, const Node& section, config::Library& library) {
  MapReader map(section, sparkplug_rows(), file.faults());
  SparkplugSpec spec = read(map, sparkplug_rows(), library);
  check_level(map, "primary-host", spec.primary_host);
  return spec;
}

void document_sparkplug(const AddKeys& add) { add("sparkplug.", sparkplug_rows()); }

}  // namespace fieldcast::forward
