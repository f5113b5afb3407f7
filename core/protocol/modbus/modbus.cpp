// Protocol objects and registry entries of the Modbus family.
#include "core/protocol/modbus/modbus.hpp"

#include <array>

#include "core/protocol/address_text.hpp"
#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/exchange.hpp"
#include "core/protocol/option_reader.hpp"

namespace fieldcast::modbus {
namespace {

constexpr Traits kRtu{.name = "modbus-rtu",
                      .summary = "Modbus RTU on a serial line, or on a serial server's TCP port",
                      .lowest_address = 1,
                      .highest_address = 247,
                      .identity = AnswerIdentity::kAddress,
                      .echo_is_ambiguous = true,
                      .codes = kExceptions};
constexpr Traits kAscii{.name = "modbus-ascii",
                        .summary = "Modbus ASCII on a serial line",
                        .lowest_address = 1,
                        .highest_address = 247,
                        .identity = AnswerIdentity::kAddress,
                        .echo_is_ambiguous = true,
                        .codes = kExceptions};
constexpr Traits kTcp{.name = "modbus-tcp",
                      .summary = "Modbus TCP, directly or through a gateway",
                      .lowest_address = 0,
                      .highest_address = 255,
                      .identity = AnswerIdentity::kSequence,
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
    return ExchangeSize{
        .request_characters = static_cast<std::uint32_t>(framing_.size(pdu->request)),
        .answer_characters = static_cast<std::uint32_t>(framing_.size(pdu->answer))};
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext context) const override {
    return std::make_unique<ModbusExchange>(framing_, Header{unit_, context.sequence}, request,
                                            options_);
  }

  // RTU and ASCII: an answer shows its unit, its function and how long it is; that of a write also
  // what was written, but its refusal does not.
  bool mistakable(const Request& earlier, ExchangeContext earlier_context, const Request& later,
                  ExchangeContext later_context) const override {
    if (traits_.identity == AnswerIdentity::kSequence)
      return Protocol::mistakable(earlier, earlier_context, later, later_context);
    const RequestPdu first(earlier, options_), second(later, options_);
    if (first.function() != second.function()) return false;
    return !std::holds_alternative<ReadRequest>(earlier) ||
           first.answer_size() == second.answer_size();
  }

 private:
  Traits traits_;
  const Framing& framing_;
  const std::uint8_t unit_;
  const Options options_;
  const std::array<Area, 4> areas_;
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

}  // namespace

const ProtocolEntry& rtu_entry() {
  static constexpr ProtocolEntry entry{kRtu.name, kRtu.summary, make_rtu, explain_rtu,
                                       kOptionNames};
  return entry;
}
const ProtocolEntry& ascii_entry() {
  static constexpr ProtocolEntry entry{kAscii.name, kAscii.summary, make_ascii, explain_ascii,
                                       kOptionNames};
  return entry;
}
const ProtocolEntry& tcp_entry() {
  static constexpr ProtocolEntry entry{kTcp.name, kTcp.summary, make_tcp, explain_tcp,
                                       kOptionNames};
  return entry;
}

}  // namespace fieldcast::modbus
