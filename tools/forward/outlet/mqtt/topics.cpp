#include "tools/forward/outlet/mqtt/topics.hpp"

#include <fmt/format.h>

namespace fieldcast::forward {

namespace {

std::string device_topic(std::string_view prefix, std::string_view site, std::string_view bus,
                         std::string_view device) {
  return fmt::format("{}/{}/{}/{}", prefix, topic_level(site), topic_level(bus),
                     topic_level(device));
}

}  // namespace

std::string topic_level(std::string_view name) {
  if (name.empty()) return "=";
  std::string level;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    if (is_plain) {
      level += c;
    } else {
      level += fmt::format("={:02X}", static_cast<unsigned char>(c));
    }
  }
  return level;
}

std::string sample_topics(std::string_view prefix, std::string_view site, const Record& record) {
  return device_topic(fmt::format("{}{}", prefix, record.is_late ? "-late" : ""), site, record.bus,
                      record.device);
}

std::string alarm_topic(std::string_view prefix, std::string_view site, const AlarmKey& alarm) {
  return fmt::format("{}/{}/{}",
                     device_topic(fmt::format("{}-alarm", prefix), site, alarm.bus, alarm.device),
                     topic_level(alarm.channel), to_text(alarm.limit));
}

std::string audit_topic(std::string_view prefix, std::string_view site, std::string_view bridge) {
  return fmt::format("{}-audit/{}/{}", prefix, topic_level(site), topic_level(bridge));
}

std::string catalogue_topic(std::string_view prefix, std::string_view site, const Record& record) {
  return device_topic(fmt::format("{}-catalogue", prefix), site, record.bus, record.device);
}

std::string status_topic(std::string_view prefix, std::string_view site) {
  return fmt::format("{}-status/{}", prefix, topic_level(site));
}

std::string device_status_topic(std::string_view prefix, std::string_view site,
                                std::string_view bus, std::string_view device) {
  return device_topic(fmt::format("{}-status", prefix), site, bus, device);
}

std::string site_topic(std::string_view prefix, std::string_view site) {
  return fmt::format("{}-site/{}", prefix, topic_level(site));
}

}  // namespace fieldcast::forward
