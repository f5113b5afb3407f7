// ASCII frames between STX and ETX, numbers in upper-case hexadecimal digits:
//
//     read      02 `0` address(4) count(2) 03 sum(2)           ->  02 data 03 sum(2)
//     write     02 `1` address(4) count(2) data 03 sum(2)      ->  06, or 15 when the PLC refuses
//     force on  02 `7` address(4) 03 sum(2)                    ->  06, or 15
//     force off 02 `8` address(4) 03 sum(2)                    ->  06, or 15
//
// The address of force has its low pair of digits first. The count is in bytes; words have their
// low byte first. The sum covers all characters after STX, including ETX. The extended commands are
// E00, E10, E7 and E8. There is one PLC per port, so responses contain no address. A refusal is one
// character and may be caused by noise in the request: the request is sent again, and a second
// refusal counts.
#include "core/protocol/mitsubishi_fx/mitsubishi_fx.hpp"

#include <algorithm>
#include <array>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/mitsubishi_fx/areas.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/protocol_entry.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::mitsubishi_fx {
namespace {

constexpr std::size_t kEnvelope = 4;       // STX, ETX, sum
constexpr std::size_t kMaxReceived = 600;  // four of the largest responses

constexpr Traits kTraits{
    .name = "mitsubishi-fx",
    .summary = "Mitsubishi FX programming port: registers and bits of one PLC on the line",
    .lowest_address = 0,
    .highest_address = 247,
    .identity = ResponseIdentity::kNone};

const DeviceRow& row_of(Commands commands, const Range& range) {
  return *reached_by(commands).rows[range.area];
}
bool is_extended(Commands commands) { return commands == Commands::kExtended; }

// Bytes that contain the range; bits are read in whole bytes.
std::uint32_t bytes_of(const DeviceRow& row, const Range& range) {
  if (row.item_bits != 1) return range.count * (row.item_bits / 8);
  return (range.end() + 7) / 8 - range.first / 8;
}

bool fits(Commands commands, const Range& range, bool write) {
  return fieldcast::fits(reached_by(commands).areas, range, write) &&
         bytes_of(row_of(commands, range), range) <= kMaxBytes;
}

bool fits(Commands commands, const WriteRequest& write) {
  if (!fits(commands, write.range, true)) return false;
  const unsigned item_bits = row_of(commands, write.range).item_bits;
  if (write.bit && item_bits != 1) return false;
  return write.items.size() == image_bytes(item_bits, write.range.count);
}

// The low byte is first on the wire, last in the image.
Bytes turned(ByteView bytes, std::size_t each) {
  Bytes result(bytes.begin(), bytes.end());
  for (std::size_t at = 0; at + each <= result.size(); at += each) {
    std::reverse(result.begin() + static_cast<std::ptrdiff_t>(at),
                 result.begin() + static_cast<std::ptrdiff_t>(at + each));
  }
  return result;
}

void append_text(Bytes& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
}
// The sum starts after STX, the first byte of `out`.
void append_end(Bytes& out) {
  out.push_back(kEtx);
  append_digits(out, sum8(ByteView(out).subspan(1)), 2);
}

// Sends a refused request once more.
class FxExchange : public Exchange {
 public:
  Step on_silence(Bytes& out) final {
    if (silence_ != Cause::kDeviceError) return Step::failed(silence_);
    if (sent_twice_) return Step::failed(silence_, kNak);
    sent_twice_ = true;
    silence_ = Cause::kNoResponse;  // until bytes of this request arrive
    return start(out);
  }
  const Reply& reply() const final { return reply_; }

 protected:
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;

 private:
  bool sent_twice_ = false;
};

class FxRead final : public FxExchange {
 public:
  FxRead(Commands commands, const Range& range)
      : commands_(commands),
        row_(row_of(commands, range)),
        range_(range),
        bytes_(bytes_of(row_, range)) {}

  Step start(Bytes& out) override {
    const std::uint32_t offset =
        row_.item_bits == 1 ? range_.first / 8 : range_.first * (row_.item_bits / 8);
    out.push_back(kStx);
    append_text(out, is_extended(commands_) ? "E00" : "0");
    append_digits(out, row_.address_map(commands_).base + offset, 4);
    append_digits(out, bytes_, 2);
    append_end(out);
    return Step::send(frame_size());
  }

  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
    silence_ = cause_of_noise(all);
    // A refusal is one unprotected character: only turnaround noise may precede it.
    const auto first = std::ranges::find_if_not(all, is_turnaround);
    const bool refused = first != all.end() && *first == kNak && first + 1 == all.end();
    if (refused) silence_ = Cause::kDeviceError;
    Step step = refused ? Step::need_rest(0) : Step::need_response();
    // STX begins a frame at any time.
    for (auto stx = std::ranges::find(all, kStx); stx != all.end();) {
      const auto next = std::find(stx + 1, all.end(), kStx);
      step = parse({stx, next});
      if (step.kind != Step::Kind::kNeedMore) break;
      stx = next;
    }
    return step;
  }

 private:
  std::size_t frame_size() const { return kEnvelope + 2 * std::size_t{bytes_}; }

  Step parse(ByteView text) {
    const auto etx = std::ranges::find(text, kEtx);
    const std::size_t present = text.size();
    const auto size = static_cast<std::size_t>(etx - text.begin()) + 3;  // with ETX and sum
    if ((etx == text.end() && present < frame_size()) || (etx != text.end() && present < size)) {
      silence_ = Cause::kTruncated;
      return Step::need_rest(frame_size() > present ? frame_size() - present : 1);
    }
    if (etx == text.end()) return broken(Cause::kMalformed);
    const ByteView frame = text.first(size);
    if (read_digits(frame.last(2)) != sum8(frame.subspan(1, size - 3)))
      return broken(Cause::kChecksum);
    const auto data = read_hex_bytes(frame.subspan(1, size - kEnvelope));
    if (!data || data->size() != bytes_) return broken(Cause::kMalformed);
    reply_.push_back({.items = items_of(*data)});
    return Step::done();
  }

  Bytes items_of(const Bytes& data) const {
    if (row_.item_bits != 1) return turned(data, row_.item_bits / 8);
    return unpack_bits(data, range_.count, range_.first % 8);
  }

  Step broken(Cause cause) {
    silence_ = cause;
    return Step::need_rest(0);
  }

  const Commands commands_;
  const DeviceRow& row_;
  const Range range_;
  const std::uint32_t bytes_;
};

class FxWrite final : public FxExchange {
 public:
  FxWrite(Commands commands, const WriteRequest& write) {
    const DeviceRow& row = row_of(commands, write.range);
    const AddressMap& map = row.address_map(commands);
    request_.push_back(kStx);
    if (is_extended(commands)) request_.push_back('E');
    if (row.item_bits == 1) {
      append_text(request_, write.items[0] != 0 ? "7" : "8");
      const std::uint32_t address = *map.force + write.range.first;
      append_digits(request_, address & 0xFF, 2);
      append_digits(request_, address >> 8, 2);
    } else {
      const std::size_t each = row.item_bits / 8;
      append_text(request_, is_extended(commands) ? "10" : "1");
      append_digits(request_, map.base + write.range.first * static_cast<std::uint32_t>(each), 4);
      append_digits(request_, static_cast<std::uint32_t>(write.items.size()), 2);
      append_hex_bytes(request_, turned(write.items, each));
    }
    append_end(request_);
  }

  Step start(Bytes& out) override {
    out = request_;
    return Step::send(1);
  }

  // The acknowledgement is one unprotected character: only turnaround noise may precede it.
  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
    const auto first = std::ranges::find_if_not(all, is_turnaround);
    if (first == all.end()) return Step::need_response();
    if (*first == kAck) {
      reply_.resize(1);
      return Step::done();
    }
    silence_ = *first == kNak && first + 1 == all.end() ? Cause::kDeviceError : Cause::kMalformed;
    return Step::need_rest(0);
  }

 private:
  Bytes request_;
};

class FxProtocol final : public Protocol {
 public:
  explicit FxProtocol(Commands commands) : commands_(commands) {}
  const Traits& traits() const override { return kTraits; }
  std::span<const Area> areas() const override { return reached_by(commands_).areas; }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    return parse_with_suggestion(
        at, [&](std::string_view text) { return mitsubishi_fx::parse_address(commands_, text); });
  }

  std::optional<ExchangeSize> size(const Request& request) const override {
    const std::size_t longer = is_extended(commands_) ? 2 : 0;
    if (const auto* read = std::get_if<ReadRequest>(&request)) {
      if (read->ranges.size() != 1 || !fits(commands_, read->ranges[0], false)) return std::nullopt;
      const std::size_t bytes = bytes_of(row_of(commands_, read->ranges[0]), read->ranges[0]);
      return ExchangeSize::of(11 + longer, kEnvelope + 2 * bytes);
    }
    const auto* write = std::get_if<WriteRequest>(&request);
    if (write == nullptr || !fits(commands_, *write)) return std::nullopt;
    if (row_of(commands_, write->range).item_bits == 1) return ExchangeSize::of(9 + longer / 2, 1);
    return ExchangeSize::of(11 + longer + 2 * write->items.size(), 1);
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext) const override {
    if (const auto* read = std::get_if<ReadRequest>(&request))
      return std::make_unique<FxRead>(commands_, read->ranges[0]);
    return std::make_unique<FxWrite>(commands_, std::get<WriteRequest>(request));
  }

  // Responses to reads only differ by their length; a write is acknowledged by one character.
  bool mistakable(const Request& earlier, ExchangeContext, const Request& later,
                  ExchangeContext) const override {
    const auto* first = std::get_if<ReadRequest>(&earlier);
    const auto* second = std::get_if<ReadRequest>(&later);
    if ((first == nullptr) != (second == nullptr)) return false;
    const auto bytes = [&](const Range& range) {
      return bytes_of(row_of(commands_, range), range);
    };
    return first == nullptr || bytes(first->ranges[0]) == bytes(second->ranges[0]);
  }

 private:
  const Commands commands_;
};

constexpr std::array<std::string_view, 1> kOptions{"commands"};

tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  const bool extended = reader.choice("commands", {"classic", "extended"}) == 1;
  if (reader.fault()) return tl::unexpected(*reader.fault());
  return std::make_unique<FxProtocol>(extended ? Commands::kExtended : Commands::kClassic);
}

constexpr std::string_view kAddresses[] = {
    "D100",    "D101.3", "D102.15", "D8010", "D8011.2", "T5", "TN6", "C5",  "CN6", "C200", "CN201",
    "C202.31", "M14",    "M8001",   "X17",   "Y5",      "S3", "TS5", "TC5", "CS5", "CC5"};
constexpr std::string_view kExtendedAddresses[] = {"D100", "D101.3", "D8010", "T5",  "TN6", "C5",
                                                   "CN6",  "M14",    "M8001", "X17", "Y5",  "S3"};
constexpr ProtocolOption kExtendedCommands[] = {{"commands", "extended"}};
constexpr ProtocolAlias kAliases[] = {{"fx"}, {"melsec"}};
constexpr ProtocolVariant kVariants[] = {
    {.addresses = kAddresses}, {.options = kExtendedCommands, .addresses = kExtendedAddresses}};

}  // namespace

const ProtocolEntry& entry() {
  static constexpr ProtocolEntry row{.name = kTraits.name,
                                     .summary = kTraits.summary,
                                     .make = make,
                                     .explain = explain,
                                     .seen_request = seen_request,
                                     .options = kOptions,
                                     .options_text = "`commands: extended` (of FX3 and later)",
                                     .factory_line = {9600, 7, Parity::kEven, 1},
                                     .one_device = true,
                                     .aliases = kAliases,
                                     .variants = kVariants};
  return row;
}

}  // namespace fieldcast::mitsubishi_fx
