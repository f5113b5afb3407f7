// Reads the payloads that to_json() makes. Pure; the text is untrusted.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

// Samples with the names of their channels. In `batch`, `channel` is not set.
struct NamedSamples {
  SampleBatch batch;
  std::vector<std::string> channels;  // of each sample
};

class JsonPayload {
 public:
  // Empty for a text that is not a JSON object.
  [[nodiscard]] static std::optional<JsonPayload> parse(std::string_view text);

  // The version of the message; empty if it has none.
  [[nodiscard]] std::optional<std::uint64_t> schema() const;

  // Empty if a member is missing or has another type. A sample without a value, which was not a
  // finite number, has the value 0.
  [[nodiscard]] std::optional<NamedSamples> samples() const;
  [[nodiscard]] std::optional<DeviceCatalogue> catalogue() const;
  [[nodiscard]] std::optional<StationAlarmStatus> alarm() const;

 private:
  explicit JsonPayload(nlohmann::json tree) : tree_(std::move(tree)) {}

  nlohmann::json tree_;
};

}  // namespace fieldcast::forward
