// Fuzzes address notations, which commands carry from the network: any text for every protocol.
//
// Input: the text.
#include <cstdlib>

#include "config/loader/loader.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

std::vector<std::unique_ptr<Protocol>> all() {
  std::vector<std::unique_ptr<Protocol>> made;
  for (const ProtocolEntry& entry : protocols()) {
    for (const ProtocolVariant& variant : entry.variants)
      made.push_back(std::move(*entry.make(link_of(variant, 1))));
  }
  for (const char* name : {"instrument", "modbus-rtu-declared", "dlt645-2007", "mt-sics",
                           "panasonic-mewtocol", "delta-dvp-rtu"}) {
    made.push_back(
        std::move(*declared::make(config::load_declaration(name)->value, {.address = 1})));
  }
  return made;
}

void parse(const Protocol& protocol, const std::string& text) {
  const auto parsed = protocol.parse_address(text);
  if (parsed) {
    if (parsed->area >= protocol.areas().size()) std::abort();
    const Area& area = protocol.areas()[parsed->area];
    if (parsed->first >= area.items || (parsed->bit && *parsed->bit >= area.item_bits))
      std::abort();
    return;
  }
  const AddressFault& fault = parsed.error();
  if (fault.what.empty() || fault.allowed.empty() || fault.what.size() > 256) std::abort();
  if (!fault.suggestion.empty() && !protocol.parse_address(fault.suggestion)) std::abort();
}

void run_one(ByteView data) {
  static const auto made = all();
  for (const auto& protocol : made) parse(*protocol, std::string(data.begin(), data.end()));
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
