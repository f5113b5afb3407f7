// Fuzzes the configuration loader: any texts as a configuration and the files that it may name.
//
// Input: up to four texts separated by a zero byte: plant.yaml, list.csv, devices/kind.yaml,
// protocols/mine.yaml.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>

#include "config/loader/loader.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

constexpr std::array<const char*, 4> kFiles{"plant.yaml", "list.csv", "devices/kind.yaml",
                                            "protocols/mine.yaml"};

void run_one(ByteView data) {
  std::map<std::string, std::string> files;
  for (const char* name : kFiles) {
    const auto zero = std::find(data.begin(), data.end(), std::uint8_t{0});
    files[name] = std::string(data.begin(), zero);
    if (zero == data.end()) break;
    data = data.subspan(static_cast<std::size_t>(zero - data.begin()) + 1);
  }
  config::FileReader reader;
  reader.read = [&](const std::string& path) -> tl::expected<std::string, config::FileError> {
    const auto file = files.find(path);
    if (file == files.end()) return tl::unexpected(config::FileError::kMissing);
    return file->second;
  };
  const auto loaded = config::load_text(files["plant.yaml"], "plant.yaml", reader);
  if (!loaded) {
    if (loaded.error().empty()) std::abort();
    for (const config::Fault& fault : loaded.error()) {
      if (fault.what.empty() || fault.line < 1 || fault.column < 1 ||
          to_text(fault).find('\n') != std::string::npos)
        std::abort();
    }
    return;
  }
  if (loaded->buses.empty()) std::abort();
  for (const BusSpec& bus : loaded->buses) {
    for (const DeviceSpec& device : bus.devices) {
      // Assumption of the engine: each device has a protocol.
      const auto made = device.declaration ? declared::make(device.declaration.value, device.link)
                                           : find_protocol(device.protocol)->make(device.link);
      if (!made) std::abort();
    }
  }
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
