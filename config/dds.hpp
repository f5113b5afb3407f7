// The `dds` and `log` sections, which every program of a plant has alike, and the `sites` of a
// program that watches several domains.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/library.hpp"
#include "config/map_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// Bytes a second: "500kB/s", "2MB/s".
struct RateRule {
  std::optional<std::uint64_t> operator()(const Node& node, std::string_view key,
                                          FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// Faults are noted; what is absent keeps its default.
void read_dds(MapReader& file, DdsSpec& spec, Library& library);
void read_log(MapReader& file, LogSpec& spec);
// `sites`, or the one without a name that `dds` says. REQUIRES: the table of the file has both
// keys.
[[nodiscard]] std::vector<DdsSite> read_sites(MapReader& file, Library& library);

}  // namespace fieldcast::config
