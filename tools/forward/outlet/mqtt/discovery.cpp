#include "tools/forward/outlet/mqtt/discovery.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/base/json.hpp"
#include "tools/forward/outlet/mqtt/topics.hpp"

namespace fieldcast::forward {

namespace {

// Units that Home Assistant accepts for exactly one device class
// (https://developers.home-assistant.io/docs/core/entity/sensor/#available-device-classes).
constexpr std::pair<std::string_view, std::string_view> kClasses[] = {
    {"°C", "temperature"},
    {"°F", "temperature"},
    {"K", "temperature"},
    {"bar", "pressure"},
    {"mbar", "pressure"},
    {"kPa", "pressure"},
    {"hPa", "pressure"},
    {"psi", "pressure"},
    {"V", "voltage"},
    {"mV", "voltage"},
    {"A", "current"},
    {"mA", "current"},
    {"W", "power"},
    {"kW", "power"},
    {"MW", "power"},
    {"Wh", "energy"},
    {"kWh", "energy"},
    {"MWh", "energy"},
    {"VA", "apparent_power"},
    {"var", "reactive_power"},
    {"Hz", "frequency"},
    {"kHz", "frequency"},
    {"m³/h", "volume_flow_rate"},
    {"L/min", "volume_flow_rate"},
    {"lx", "illuminance"},
    {"W/m²", "irradiance"},
    {"kg", "weight"},
};

// Of Home Assistant: letters, digits, '_' and '-'.
std::string object_id(std::string_view site, const StationChannel& channel) {
  std::string id = fmt::format("fieldcast_{}_{}_{}_{}", topic_level(site), topic_level(channel.bus),
                               topic_level(channel.device), topic_level(channel.channel));
  // '=' and '.' are not allowed; "-3D" and "-2E" keep different names apart in all usual cases.
  std::string plain;
  for (const char c : id) {
    if (c == '.') {
      plain += "-2E";
    } else {
      plain += c == '=' ? '-' : c;
    }
  }
  return plain;
}

std::string config_of(const MqttSpec& spec, std::string_view site, const StationChannel& channel,
                      const std::string& id, bool is_binary) {
  const std::string topic =
      fmt::format("{}/{}/{}/{}/{}", spec.prefix, topic_level(site), topic_level(channel.bus),
                  topic_level(channel.device), topic_level(channel.channel));
  Json config{
      {"name", channel.channel},
      {"unique_id", id},
      {"state_topic", topic},
      {"availability",
       std::vector<Json>{
           Json{{"topic", status_topic(spec.prefix, site)}},
           Json{{"topic", device_status_topic(spec.prefix, site, channel.bus, channel.device)}},
           Json{{"topic", topic},
                {"value_template",
                 "{{ 'online' if value_json.quality in ['GOOD', 'UNCERTAIN'] else "
                 "'offline' }}"}}}},
      {"availability_mode", "all"},
      {"device", Json{{"identifiers", std::vector<std::string>{fmt::format(
                                          "fieldcast_{}_{}_{}", topic_level(site),
                                          topic_level(channel.bus), topic_level(channel.device))}},
                      {"name", fmt::format("{} {}", channel.bus, channel.device)}}}};
  if (is_binary) {
    config.add("value_template", "{{ 'ON' if value_json.value else 'OFF' }}");
    return config.text();
  }
  config.add("value_template", "{{ value_json.value }}");
  if (!channel.unit.empty()) config.add("unit_of_measurement", channel.unit);
  if (const std::string_view kind = device_class_of(channel.unit); !kind.empty())
    config.add("device_class", kind);
  return config.text();
}

}  // namespace

std::string_view device_class_of(std::string_view unit) {
  for (const auto& [text, kind] : kClasses) {
    if (text == unit) return kind;
  }
  return {};
}

std::vector<MqttMessage> discovery_messages(const MqttSpec& spec, std::string_view site,
                                            const DeviceCatalogue& catalogue) {
  std::vector<MqttMessage> messages;
  for (const StationChannel& channel : catalogue.channels) {
    const bool is_binary = channel.type == "bool";
    const std::string id = object_id(site, channel);
    messages.push_back({fmt::format("{}/{}/{}/config", spec.discovery_prefix,
                                    is_binary ? "binary_sensor" : "sensor", id),
                        config_of(spec, site, channel, id, is_binary), 1, true});
  }
  return messages;
}

}  // namespace fieldcast::forward
