#pragma once

#include <optional>

#include "config/document/map_reader.hpp"
#include "core/model/store_spec.hpp"

namespace fieldcast::config {

void read_store(MapReader& bridge, std::optional<StoreSpec>& spec);

// Size of the store: a whole number with MB, GB or TB.
struct StoreSizeRule {
  std::optional<std::int64_t> operator()(const Node& node, std::string_view key,
                                         FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// Retention of samples; 0: unlimited.
struct KeepRule {
  std::optional<Duration> operator()(const Node& node, std::string_view key,
                                     FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config
