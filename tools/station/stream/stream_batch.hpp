// Samples of one message of the stream, with their catalogue. A plain value.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/base/time.hpp"
#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::web {

// Names of buses have the site before them, as all names of a station with several sites:
// "north:line".
using SharedCatalogue = std::shared_ptr<const forward::DeviceCatalogue>;

struct StreamBatch {
  std::string site;
  bool is_late = false;
  UtcTime stored_at;             // when the server has stored it, by the server's clock
  forward::SampleBatch samples;  // each `channel` is an index in `catalogue`
  SharedCatalogue catalogue;
};

[[nodiscard]] inline std::string bus_of_site(const std::string& site, const std::string& bus) {
  return site + ':' + bus;
}

}  // namespace fieldcast::web
