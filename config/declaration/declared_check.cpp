#include <fmt/format.h>

#include <charconv>

#include "config/declaration/declared_frame.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {

namespace {

using declared::Check;
using declared::CheckKind;
using declared::Complement;

struct NamedCheck {
  std::string_view name;
  CheckKind kind;
  Complement complement = Complement::kNone;
  std::string_view crc{};  // its name in the catalogue
};
// The short names of frequent CRCs; any name of the catalogue is also accepted.
constexpr NamedCheck kChecks[] = {
    {"sum", CheckKind::kSum},
    {"and", CheckKind::kAnd},
    {"xor", CheckKind::kXor},
    {"lrc", CheckKind::kSum, Complement::kTwos},
    {"crc16-modbus", CheckKind::kCrc, Complement::kNone, "crc-16/modbus"},
    {"crc16-arc", CheckKind::kCrc, Complement::kNone, "crc-16/arc"},
    {"crc16-usb", CheckKind::kCrc, Complement::kNone, "crc-16/usb"},
    {"crc16-ccitt", CheckKind::kCrc, Complement::kNone, "crc-16/ibm-3740"},
    {"crc16-xmodem", CheckKind::kCrc, Complement::kNone, "crc-16/xmodem"},
    {"crc16-kermit", CheckKind::kCrc, Complement::kNone, "crc-16/kermit"},
    {"crc16-x25", CheckKind::kCrc, Complement::kNone, "crc-16/ibm-sdlc"},
    {"crc16-dnp", CheckKind::kCrc, Complement::kNone, "crc-16/dnp"},
};

const declared::Crc* catalogued(std::string_view name) {
  for (const auto& [known, crc] : declared::crc_catalogue()) {
    if (known == name) return &crc;
  }
  return nullptr;
}

// Also numbers of 64 bits.
std::optional<std::uint64_t> unsigned_from(std::string_view text) {
  const bool hexadecimal = text.starts_with("0x");
  if (hexadecimal) text.remove_prefix(2);
  std::uint64_t value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<Check> parameters_of(const Node& node, FaultList& faults) {
  const std::size_t before = faults.size();
  MapReader map(node, kCrcKeys, faults);
  declared::Crc crc{.polynomial = 0, .start = 0, .reflect_in = false, .reflect_out = false};
  const bool wide = map.read_required("width", crc.width, WholeRule{8, 64}, "8 to 64 bits");
  const auto number = [&](std::string_view name, std::uint64_t& target) {
    const Node* each = name == "polynomial"
                           ? map.require(name, "the polynomial without its highest term")
                           : map.find(name);
    if (each == nullptr || !wide) return;
    const std::uint64_t mask = UINT64_MAX >> (64 - crc.width);
    const auto value = unsigned_from(each->text);
    if (each->kind == Kind::kScalar && value && *value <= mask)
      target = *value;
    else
      faults.add(each->position, fmt::format("{} is not a number of {} bits", name, crc.width),
                 fmt::format("0 to 0x{:X}", mask));
  };
  number("polynomial", crc.polynomial);
  number("start", crc.start);
  number("final-xor", crc.final_xor);
  map.read("reflect-in", crc.reflect_in, FlagRule{});
  map.read("reflect-out", crc.reflect_out, FlagRule{});
  if (faults.size() != before) return std::nullopt;
  return Check{CheckKind::kCrc, Complement::kNone, crc, false};
}

}  // namespace

std::string check_words() {
  std::vector<std::string_view> names;
  for (const NamedCheck& check : kChecks) names.push_back(check.name);
  return joined(names) +
         ", a CRC of the catalogue such as crc-32/iso-hdlc, or { width: 16, polynomial: 0x1021 }";
}

std::optional<Check> read_check(const Node& node, FaultList& faults) {
  if (node.kind == Kind::kMap) return parameters_of(node, faults);
  const std::string* text = scalar_of(node, "kind", check_words(), faults);
  if (text == nullptr) return std::nullopt;
  for (const NamedCheck& check : kChecks) {
    if (*text != check.name) continue;
    const auto* crc = catalogued(check.crc);
    return Check{check.kind, check.complement, crc == nullptr ? declared::Crc{} : *crc, false};
  }
  std::string lower = *text;
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (const auto* crc = catalogued(lower))
    return Check{CheckKind::kCrc, Complement::kNone, *crc, false};
  std::vector<std::string_view> names;
  for (const NamedCheck& check : kChecks) names.push_back(check.name);
  for (const auto& [name, crc] : declared::crc_catalogue()) names.push_back(name);
  faults.add(node.position, fmt::format("kind '{}' is unknown", *text), check_words(),
             closest(lower, names));
  return std::nullopt;
}

}  // namespace fieldcast::config
