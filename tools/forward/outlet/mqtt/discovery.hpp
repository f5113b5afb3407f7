// Messages by which Home Assistant finds the channels (MQTT discovery:
// https://www.home-assistant.io/integrations/mqtt/#mqtt-discovery). Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/forward/batch/sample_batch.hpp"
#include "tools/forward/outlet/mqtt/mqtt_client.hpp"

namespace fieldcast::forward {

// The device class of a sensor with this unit. Empty if the unit does not name it alone: "%" is
// a humidity, a battery or a valve.
[[nodiscard]] std::string_view device_class_of(std::string_view unit);

// One retained message for each channel: a binary sensor for a bool, otherwise a sensor.
[[nodiscard]] std::vector<MqttMessage> discovery_messages(const MqttSpec& spec,
                                                          std::string_view site,
                                                          const DeviceCatalogue& catalogue);

}  // namespace fieldcast::forward
