#include "tools/cli/model/address_notation.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "core/codec/value_codec.hpp"
#include "core/protocol/registry.hpp"

namespace fieldcast::cli {
namespace {

// Each protocol in each of its variants, whose addresses and codes may differ.
const std::vector<std::unique_ptr<Protocol>>& families() {
  static const auto all = [] {
    std::vector<std::unique_ptr<Protocol>> made;
    for (const ProtocolEntry& entry : protocols()) {
      for (const ProtocolVariant& variant : entry.variants) {
        if (auto protocol = entry.make(link_of(variant, 1))) made.push_back(*std::move(protocol));
      }
    }
    return made;
  }();
  return all;
}

std::string type_of(const ParsedAddress& address, const Area& area) {
  if (address.bit || area.item_bits == 1) return "bool";
  if (!address.width_bits) return {};
  const std::string type =
      *address.width_bits == 1 ? "bool" : fmt::format("uint{}", *address.width_bits);
  return value_type_from(type) ? type : std::string{};
}

}  // namespace

std::string implied_type(std::string_view at) {
  std::set<std::string> types;
  for (const auto& protocol : families()) {
    const auto address = protocol->parse_address(at);
    if (address) types.insert(type_of(*address, protocol->areas()[address->area]));
  }
  return types.size() == 1 ? *types.begin() : std::string{};
}

std::string device_code_at(std::string_view at, std::uint16_t code) {
  std::set<std::string_view> texts;
  for (const auto& protocol : families()) {
    const auto text = device_code_text(protocol->traits().codes, code);
    if (!text.empty() && protocol->parse_address(at)) texts.insert(text);
  }
  if (texts.size() != 1) return device_code_words({}, code);
  const DeviceCode row{code, *texts.begin()};
  return device_code_words({&row, 1}, code);
}

}  // namespace fieldcast::cli
