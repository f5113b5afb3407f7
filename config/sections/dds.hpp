// The `dds` and `log` sections, and the `sites` of a program that uses several domains.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// Bytes per second: "500kB/s", "2MB/s".
struct RateRule {
  std::optional<std::uint64_t> operator()(const Node& node, std::string_view key,
                                          FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// Add faults; absent keys keep their defaults.
void read_dds(MapReader& file, DdsSpec& spec, Library& library);
void read_log(MapReader& file, LogSpec& spec);
// Without `sites`, returns one site without a name. REQUIRES: the table has both keys.
[[nodiscard]] std::vector<DdsSite> read_sites(MapReader& file, Library& library);

}  // namespace fieldcast::config
