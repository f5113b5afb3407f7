#include "core/protocol/omron_hostlink/omron_hostlink.hpp"

#include <array>
#include <string_view>
#include <tuple>

#include "core/codec/digits.hpp"
#include "core/protocol/omron_hostlink/c_mode.hpp"
#include "core/protocol/omron_hostlink/fins.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::omron {

namespace {

constexpr Traits kCModeTraits{
    .name = "omron-hostlink",
    .summary = "Omron Host Link: C-mode commands, or FINS with the option mode: fins",
    .lowest_address = 0,
    .highest_address = 31,
    .identity = ResponseIdentity::kAddress,
    .codes = kEndCodes};
constexpr Traits kFinsTraits{.name = kCModeTraits.name,
                             .summary = kCModeTraits.summary,
                             .lowest_address = kCModeTraits.lowest_address,
                             .highest_address = kCModeTraits.highest_address,
                             .max_ranges = kFinsItems,
                             .identity = ResponseIdentity::kSequence,
                             .codes = kFinsCodes};

class CModeProtocol final : public Protocol {
 public:
  explicit CModeProtocol(std::uint16_t unit) : unit_(unit) {}
  const Traits& traits() const override { return kCModeTraits; }
  std::span<const Area> areas() const override { return reached_in(Mode::kCMode).areas; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(
        at, [](std::string_view text) { return omron::parse_address(Mode::kCMode, text); });
  }
  std::optional<ExchangeSize> size(const Request& request) const override {
    return c_mode_size(request);
  }
  std::unique_ptr<Exchange> begin(Request request, ExchangeContext) const override {
    return begin_c_mode(unit_, request);
  }
  bool mistakable(const Request& earlier, ExchangeContext, const Request& later,
                  ExchangeContext) const override {
    return c_mode_mistakable(earlier, later);
  }

 private:
  const std::uint16_t unit_;
};

class FinsProtocol final : public Protocol {
 public:
  explicit FinsProtocol(const FinsRoute& route) : route_(route) {}
  const Traits& traits() const override { return kFinsTraits; }
  std::span<const Area> areas() const override { return reached_in(Mode::kFins).areas; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(
        at, [](std::string_view text) { return omron::parse_address(Mode::kFins, text); });
  }
  std::optional<ExchangeSize> size(const Request& request) const override {
    return fins_size(route_, request);
  }
  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return begin_fins(route_, static_cast<std::uint8_t>(context.sequence), request);
  }

 private:
  const FinsRoute route_;
};

constexpr std::array<std::string_view, 5> kOptions{"mode", "wait", "network", "node", "unit"};

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kCModeTraits, kOptions);
  const bool fins = reader.choice("mode", {"c-mode", "fins"}) == 1;
  FinsRoute route{.host_unit = link.address};
  for (const auto& [name, highest, field] :
       {std::tuple{"wait", 15u, &route.wait}, std::tuple{"network", 127u, &route.network},
        std::tuple{"node", 254u, &route.node}, std::tuple{"unit", 254u, &route.unit}})
    *field = static_cast<std::uint8_t>(reader.number(name, 0, highest, 0));
  route.relayed = link.options.contains("network") || link.options.contains("node");
  if (reader.fault()) return tl::unexpected(*reader.fault());
  if (fins) return std::make_unique<FinsProtocol>(route);
  for (const std::string name : {"wait", "network", "node", "unit"}) {
    if (link.options.contains(name))
      return tl::unexpected(OptionFault{name, "'" + name + "' belongs to FINS", "with mode: fins"});
  }
  return std::make_unique<CModeProtocol>(link.address);
}

constexpr std::string_view kCModeAddresses[] = {
    "CIO12", "IR13",  "CIO14.03", "LR7",      "L8",      "HR10",   "H11",      "AR3",
    "A4",    "DM100", "D101",     "DM102.15", "EM1_100", "E1_101", "E1_102.3", "T5",
    "TIM6",  "C5",    "CNT6",     "TF5",      "TIMF6",   "CF5",    "CNTF6"};
constexpr ProtocolOption kFins[] = {{"mode", "fins"}};
constexpr ProtocolOption kFinsRelayed[] = {{"mode", "fins"}, {"network", "5"}, {"node", "3"}};
constexpr ProtocolAlias kAliases[] = {
    {"hostlink"}, {"host-link"}, {"fins", "omron-hostlink, with options: { mode: fins }"}};
constexpr ProtocolVariant kVariants[] = {{.addresses = kCModeAddresses},
                                         {.options = kFins, .addresses = kFinsAddresses},
                                         {.options = kFinsRelayed, .addresses = kFinsAddresses}};

}  // namespace

const ProtocolEntry& hostlink_entry() {
  static constexpr ProtocolEntry entry{
      .name = kCModeTraits.name,
      .summary = kCModeTraits.summary,
      .make = make,
      .explain = explain_hostlink,
      .seen_request = seen_hostlink_request,
      .options = kOptions,
      .options_text = "`mode: fins`, `wait`, `network`, `node`, `unit`",
      .factory_line = {9600, 7, Parity::kEven, 2},
      .aliases = kAliases,
      .variants = kVariants};
  return entry;
}

namespace {

// After the header a response has an end code, then words or flags.
SeenRequest seen_c_mode(ByteView rest, char command, char area, std::size_t size) {
  if (std::string_view("RLHJDECG").find(area) == std::string_view::npos) return {};
  const std::size_t address = area == 'E' ? 6 : 4;
  if (command == 'W') return {rest.size() > address ? size : 0, true};
  if (command != 'R' || rest.size() != address + 4 || !read_digits(rest.last(8), 10)) return {};
  return {size, area != 'E' && area != 'G'};
}

SeenRequest seen_fins(ByteView rest, std::size_t size) {
  constexpr std::uint8_t kResponse = 0x40;  // in ICF
  if (rest.size() % 2 == 0) return {};      // a response: its end code has two digits, `w` has one
  const auto message = read_hex_bytes(rest.subspan(1));
  if (!message || message->empty() || (message->front() & kResponse) != 0) return {};
  return {size, true};
}

}  // namespace

SeenRequest seen_hostlink_request(ByteView bytes) {
  if (bytes.empty() || bytes[0] != kAt) return {};
  const ParseResult parsed = first_frame(bytes);
  const bool here = parsed.kind == ParseResult::Kind::kFrame && parsed.text.data() == bytes.data();
  if (!here || parsed.text.size() <= kHeadSize) return {};
  const auto command = static_cast<char>(parsed.text[3]), area = static_cast<char>(parsed.text[4]);
  const ByteView rest = parsed.text.subspan(kHeadSize);
  if (command == 'F' && area == 'A') return seen_fins(rest, parsed.end);
  return seen_c_mode(rest, command, area, parsed.end);
}

}  // namespace fieldcast::omron
