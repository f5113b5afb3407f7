// The interface between a PLC family and the rest of Fieldcast. A protocol defines its areas and
// limits, parses its address notation, computes the size of a request and its response, explains
// frames, and creates exchanges. An exchange is one request with its response, without a socket or
// a clock: it receives all bytes since its last send and returns the next step. Timeouts, retries,
// echo, statistics, tracing and fuzzing are implemented once, around it. A Protocol object serves
// one device. It is immutable, except for state that its exchanges need (the bytes held by an S7
// freeport station). No threads here.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <variant>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/frame/line.hpp"
#include "core/protocol/device_code.hpp"

namespace fieldcast {

using AreaIndex = std::uint8_t;

// One register class of a protocol, addressed 0 .. items-1.
struct Area {
  std::string_view name;    // "holding", "V", "DM"
  unsigned item_bits = 16;  // 1, 8, 16, 32 or 64
  // If the family fixes it: variables of DTC, current values of timers and counters.
  std::optional<ValueType> type = std::nullopt;
  std::uint32_t items = 65536;  // size of the address space
  bool writable = false;
  std::uint16_t max_read = 125;   // items in one range of a read
  std::uint16_t max_write = 123;  // items in one write
  // Reads start and end at multiples of this (FX reads bits in whole bytes: 8).
  std::uint16_t alignment = 1;
  bool bit_write = false;   // one bit of an item can be written without changing the others
  bool byte_write = false;  // the same for eight bits, from a multiple of eight
  bool mask_write = false;  // the same for any bits (WriteRequest::mask)
  // Default of the family: order of the items of a value, and of the characters in an item.
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder text_order = ByteOrder::kBigEndian;
  // Every request reads the window as a whole (S7 freeport).
  bool window = false;
  // A write also sends the items before it, and the other bits of its item. While the device has
  // not reported them, only a write of whole items from the first one on is possible.
  bool sends_earlier = false;
  std::uint32_t bank = 0;  // no range crosses a multiple of this (EM of Omron); 0: none
  // The first item of a bank counts the others that exist at the moment (queues).
  bool counted = false;
  // Usual time between two frames in which the device sends the items by itself; no request reads
  // them. Zero: they are requested.
  Duration unsolicited{};
  // Longest pause behind a write that no response follows; reading back shows its effect. Zero:
  // every write has a response.
  Duration no_response{};
};

[[nodiscard]] constexpr bool in_one_bank(const Area& area, std::uint32_t first, std::uint32_t end) {
  return area.bank == 0 || first / area.bank == (end - 1) / area.bank;
}

// Items first .. first+count-1 of an area.
struct Range {
  AreaIndex area = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 1;
  [[nodiscard]] std::uint32_t end() const { return first + count; }
  friend bool operator==(const Range&, const Range&) = default;
};

// Whether the area has these items, and one read or one write may contain them.
[[nodiscard]] constexpr bool fits(std::span<const Area> areas, const Range& range, bool write) {
  if (range.area >= areas.size()) return false;
  const Area& area = areas[range.area];
  return range.count >= 1 && range.count <= (write ? area.max_write : area.max_read) &&
         range.first < area.items && range.count <= area.items - range.first;
}

// Canonical image: bit items and 8-bit items use one byte each, wider ones are big-endian.
[[nodiscard]] constexpr std::size_t image_bytes(unsigned item_bits, std::uint32_t count) {
  return item_bits <= 8 ? count : count * (item_bits / 8);
}

struct ReadRequest {
  std::vector<Range> ranges;  // 1 .. Traits::max_ranges, in any order
};
struct WriteRequest {
  Range range;
  Bytes items;  // the image of `range`
  // `items` is the whole item; its other bits are ignored (Area::bit_write).
  std::optional<std::uint8_t> bit;
  // Selects a form whose response cannot equal its request, as an echo would.
  bool distinct_response = false;
  unsigned bits = 1;  // with `bit`: number of bits from there; 8 only with Area::byte_write
  // Only these bits of the item change; only with Area::mask_write.
  std::optional<std::uint16_t> mask = std::nullopt;
};
// Writes, then reads, in one round (Modbus function 23); only with Traits::write_read.
struct WriteReadRequest {
  WriteRequest write;
  Range read;
};
using Request = std::variant<ReadRequest, WriteRequest, WriteReadRequest>;

struct RangeReply {
  Cause cause = Cause::kNone;
  std::uint16_t device_code = 0;  // with kDeviceError: exception code, end code, item code
  Bytes items;                    // the image if cause is kNone; empty for a write
  // Parts of the range that have no value in this response, but may have one in the next.
  std::vector<Range> absent{};
};
// One entry for each range of a read, one for a write.
using Reply = std::vector<RangeReply>;

// Exact, for the cost model.
struct ExchangeSize {
  std::uint32_t request_characters = 0;
  std::uint32_t response_characters = 0;
  std::uint32_t rounds = 1;  // number of device response times and line silences
  // Pauses required by the protocol (PPI between acknowledge and poll).
  Duration pauses{};
  // Wire time of a response at another baud rate, whose characters are not counted above.
  Duration response_at_other_rate{};

  static ExchangeSize of(std::size_t request, std::size_t response, std::uint32_t rounds = 1,
                         Duration pauses = {}) {
    return {static_cast<std::uint32_t>(request), static_cast<std::uint32_t>(response), rounds,
            pauses};
  }
  [[nodiscard]] Duration response_wire_time(const LineFormat& line) const {
    return line.characters(response_characters) + response_at_other_rate;
  }
  // Excludes the pauses.
  [[nodiscard]] Duration wire_time(const LineFormat& line) const {
    return line.characters(request_characters + response_characters) + response_at_other_rate;
  }
};

// Result of a search in bytes that arrived without a request.
struct UnsolicitedFrame {
  std::size_t used = 0;          // bytes at the beginning that no later search needs
  bool boundary = false;         // a frame ends behind them
  std::optional<Range> range{};  // the items of a frame; empty if no frame was found
  Bytes items{};                 // the image of `range`
  std::vector<Range> absent{};   // parts of `range` that have no value in this frame
};

enum class Wait : std::uint8_t {
  kResponse,     // first byte of a response: the device's timeout, from the end of the transmission
  kRestOfFrame,  // `characters` more: their wire time and a gap allowance, from now
  kPause,        // calls on_silence() after `pause`; with kSend, no response is expected
};

struct Step {
  enum class Kind : std::uint8_t { kSend, kNeedMore, kDone, kFailed };
  Kind kind = Kind::kNeedMore;
  Wait wait = Wait::kResponse;  // for kSend, kNeedMore
  // kSend: length of the whole expected response; kRestOfFrame: minimum of missing characters.
  std::uint32_t characters = 0;
  Duration pause{};
  Cause cause = Cause::kNone;       // for kFailed
  std::uint16_t device_code = 0;    // for kFailed with kDeviceError or kDeviceBusy
  std::uint32_t response_baud = 0;  // for kSend: rate of the response; 0: that of the line

  static Step send(std::size_t response_characters) {
    return {Kind::kSend, Wait::kResponse, static_cast<std::uint32_t>(response_characters)};
  }
  static Step send_without_response(Duration pause) {
    return {Kind::kSend, Wait::kPause, 0, pause};
  }
  static Step need_response() { return {Kind::kNeedMore, Wait::kResponse, 0}; }
  static Step need_rest(std::size_t missing) {
    return {Kind::kNeedMore, Wait::kRestOfFrame, static_cast<std::uint32_t>(missing)};
  }
  static Step pause_for(Duration time) { return {Kind::kNeedMore, Wait::kPause, 0, time}; }
  static Step done() { return {Kind::kDone}; }
  static Step failed(Cause cause, std::uint16_t code = 0) {
    return {Kind::kFailed, Wait::kResponse, 0, Duration{}, cause, code};
  }
};

class Exchange {
 public:
  virtual ~Exchange() = default;
  // Writes the first request into the empty `out`. Always kSend.
  [[nodiscard]] virtual Step start(Bytes& out) = 0;
  // `all`: every byte since the last send, untrusted. Foreign frames are skipped and the wait
  // continues. After a broken frame the exchange waits (kRestOfFrame) for a valid one. Consumes no
  // bytes: it may be called with any growing prefix. With kDone and kFailed, `out` may contain a
  // confirmation, which has no response.
  [[nodiscard]] virtual Step on_bytes(ByteView all, Bytes& out) = 0;
  // The wait expired. Returns kFailed, another send, or kDone if only noise delayed the response.
  [[nodiscard]] virtual Step on_silence(Bytes& out) = 0;
  // Only valid after kDone.
  [[nodiscard]] virtual const Reply& reply() const = 0;
};

struct ExchangeContext {
  // Counts exchanges with this device; used as transaction id, SID, reference, frame-count bit.
  std::uint16_t sequence = 0;
  // Results of greetings on this connection (node numbers, logins), encoded by the protocol. The
  // bus empties it when it opens the port. An exchange that does not find its result sends the
  // greeting first and stores the result here; it may remove the result after a failure. Shared by
  // all devices of the bus. Null: the exchange always sends the greeting.
  Bytes* session = nullptr;
};

struct ParsedAddress {
  AreaIndex area = 0;
  std::uint32_t first = 0;
  std::optional<std::uint8_t> bit;     // bit of the item: "DM100.5", "I0.3"
  std::optional<unsigned> width_bits;  // width fixed by the notation: VB 8, VW 16, VD 32, coil 1
  // Bits of the number if narrower than its items (a declared field); 0: unknown, or full width.
  unsigned value_bits = 0;
  bool value_signed = false;          // with value_bits: the sign fills the rest of the items
  std::uint16_t text_characters = 0;  // length of a text: strings, and numbers as text
  TextNumber text_number = {};        // format of a number written as text
  TextLayout text_layout = TextLayout::kPlain;
};
struct AddressFault {
  std::string what;  // "area 'holdin' is unknown"
  // "coil:N, input:N, holding:N, input-register:N with N 0..65535, or 00001.., 10001.., 30001..,
  // 40001..".
  std::string allowed;
  std::string suggestion;  // "holding:100", or empty
};

struct FrameField {
  unsigned depth = 0;      // indentation
  std::size_t offset = 0;  // first byte
  std::size_t length = 0;  // 0 for a remark about the whole
  std::string name;        // "function"
  std::string value;       // "03 read holding registers"
  std::string fault;       // description of the error, or empty
};

// How a response identifies its request, see Protocol::mistakable().
enum class ResponseIdentity : std::uint8_t {
  kSequence,  // by a number of the request (Modbus TCP): any request may follow a timeout
  kAddress,   // by the device (Modbus RTU): responses of different devices cannot be confused
  kNone,      // not at all (S7 freeport): no device of the bus may be polled
};

struct Traits {
  std::string_view name;
  std::string_view summary;          // one human-readable line
  std::uint16_t lowest_address = 1;  // of a device
  std::uint16_t highest_address = 247;
  // Ranges in one read request; `size` may permit several in some areas only.
  std::uint16_t max_ranges = 1;
  bool write_read = false;  // supports WriteReadRequest
  ResponseIdentity identity = ResponseIdentity::kAddress;
  bool echo_is_ambiguous = false;       // the response of some write equals its request
  std::span<const DeviceCode> codes{};  // codes of refusals
};

class Protocol {
 public:
  virtual ~Protocol() = default;
  [[nodiscard]] virtual const Traits& traits() const = 0;
  [[nodiscard]] virtual std::span<const Area> areas() const = 0;
  [[nodiscard]] virtual tl::expected<ParsedAddress, AddressFault> parse_address(
      std::string_view at) const = 0;
  // Exact and fast (called in the inner loops of planning). Empty if the request exceeds a limit.
  [[nodiscard]] virtual std::optional<ExchangeSize> size(const Request& request) const = 0;
  // REQUIRES: size(request) holds a value.
  [[nodiscard]] virtual std::unique_ptr<Exchange> begin(Request request,
                                                        ExchangeContext context) const = 0;
  // Returns true if a late response to `earlier` could be matched to `later`, a request to the same
  // device; in doubt, true. The default returns true unless the sequence numbers differ.
  [[nodiscard]] virtual bool mistakable([[maybe_unused]] const Request& earlier,
                                        ExchangeContext earlier_context,
                                        [[maybe_unused]] const Request& later,
                                        ExchangeContext later_context) const;
  // Searches the first whole frame of this device in untrusted bytes. `boundary`: the bytes begin
  // behind the end of a frame. The default uses all bytes and finds none.
  [[nodiscard]] virtual UnsolicitedFrame find_unsolicited(ByteView bytes, bool boundary) const;
};

// Explains one frame. Never fails: invalid parts become fields with a fault.
using Explainer = std::vector<FrameField> (*)(ByteView frame);

// Parameters of a protocol for one device: its address and options (name -> text, from the
// configuration), and the line of its bus, for protocols that compute wire times.
struct DeviceLink {
  std::uint16_t address = 1;
  std::map<std::string, std::string> options;
  LineFormat line{};
  // As written, if `address` cannot represent it: text, or more than 16 bits. Only declared
  // protocols have such addresses.
  std::string long_address{};
  friend bool operator==(const DeviceLink&, const DeviceLink&) = default;
};
// As written.
[[nodiscard]] std::string address_text(const DeviceLink& link);

struct OptionFault {
  std::string option;  // name of the option; empty for the address
  std::string what;
  std::string allowed;
};

}  // namespace fieldcast
