// The interface between a PLC family and the rest of Fieldcast.
//
// A protocol names its areas and limits, understands its address notation, says how long a request
// and its answer are, explains frames to people, and makes exchanges. An exchange is one
// conversation without a socket or a clock: it is told all bytes that came since it last sent, and
// says what to do next. Timeouts, retries, echo, statistics, tracing and fuzzing are written once,
// around it.
//
// A Protocol object is made for one device and does not change, but for what its own exchanges must
// remember of that device (the bytes that an S7 freeport station holds). An Exchange belongs to one
// conversation. No threads here.
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

// An area's index in Protocol::areas().
using AreaIndex = std::uint8_t;

// One register class of a protocol, addressed 0 .. items-1.
struct Area {
  std::string_view name;    // "holding", "V", "DM"
  unsigned item_bits = 16;  // 1, 8, 16, 32 or 64
  // What an item holds, where the family leaves no choice: the variables of DTC, current values of
  // timers and counters.
  std::optional<ValueType> type = std::nullopt;
  std::uint32_t items = 65536;  // size of the address space
  bool writable = false;
  std::uint16_t max_read = 125;   // items in one range of a read
  std::uint16_t max_write = 123;  // items in one write
  // Reads start and end at multiples of this (FX reads bits by whole bytes: 8).
  std::uint16_t alignment = 1;
  bool bit_write = false;   // one bit of an item can be written without touching the others
  bool byte_write = false;  // so can eight bits of it, from a multiple of eight on
  // The family's own order, where a configuration says none: of the items of a value that needs
  // several, and of the characters in an item.
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder text_order = ByteOrder::kBigEndian;
  // A window is read whole in one request whatever is wanted of it (S7 freeport).
  bool window = false;
  std::uint32_t bank = 0;  // no range crosses a multiple of this (EM of Omron); 0: none
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

// The canonical image of items: bit items one byte each (0 or 1), 8-bit items one byte, wider ones
// big-endian.
[[nodiscard]] constexpr std::size_t image_bytes(unsigned item_bits, std::uint32_t count) {
  return item_bits <= 8 ? count : count * (item_bits / 8);
}

struct ReadRequest {
  std::vector<Range> ranges;  // 1 .. Traits::max_ranges, in any order
};
struct WriteRequest {
  Range range;
  Bytes items;  // the image of range
  // Only this bit of the one item: items is the whole item, other bits are ignored
  // (Area::bit_write).
  std::optional<std::uint8_t> bit;
  // Choose a form whose answer cannot be mistaken for an echo of the request.
  bool distinct_answer = false;
  unsigned bits = 1;  // with `bit`: how many bits from there on; 8 only with Area::byte_write
};
// Writes, then reads, in one round (Modbus function 23); only where Traits::write_read.
struct WriteReadRequest {
  WriteRequest write;
  Range read;
};
using Request = std::variant<ReadRequest, WriteRequest, WriteReadRequest>;

// What came of one range of a request.
struct RangeReply {
  Cause cause = Cause::kNone;
  std::uint16_t device_code = 0;  // with kDeviceError: exception code, end code, item code
  Bytes items;                    // the image, when cause is kNone; empty for a write
};
// One entry for each range of a read, one for a write.
using Reply = std::vector<RangeReply>;

// Sizes of a request and its answer, exact: the raw material of the cost model.
struct ExchangeSize {
  std::uint32_t request_characters = 0;
  std::uint32_t answer_characters = 0;
  std::uint32_t rounds = 1;  // how often the device's answer time and the line's silence are paid
  // Waits that the protocol itself prescribes (PPI between acknowledge and poll).
  Duration pauses{};
};

// What an exchange waits for after a step.
enum class Wait : std::uint8_t {
  kAnswer,  // the first byte of an answer: the device's timeout, from the end of the transmission
  kRestOfFrame,  // `characters` more: their wire time and a gap allowance, from now
  kPause,        // nothing: on_silence() after `pause`
};

struct Step {
  enum class Kind : std::uint8_t { kSend, kNeedMore, kDone, kFailed };
  Kind kind = Kind::kNeedMore;
  Wait wait = Wait::kAnswer;  // kSend, kNeedMore
  // kSend: length of the whole expected answer; kRestOfFrame: what is still missing, at least.
  std::uint32_t characters = 0;
  Duration pause{};
  Cause cause = Cause::kNone;     // kFailed
  std::uint16_t device_code = 0;  // kFailed with kDeviceError or kDeviceBusy

  static Step send(std::uint32_t answer_characters) {
    return {Kind::kSend, Wait::kAnswer, answer_characters};
  }
  static Step need_answer() { return {Kind::kNeedMore, Wait::kAnswer, 0}; }
  static Step need_rest(std::uint32_t missing) {
    return {Kind::kNeedMore, Wait::kRestOfFrame, missing};
  }
  static Step pause_for(Duration time) { return {Kind::kNeedMore, Wait::kPause, 0, time}; }
  static Step done() { return {Kind::kDone}; }
  static Step failed(Cause cause, std::uint16_t code = 0) {
    return {Kind::kFailed, Wait::kAnswer, 0, Duration{}, cause, code};
  }
};

class Exchange {
 public:
  virtual ~Exchange() = default;
  // Writes the first request into out (which comes empty). Always kSend.
  [[nodiscard]] virtual Step start(Bytes& out) = 0;
  // `all` is everything received since the last send, hostile or not. Frames of others are skipped
  // and the wait goes on; a frame that is broken is waited out (kRestOfFrame) in case the right one
  // follows. Never consumes: it may be called with any growing prefix.
  [[nodiscard]] virtual Step on_bytes(ByteView all, Bytes& out) = 0;
  // The wait that the last step named ran out: the reason in kFailed, another send, or kDone when
  // what kept the answer back was noise.
  [[nodiscard]] virtual Step on_silence(Bytes& out) = 0;
  // After kDone.
  [[nodiscard]] virtual const Reply& reply() const = 0;
};

// What differs from one exchange of a device to the next.
struct ExchangeContext {
  // Counts exchanges with this device; becomes transaction id, SID, reference, frame-count bit.
  std::uint16_t sequence = 0;
};

// An address in the PLC's own notation, understood.
struct ParsedAddress {
  AreaIndex area = 0;
  std::uint32_t first = 0;
  std::optional<std::uint8_t> bit;     // "DM100.5", "I0.3": bit of the item
  std::optional<unsigned> width_bits;  // what the notation itself fixes: VB 8, VW 16, VD 32, coil 1
  // Bits of the number, where it is narrower than its items (a declared field); 0: unknown, or as
  // wide as they.
  unsigned value_bits = 0;
  bool value_signed = false;          // with value_bits: its sign fills the rest of the items
  std::uint16_t text_characters = 0;  // a text of so many: strings, and numbers as text
  TextNumber text_number = {};        // the form of the number that the text spells
};
struct AddressFault {
  std::string what;  // "area 'holdin' is unknown"
  // "coil:N, input:N, holding:N, input-register:N with N 0..65535, or 00001.., 10001.., 30001..,
  // 40001..".
  std::string allowed;
  std::string suggestion;  // "holding:100", or empty
};

// One line of an explained frame.
struct FrameField {
  unsigned depth = 0;      // indent
  std::size_t offset = 0;  // first byte
  std::size_t length = 0;  // 0: a remark about the whole
  std::string name;        // "function"
  std::string value;       // "03 read holding registers"
  std::string fault;       // what is wrong with it, or empty
};

// How an answer shows which request it belongs to. Decides, with Protocol::mistakable(), what may
// be asked while a late answer could still come.
enum class AnswerIdentity : std::uint8_t {
  kSequence,  // by a number of the request (Modbus TCP): anything may follow a timeout
  kAddress,   // by the device (Modbus RTU): its answers are not mistaken for those of others
  kNone,      // by nothing (S7 freeport): no other device of the bus may be asked either
};

// What a whole family can do, besides its areas.
struct Traits {
  std::string_view name;             // "modbus-rtu"
  std::string_view summary;          // one line for people
  std::uint16_t lowest_address = 1;  // of a device
  std::uint16_t highest_address = 247;
  std::uint16_t max_ranges = 1;  // ranges in one read request
  bool write_read = false;       // WriteReadRequest
  AnswerIdentity identity = AnswerIdentity::kAddress;
  bool echo_is_ambiguous = false;       // some write's answer equals its request
  std::span<const DeviceCode> codes{};  // with which its devices refuse
};

class Protocol {
 public:
  virtual ~Protocol() = default;
  [[nodiscard]] virtual const Traits& traits() const = 0;
  [[nodiscard]] virtual std::span<const Area> areas() const = 0;
  [[nodiscard]] virtual tl::expected<ParsedAddress, AddressFault> parse_address(
      std::string_view at) const = 0;
  // Exact, cheap (called in the inner loops of planning). Nothing when the request breaks a limit:
  // too many items, a frame too long.
  [[nodiscard]] virtual std::optional<ExchangeSize> size(const Request& request) const = 0;
  // REQUIRES: size(request) holds a value.
  [[nodiscard]] virtual std::unique_ptr<Exchange> begin(Request request,
                                                        ExchangeContext context) const = 0;
  // Whether a late answer to `earlier` could be taken for the answer to `later`, asked of the same
  // device. In doubt: yes. The default: yes, unless the answers carry another number.
  [[nodiscard]] virtual bool mistakable([[maybe_unused]] const Request& earlier,
                                        ExchangeContext earlier_context,
                                        [[maybe_unused]] const Request& later,
                                        ExchangeContext later_context) const;
};

// Explains one frame to people. Never fails: what cannot be understood is a field with a fault.
using Explainer = std::vector<FrameField> (*)(ByteView frame);

// A protocol for one device: its address and the protocol's own options (name -> text, from the
// configuration), and the line of its bus, which the engine fills in for those who weigh what the
// wire costs (DTC: what is worth compressing).
struct DeviceLink {
  std::uint16_t address = 1;
  std::map<std::string, std::string> options;
  LineFormat line{};
  friend bool operator==(const DeviceLink&, const DeviceLink&) = default;
};
struct OptionFault {
  std::string option;  // which one, or empty for the address
  std::string what;
  std::string allowed;
};

}  // namespace fieldcast
