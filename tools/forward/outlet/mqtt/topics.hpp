// Topics of plain MQTT. Pure.
#pragma once

#include <string>
#include <string_view>

#include "tools/forward/batch/record.hpp"
#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

// One level of a topic: each byte that is not an ASCII letter, a digit, '-', '_' or '.' becomes
// "=2F". "=" for an empty name.
[[nodiscard]] std::string topic_level(std::string_view name);

// "PREFIX/SITE/BUS/DEVICE", with "PREFIX-late" for late samples.
[[nodiscard]] std::string sample_topics(std::string_view prefix, std::string_view site,
                                        const Record& record);
// "PREFIX-alarm/SITE/BUS/DEVICE/CHANNEL/high".
[[nodiscard]] std::string audit_topic(std::string_view prefix, std::string_view site,
                                      std::string_view bridge);
[[nodiscard]] std::string alarm_topic(std::string_view prefix, std::string_view site,
                                      const AlarmKey& alarm);
// "PREFIX-catalogue/SITE/BUS/DEVICE".
[[nodiscard]] std::string catalogue_topic(std::string_view prefix, std::string_view site,
                                          const Record& record);
// "PREFIX-status/SITE": "online" or "offline".
[[nodiscard]] std::string status_topic(std::string_view prefix, std::string_view site);
// "PREFIX-status/SITE/BUS/DEVICE": the same for a device.
[[nodiscard]] std::string device_status_topic(std::string_view prefix, std::string_view site,
                                              std::string_view bus, std::string_view device);
// "PREFIX-site/SITE".
[[nodiscard]] std::string site_topic(std::string_view prefix, std::string_view site);

}  // namespace fieldcast::forward
