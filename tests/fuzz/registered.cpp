#include "tests/fuzz/registered.hpp"

#include <cstdlib>
#include <string_view>

#include "core/protocol/families/registry.hpp"
#include "tests/fuzz/any_protocol.hpp"

namespace fieldcast::fuzz {
namespace {

std::unique_ptr<Protocol> make(const ProtocolEntry& entry, std::string_view option,
                               const char* value) {
  DeviceLink link{.address = 1};
  if (!option.empty()) link.options[std::string(option)] = value;
  auto made = entry.make(link);
  if (!made) std::abort();
  return std::move(*made);
}

}  // namespace

void run_registered(const char* name, const char* option, const char* value,
                    const std::uint8_t* data, std::size_t size) {
  static const ProtocolEntry& entry = *find_protocol(name);
  static const std::unique_ptr<Protocol> protocol = make(entry, option, value);
  run_protocol(*protocol, entry.explain, ByteView(data, size));
}

}  // namespace fieldcast::fuzz
