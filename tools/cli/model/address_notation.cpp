#include "tools/cli/model/address_notation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <set>
#include <span>
#include <vector>

#include "config/loader/loader.hpp"
#include "core/base/message_text.hpp"
#include "core/model/fit.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/cli/model/command_text.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

namespace {

// Every variant of each protocol, because their addresses and codes may differ.
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

std::string type_of(const ParsedAddress& address, const Protocol& protocol) {
  const auto type = implied_type(address, protocol.areas()[address.area]);
  return type ? to_text(*type) : std::string();
}

// The catalogue does not contain a bit or byte given by a separate key.
bool can_have(const Protocol& protocol, const KnownChannel& channel) {
  const auto address = protocol.parse_address(channel.at);
  const auto type = parse_type(channel.type);
  if (!address || !type) return false;
  if (type->type == ValueType::kBool || width_bits(*type) == 8) return true;
  return !check_fit(channel.at, *address, protocol.areas()[address->area], *type);
}

tl::unexpected<std::string> say_type(std::string_view at, std::string_view why) {
  return tl::unexpected(fmt::format("{}: {}; say --type", printable(at), why));
}

}  // namespace

tl::expected<std::string, std::string> type_at(std::string_view at, const std::string& said,
                                               const Protocol& protocol) {
  if (!said.empty()) return said;
  const auto address = protocol.parse_address(at);
  std::string type = address ? type_of(*address, protocol) : std::string();
  if (type.empty()) return say_type(at, "it does not imply a type");
  return type;
}

tl::expected<std::string, std::string> type_at(std::string_view at, const std::string& said,
                                               std::span<const KnownChannel> channels) {
  if (!said.empty()) return said;
  std::map<std::string, std::string_view> types;  // type -> a family that implies it
  for (const auto& protocol : families()) {
    const auto address = protocol->parse_address(at);
    const bool possible =
        address && std::ranges::all_of(channels, [&](const KnownChannel& channel) {
          return can_have(*protocol, channel);
        });
    if (possible) types.emplace(type_of(*address, *protocol), protocol->traits().name);
  }
  // A declared protocol or a typing error: the bridge refuses a value of a different width.
  if (types.empty()) return "uint16";
  if (types.size() == 1 && !types.begin()->first.empty()) return types.begin()->first;
  std::string all;
  for (const auto& [type, family] : types)
    all += fmt::format("{}{} ({})", all.empty() ? "" : ", ", type.empty() ? "none" : type, family);
  return say_type(at, "the type depends on the protocol: " + all);
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

namespace {

void explain_unknown(const std::string& name, std::string_view command, std::ostream& err) {
  std::vector<std::string> names;
  for (const auto& entry : protocols()) names.emplace_back(entry.name);
  err << "fieldcast " << command << ": protocol '" << printable(name) << "' is unknown";
  if (const auto near = near_miss(name, names); !near.empty())
    err << "; did you mean " << near << '?';
  // Configurations find it by name in the directory next to them.
  const std::string own = "./protocols/" + name + ".yaml";
  std::error_code ignored;
  if (std::filesystem::exists(own, ignored)) err << "; a declaration is named by its file: " << own;
  err << "\nprotocols:\n";
  for (const auto& entry : protocols()) err << "  " << entry.name << "  " << entry.summary << '\n';
}

}  // namespace

std::optional<NamedProtocol> named_protocol(const std::string& name, std::string_view command,
                                            std::ostream& err) {
  if (const auto* entry = find_protocol(name)) return NamedProtocol{entry, {}};
  auto loaded = config::load_declaration(name);
  if (loaded) return NamedProtocol{nullptr, *std::move(loaded)};
  const bool is_path = name.find_first_of("/.") != std::string::npos;
  const auto& faults = loaded.error();
  const bool missing = faults.size() == 1 && faults.front().file == name;
  if (missing && !is_path)
    explain_unknown(name, command, err);
  else
    err << config::to_text(std::span(faults));
  return std::nullopt;
}

}  // namespace fieldcast::cli
