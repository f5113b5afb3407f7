// The whole family. Upper-case hexadecimal digits between the marks `q` and `Q`, which data cannot
// contain:
//
//     request   q DT DA DA LE LE DU*8 FC FC Q     17 characters
//     response  q DU*8 FC FC Q                    12
//     refusal   q E CC CC FC FC Q                  7
//
// DT: `W` reads from the PLC (it writes to the line), `R` writes to it. DA station, LE bytes
// (1..4), DU four bytes, FC the XOR of all characters after `q`. A station has one window of four
// bytes to read and one to write; a write sets the first LE bytes, and its response contains all
// four. To write a later byte, the earlier ones are sent as last reported by the station; no
// request reads them. Until a write from byte 0 on has shown them, writes that need them are not
// possible, unless the option `unknown-bytes: zero` states that they are zero.
#include "core/protocol/s7_freeport/s7_freeport.hpp"

#include <algorithm>
#include <array>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/codec/value_codec.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/protocol_entry.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::s7_freeport {
namespace {

constexpr std::uint32_t kBytes = 4;  // of a window
// Characters; more means that the line never becomes silent.
constexpr std::size_t kMaxReceived = 512;
constexpr std::array kAreas{Area{.name = "window",
                                 .item_bits = 8,
                                 .items = kBytes,
                                 .writable = true,
                                 .max_read = kBytes,
                                 .max_write = kBytes,
                                 .bit_write = true,
                                 .window = true,
                                 .sends_earlier = true}};
constexpr Traits kTraits{.name = "s7-freeport",
                         .summary = "S7-200 freeport: four-byte windows in q..Q frames",
                         .lowest_address = 0,
                         .highest_address = 255,
                         .write_read = true,
                         .identity = ResponseIdentity::kNone,
                         .codes = kRefusals};
using Window = std::array<std::uint8_t, kBytes>;
struct Written {
  Window window{};  // as last reported by the station
  bool known = false;
};

// REQUIRES: `frame` is whole, including marks.
bool check_is_right(ByteView frame) {
  return read_digits(frame.subspan(frame.size() - 3, 2)) ==
         xor8(frame.subspan(1, frame.size() - 4));
}

class FreeportExchange final : public Exchange {
 public:
  // `sent`: bytes to write, or zeros. The response repeats `length` bytes of a write; the rest is
  // zero after a read.
  FreeportExchange(char command, std::uint8_t station, std::uint32_t length, Window sent,
                   Range wanted, Written* written)
      : command_(command),
        station_(station),
        length_(length),
        sent_(sent),
        wanted_(wanted),
        written_(written) {}

  Step start(Bytes& out) override {
    out.push_back('q');
    out.push_back(static_cast<std::uint8_t>(command_));
    append_digits(out, station_, 2);
    append_digits(out, length_, 2);
    append_hex_bytes(out, sent_);
    append_digits(out, xor8(ByteView(out).subspan(1)), 2);
    out.push_back('Q');
    return Step::send(kResponse);
  }

  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > kMaxReceived) return Step::failed(Cause::kOverlong);
    Step step = Step::need_response();
    silence_ = cause_of_noise(all);
    for (auto q = std::ranges::find(all, 'q');
         q != all.end();) {  // a `q` begins a frame at any time
      const auto next = std::find(q + 1, all.end(), 'q');
      step = examine({q, next});
      if (step.kind != Step::Kind::kNeedMore) break;
      q = next;
    }
    return step;
  }

  Step on_silence(Bytes&) override { return Step::failed(silence_); }
  const Reply& reply() const override { return reply_; }

 private:
  Step examine(ByteView text) {
    const auto end = std::ranges::find(text, 'Q');
    if (end == text.end() && text.size() < kRequest) {
      silence_ = Cause::kTruncated;
      return Step::need_rest(text.size() < kResponse ? kResponse - text.size() : 1);
    }
    const ByteView frame =
        text.first(static_cast<std::size_t>(end - text.begin()) + (end != text.end() ? 1 : 0));
    if (frame.size() == kRefusal && frame[1] == 'E') return refusal(frame);
    if (frame.size() != kResponse) return broken(Cause::kMalformed);
    const auto data = read_hex_bytes(frame.subspan(1, 2 * kBytes));
    if (!data || !check_is_right(frame)) return broken(data ? Cause::kChecksum : Cause::kMalformed);
    const auto length = static_cast<std::ptrdiff_t>(length_);
    if (written_ != nullptr) {
      if (!std::equal(data->begin(), data->begin() + length, sent_.begin()))
        return broken(Cause::kMalformed);
      std::copy(data->begin(), data->end(), written_->window.begin());
      written_->known = true;
      reply_.emplace_back();
    } else if (std::any_of(data->begin() + length, data->end(),
                           [](auto byte) { return byte != 0; })) {
      return broken(Cause::kMalformed);
    }
    const auto first = data->begin() + static_cast<std::ptrdiff_t>(wanted_.first);
    if (wanted_.count > 0)
      reply_.push_back({.items = Bytes(first, first + static_cast<std::ptrdiff_t>(wanted_.count))});
    return Step::done();
  }

  Step refusal(ByteView frame) {
    const auto code = read_digits(frame.subspan(2, 2));
    if (!code || *code == 0 || !check_is_right(frame))
      return broken(code ? Cause::kChecksum : Cause::kMalformed);
    const auto refused = static_cast<std::uint16_t>(*code);
    return Step::failed(device_code_cause(kRefusals, refused), refused);
  }
  Step broken(Cause cause) {  // a valid frame may follow
    silence_ = cause;
    return Step::need_rest(0);
  }

  const char command_;
  const std::uint8_t station_;
  const std::uint32_t length_;
  const Window sent_;
  const Range wanted_;      // count 0 if no range is read
  Written* const written_;  // destination for the window that the station reports after a write
  Reply reply_;
  Cause silence_ = Cause::kNoResponse;
};

class FreeportProtocol final : public Protocol {
 public:
  // `zero`: unknown bytes of the window to write are sent as zeros.
  FreeportProtocol(std::uint8_t station, bool swapped, bool zero)
      : station_(station), read_(swapped ? 'R' : 'W'), write_(swapped ? 'W' : 'R') {
    written_.known = zero;
  }

  const Traits& traits() const override { return kTraits; }
  std::span<const Area> areas() const override { return kAreas; }

  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override {
    const auto digit = [&](std::size_t index, char last) {
      return at.size() > index && at[index] >= '0' && at[index] <= last;
    };
    const bool byte = at.starts_with("window:") && digit(7, '3');
    const bool bit = byte && at.size() == 10 && at[8] == '.' && digit(9, '7');
    if (!bit && !(byte && at.size() == 8)) {
      return tl::unexpected(
          AddressFault{"'" + std::string(at.substr(0, 64)) + "' is no place in the window",
                       "window:N with the byte N 0..3, or window:N.BIT with BIT 0..7",
                       byte ? std::string(at.substr(0, 8)) : "window:0"});
    }
    ParsedAddress address{.first = static_cast<std::uint32_t>(at[7] - '0')};
    if (bit) address.bit = static_cast<std::uint8_t>(at[9] - '0'), address.width_bits = 1;
    return address;
  }

  std::optional<ExchangeSize> size(const Request& request) const override {
    if (!std::visit([&](const auto& each) { return fits(each); }, request)) return std::nullopt;
    return ExchangeSize::of(kRequest, kResponse);
  }

  std::unique_ptr<Exchange> begin(Request request, ExchangeContext) const override {
    if (const auto* read = std::get_if<ReadRequest>(&request)) {
      const Range& range = read->ranges.front();
      return std::make_unique<FreeportExchange>(read_, station_, range.end(), Window{}, range,
                                                nullptr);
    }
    // The response to a write is the window read back.
    const auto* both = std::get_if<WriteReadRequest>(&request);
    const WriteRequest& write = both != nullptr ? both->write : std::get<WriteRequest>(request);
    Window sent = written_.window;
    Bytes items = write.items;
    if (write.bit)
      items = {sent[write.range.first]},
      merge_bit(items, *write.bit, (write.items[0] >> *write.bit & 1) != 0);
    std::copy(items.begin(), items.end(), sent.begin() + write.range.first);
    std::fill(sent.begin() + write.range.end(), sent.end(), std::uint8_t{0});
    return std::make_unique<FreeportExchange>(write_, station_, write.range.end(), sent,
                                              both != nullptr ? both->read : Range{.count = 0},
                                              &written_);
  }

 private:
  static bool fits(const Range& range) { return fieldcast::fits(kAreas, range, true); }
  bool fits(const WriteRequest& write) const {
    return fits(write.range) && write.items.size() == write.range.count &&
           (!write.bit || (write.range.count == 1 && *write.bit < 8)) &&
           (written_.known || (write.range.first == 0 && !write.bit));
  }
  static bool fits(const ReadRequest& read) {
    return read.ranges.size() == 1 && fits(read.ranges[0]);
  }
  bool fits(const WriteReadRequest& both) const { return fits(both.write) && fits(both.read); }

  const std::uint8_t station_;
  const char read_, write_;
  // Only this device's exchanges modify it, one at a time.
  mutable Written written_;
};

constexpr std::array<std::string_view, 2> kOptions{"letters", "unknown-bytes"};
tl::expected<std::unique_ptr<Protocol>, OptionFault> make(const DeviceLink& link) {
  OptionReader reader(link, kTraits, kOptions);
  const bool swapped = reader.choice("letters", {"normal", "swapped"}) == 1;
  const bool zero = reader.choice("unknown-bytes", {"refuse", "zero"}) == 1;
  if (reader.fault()) return tl::unexpected(*reader.fault());
  return std::make_unique<FreeportProtocol>(static_cast<std::uint8_t>(link.address), swapped, zero);
}

constexpr std::string_view kAddresses[] = {"window:0", "window:1", "window:3", "window:2.7"};
constexpr ProtocolOption kSwapped[] = {{"letters", "swapped"}, {"unknown-bytes", "zero"}};
constexpr ProtocolVariant kVariants[] = {{.addresses = kAddresses},
                                         {.options = kSwapped, .addresses = kAddresses}};

}  // namespace

const ProtocolEntry& entry() {
  static constexpr ProtocolEntry row{.name = kTraits.name,
                                     .summary = kTraits.summary,
                                     .make = make,
                                     .explain = explain,
                                     .seen_request = seen_request,
                                     .options = kOptions,
                                     .options_text =
                                         "`letters: swapped`, `unknown-bytes: zero` (bytes of the "
                                         "window that are not known are written as 0)",
                                     .factory_line = {9600, 8, Parity::kNone, 1},
                                     .variants = kVariants};
  return row;
}

}  // namespace fieldcast::s7_freeport
