// The `store` section: where samples, users and the audit are kept, and for how long.
#pragma once

#include <optional>

#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

void read_store(MapReader& bridge, std::optional<StoreSpec>& spec);

// A size of the store: a whole number with MB, GB or TB.
struct StoreSizeRule {
  std::optional<std::int64_t> operator()(const Node& node, std::string_view key,
                                         FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// How long samples are kept; 0: for ever.
struct KeepRule {
  std::optional<Duration> operator()(const Node& node, std::string_view key,
                                     FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config
