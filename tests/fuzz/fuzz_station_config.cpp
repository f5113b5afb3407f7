// Fuzzes the configuration of fieldcast-station and its addresses. A text is valid or has faults
// with place and reason.
//
// Input: the text.
#include <cstdlib>

#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/station/settings/configuration.hpp"

namespace fieldcast::web {
namespace {

void run_one(ByteView data) {
  const std::string text(data.begin(), data.end());
  config::FileReader nothing;
  nothing.read = [](const std::string&) -> tl::expected<std::string, config::FileError> {
    return tl::unexpected(config::FileError::kMissing);
  };
  if (const auto listen = listen_from(text); listen && listen->host.empty()) std::abort();
  const auto loaded = load_station_text(text, "station.yaml", nothing);
  if (loaded) {
    (void)exposures_of(*loaded);
    return;
  }
  if (loaded.error().empty()) std::abort();
  for (const config::Fault& fault : loaded.error()) {
    if (fault.what.empty() || fault.line < 1 || fault.column < 1 ||
        to_text(fault).find('\n') != std::string::npos)
      std::abort();
  }
}

}  // namespace
}  // namespace fieldcast::web

FIELDCAST_FUZZ_TARGET(fieldcast::web::run_one)
