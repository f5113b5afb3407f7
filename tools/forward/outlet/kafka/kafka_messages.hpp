// Topics and keys of the messages. Pure.
#pragma once

#include <string>
#include <string_view>

#include "tools/forward/batch/record.hpp"
#include "tools/forward/outlet/kafka/kafka_spec.hpp"

namespace fieldcast::forward {

[[nodiscard]] const std::string& topic_of(const KafkaTopics& topics, const Record& record);

// "SITE/BUS/DEVICE": all messages of a device are in one partition, and so in order. Of a catalogue
// also its identity, so that a compacted topic keeps each one.
[[nodiscard]] std::string key_of(std::string_view site, const Record& record);

}  // namespace fieldcast::forward
