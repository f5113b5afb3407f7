#include "core/protocol/modbus/modbus.hpp"

#include <algorithm>
#include <array>

#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::modbus {
namespace {

constexpr std::uint16_t kMaxGroups = 35;  // 245 bytes in a request of function 20; other areas: 1

constexpr Traits kRtu{.name = "modbus-rtu",
                      .summary = "Modbus RTU on a serial line, or on a serial server's TCP port",
                      .lowest_address = 1,
                      .highest_address = 247,
                      .max_ranges = kMaxGroups,
                      .identity = ResponseIdentity::kAddress,
                      .echo_is_ambiguous = true,
                      .codes = kExceptions};
constexpr Traits kAscii{.name = "modbus-ascii",
                        .summary = "Modbus ASCII on a serial line",
                        .lowest_address = 1,
                        .highest_address = 247,
                        .max_ranges = kMaxGroups,
                        .identity = ResponseIdentity::kAddress,
                        .echo_is_ambiguous = true,
                        .codes = kExceptions};
constexpr Traits kTcp{.name = "modbus-tcp",
                      .summary = "Modbus TCP, directly or through a gateway",
                      .lowest_address = 0,
                      .highest_address = 255,
                      .max_ranges = kMaxGroups,
                      .identity = ResponseIdentity::kSequence,
                      .codes = kExceptions};

class ModbusProtocol final : public Protocol {
 public:
  ModbusProtocol(const Traits& traits, const Framing& framing, std::uint8_t unit,
                 const Options& options)
      : traits_(traits),
        framing_(framing),
        unit_(unit),
        options_(options),
        areas_(modbus::areas(options.mask_write)) {
    traits_.write_read = options.read_write;
  }

  const Traits& traits() const override { return traits_; }
  std::span<const Area> areas() const override { return areas_; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(at, modbus::parse_address);
  }

  std::optional<ExchangeSize> size(const Request& request) const override {
    const auto pdu = pdu_sizes(request, options_);
    if (!pdu) return std::nullopt;
    return ExchangeSize::of(framing_.size(pdu->request), framing_.size(pdu->response));
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<ModbusExchange>(framing_, Header{unit_, context.sequence}, request,
                                            options_);
  }

  // RTU and ASCII: a response shows its unit, function and length; that of a write also the values,
  // except in a refusal; that of an identification its object; that of a queue nothing.
  bool mistakable(const Request& earlier, ExchangeContext earlier_context, const Request& later,
                  ExchangeContext later_context) const override {
    if (traits_.identity == ResponseIdentity::kSequence)
      return Protocol::mistakable(earlier, earlier_context, later, later_context);
    const RequestPdu first(earlier, options_), second(later, options_);
    if (first.function() != second.function()) return false;
    if (first.is_fifo()) return true;
    if (first.varies()) return std::ranges::equal(first.pdu(), second.pdu());
    return !std::holds_alternative<ReadRequest>(earlier) ||
           first.response_size() == second.response_size();
  }

 private:
  Traits traits_;
  const Framing& framing_;
  const std::uint8_t unit_;
  const Options options_;
  const std::array<Area, 7> areas_;
};

constexpr std::array<std::string_view, 3> kOptionNames{"write-single", "mask-write", "read-write"};

using Made = tl::expected<std::unique_ptr<Protocol>, OptionFault>;

Made make(const Traits& traits, const Framing& framing, const DeviceLink& link) {
  OptionReader reader(link, traits, kOptionNames);
  const Options options{
      .write_multiple = reader.choice("write-single", {"single", "multiple"}) == 1,
      .mask_write = reader.flag("mask-write", false),
      .read_write = reader.flag("read-write", false)};
  if (reader.fault()) return tl::unexpected(*reader.fault());
  return std::make_unique<ModbusProtocol>(traits, framing, static_cast<std::uint8_t>(link.address),
                                          options);
}

Made make_rtu(const DeviceLink& link) { return make(kRtu, rtu_framing(), link); }
Made make_ascii(const DeviceLink& link) { return make(kAscii, ascii_framing(), link); }
Made make_tcp(const DeviceLink& link) { return make(kTcp, tcp_framing(), link); }

constexpr std::string_view kAddresses[] = {"coil:3",
                                           "coil:0x1F",
                                           "input:5",
                                           "input:0x5",
                                           "discrete-input:6",
                                           "holding:100",
                                           "holding:0x65",
                                           "discrete-input:0x7",
                                           "holding:0XfF",
                                           "holding:110.5",
                                           "holding:0x70.5",
                                           "holding:113.0xA",
                                           "holding:65535",
                                           "input-register:7",
                                           "input-register:0x8",
                                           "input-register:9.15",
                                           "input-register:0xA.0x3",
                                           "00010",
                                           "10010",
                                           "30021",
                                           "30022.1",
                                           "40201",
                                           "40202.15",
                                           "000011",
                                           "100011",
                                           "300031",
                                           "465001",
                                           "file:4:1",
                                           "file:0x5:0x7",
                                           "file:65535:9999.15",
                                           "id:0",
                                           "id:0x80",
                                           "id:255",
                                           "fifo:1246",
                                           "fifo:0x4DE:1",
                                           "fifo:65535:31",
                                           "fifo:0:0x2.15"};
constexpr std::string_view kOptionsText =
    "`mask-write: true` (function 22 for one bit or byte of a register), `read-write: true` "
    "(function 23 for a write that is verified), `write-single: multiple` (functions 15, 16 for "
    "single items)";

constexpr ProtocolOption kMaskWrite[] = {{"mask-write", "true"}};
constexpr ProtocolVariant kPlain[] = {{.addresses = kAddresses}};
constexpr ProtocolVariant kRtuVariants[] = {{.addresses = kAddresses},
                                            {.options = kMaskWrite, .addresses = kAddresses}};
constexpr ProtocolAlias kRtuAliases[] = {{"rtu"}};
constexpr ProtocolAlias kAsciiAliases[] = {{"ascii"}};
constexpr ProtocolAlias kTcpAliases[] = {{"tcp"}};

}  // namespace

// Modbus over Serial Line V1.02, 2.5.1, 2.5.2: 19200 8E1, ASCII 7 data bits; RTU needs 8.
const ProtocolEntry& rtu_entry() {
  static constexpr ProtocolEntry entry{.name = kRtu.name,
                                       .summary = kRtu.summary,
                                       .make = make_rtu,
                                       .explain = explain_rtu,
                                       .seen_request = seen_rtu_request,
                                       .options = kOptionNames,
                                       .options_text = kOptionsText,
                                       .factory_line = {19200, 8, Parity::kEven, 1},
                                       .whole_bytes = true,
                                       .instead = kAscii.name,
                                       .dissector = "mbrtu",
                                       .aliases = kRtuAliases,
                                       .variants = kRtuVariants};
  return entry;
}
const ProtocolEntry& ascii_entry() {
  static constexpr ProtocolEntry entry{.name = kAscii.name,
                                       .summary = kAscii.summary,
                                       .make = make_ascii,
                                       .explain = explain_ascii,
                                       .seen_request = seen_ascii_request,
                                       .options = kOptionNames,
                                       .options_text = kOptionsText,
                                       .factory_line = {19200, 7, Parity::kEven, 1},
                                       .aliases = kAsciiAliases,
                                       .variants = kPlain};
  return entry;
}
const ProtocolEntry& tcp_entry() {
  static constexpr ProtocolEntry entry{.name = kTcp.name,
                                       .summary = kTcp.summary,
                                       .make = make_tcp,
                                       .explain = explain_tcp,
                                       .options = kOptionNames,
                                       .options_text = kOptionsText,
                                       .first_frame = first_tcp_frame,
                                       .network_only = true,
                                       .instead = kRtu.name,
                                       .carrier_checks = true,
                                       .dissector = "mbtcp",
                                       .aliases = kTcpAliases,
                                       .variants = kPlain};
  return entry;
}

}  // namespace fieldcast::modbus
