#include <algorithm>
#include <string>

#include "core/protocol/allen_bradley_df1/allen_bradley_df1.hpp"
#include "core/protocol/allen_bradley_df1/command.hpp"
#include "core/protocol/allen_bradley_df1/frame.hpp"
#include "core/protocol/field_writer.hpp"

namespace fieldcast::df1 {
namespace {

constexpr std::size_t kMaxExplained = 2048;

std::string hex(std::uint8_t byte) { return to_hex({&byte, 1}); }
std::string low_first(std::uint8_t low, std::uint8_t high) {
  return std::to_string(low | high << 8);
}

// The data of a packet, with the offset of each byte in the frame.
class PacketExplainer {
 public:
  PacketExplainer(ByteView data, std::vector<std::size_t> offsets, FieldWriter& writer)
      : data_(data), offsets_(std::move(offsets)), writer_(writer) {}

  void run() {
    if (data_.size() < kHead) return field(data_.size(), "data", "", "a packet has six bytes");
    const bool response = (data_[2] & 0x40u) != 0;
    field(1, "to", std::to_string(data_[0]));
    field(1, "from", std::to_string(data_[1]));
    field(1, "CMD", hex(data_[2]) + (response ? " response" : " command"));
    const std::uint8_t status = data_[3];
    field(1, "STS", status == kExtended ? "F0 see EXT STS" : device_code_words(kCodes, status),
          !response && status != 0 ? "must be 00 in a command" : "");
    field(2, "TNS", low_first(data_[4], data_[5]));
    if (!response) return command();
    if (status == kExtended && at_ < data_.size())
      field(1, "EXT STS",
            hex(data_[at_]) + ' ' +
                std::string(
                    device_code_text(kCodes, static_cast<std::uint16_t>(0xF000 | data_[at_]))));
    rest("data");
  }

 private:
  void field(std::size_t size, std::string name, const std::string& value,
             const std::string& fault = {}) {
    if (size == 0) return writer_.remark(value, fault);
    const std::size_t last = at_ + size - 1;
    writer_.add(offsets_[at_], offsets_[last] + 1 - offsets_[at_], std::move(name), value, fault);
    at_ += size;
  }
  void rest(const char* name) {
    if (at_ < data_.size()) field(data_.size() - at_, name, to_hex(data_.subspan(at_)));
  }

  // Empty if the packet ends before.
  std::optional<std::uint32_t> number(const char* name) {
    const std::size_t size = at_ < data_.size() && data_[at_] == 0xFF ? 3 : 1;
    if (at_ + size > data_.size()) return std::nullopt;
    const std::uint32_t value =
        size == 1 ? data_[at_] : static_cast<std::uint32_t>(data_[at_ + 1] | data_[at_ + 2] << 8);
    field(size, name, std::to_string(value));
    return value;
  }

  void command() {
    if (data_[2] != kCommand || at_ == data_.size()) return rest("data");
    const std::uint8_t function = data_[at_];
    const bool known = function == kRead || function == kWrite || function == kWriteMasked;
    field(1, "FNC",
          hex(function) + (function == kRead          ? " read"
                           : function == kWrite       ? " write"
                           : function == kWriteMasked ? " write bits"
                                                      : ""));
    if (!known || at_ == data_.size()) return rest("data");
    const std::size_t size = data_[at_];
    field(1, "bytes", std::to_string(size));
    if (!address()) return field(0, "", "", "incomplete: the address ends early");
    if (function == kWriteMasked && at_ + 2 <= data_.size())
      field(2, "mask", to_hex(data_.subspan(at_, 2)));
    const std::size_t left = data_.size() - at_;
    rest("data");
    if (left != (function == kRead ? 0 : size))
      writer_.remark("", std::to_string(left) + " bytes of data follow");
  }
  bool address() {
    const auto file = number("file");
    if (!file || at_ == data_.size()) return false;
    const FileRow* row = row_of_code(data_[at_]);
    field(1, "type", hex(data_[at_]) + (row != nullptr ? ' ' + std::string(row->name) : ""));
    return number("element") && number("sub-element");
  }

  const ByteView data_;
  const std::vector<std::size_t> offsets_;
  FieldWriter& writer_;
  std::size_t at_ = 0;
};

class LineExplainer {
 public:
  explicit LineExplainer(ByteView frame) : frame_(frame) {}

  std::vector<FrameField> run() {
    while (at_ < frame_.size()) symbol();
    if (frame_.empty()) writer_.remark("", "nothing to explain");
    return writer_.take();
  }

 private:
  void add(std::size_t size, const char* name, const std::string& value,
           const std::string& fault = {}) {
    writer_.add(at_, size, name, value, fault);
    at_ += size;
  }

  void symbol() {
    const ByteView bytes = frame_.subspan(at_);
    const std::uint8_t code = bytes.size() < 2 || bytes[0] != kDle ? 0 : bytes[1];
    switch (code) {
      case kAck: return add(2, "ACK", "received");
      case kNak: return add(2, "NAK", "damaged, or no space");
      case kEot: return add(2, "EOT", "nothing to send");
      case kEnq: return enquiry(bytes);
      case kSoh: {
        const std::size_t doubled = bytes.size() > 3 && bytes[2] == kDle ? 2 : 1;
        if (bytes.size() < 2 + doubled) break;
        station_ = bytes[1 + doubled];
        return add(2 + doubled, "SOH", "to station " + std::to_string(*station_));
      }
      case kStx: return packet(bytes);
      default: break;
    }
    add(bytes.size(), "noise", to_hex(bytes), "not a symbol of DF1");
  }

  // Alone it requests an acknowledgement; with a station it is a poll.
  void enquiry(ByteView bytes) {
    const std::size_t doubled = bytes.size() > 3 && bytes[2] == kDle ? 1 : 0;
    const bool poll = bytes.size() >= kPoll + doubled &&
                      static_cast<std::uint8_t>(bytes[2] + bytes[3 + doubled]) == 0;
    if (!poll) return add(2, "ENQ", "repeat the last ACK or NAK");
    add(kPoll + doubled, "ENQ", "poll of station " + std::to_string(bytes[2]));
  }

  void packet(ByteView bytes) {
    const Body body = parse_body(bytes);
    const auto station = std::exchange(station_, std::nullopt);
    const std::size_t begin = at_;
    add(2, "STX", "packet");
    FieldWriter inner(0, 1, writer_.depth() + 1);
    PacketExplainer(body.data, offsets(bytes, begin, body), inner).run();
    writer_.append(inner.take());
    at_ = begin + body.size;
    if (!body.ended) {
      const ByteView left = frame_.subspan(at_);
      if (left.empty()) return writer_.remark("", "incomplete: the packet does not end");
      return add(left.size(), "rest", to_hex(left), "must be 10 03, or 10 10 for a byte 10");
    }
    at_ -= 2;
    add(2, "ETX", "end");
    check(body.data, station);
  }

  void check(ByteView data, std::optional<std::uint8_t> station) {
    const ByteView left = frame_.subspan(at_);
    const auto begins = [&](const Bytes& right) {
      return left.size() >= right.size() && std::equal(right.begin(), right.end(), left.begin());
    };
    const Bytes crc = check_of(data, Check::kCrc, station);
    const Bytes bcc = check_of(data, Check::kBcc, station);
    if (begins(crc)) return add(2, "CRC", to_hex(crc));
    if (begins(bcc)) return add(1, "BCC", to_hex(bcc));
    if (left.empty()) return writer_.remark("", "incomplete: the check is missing");
    const std::size_t size = std::min<std::size_t>(2, left.size());
    add(size, "check", to_hex(left.first(size)),
        "should be CRC " + to_hex(crc) + " or BCC " + to_hex(bcc));
  }

  static std::vector<std::size_t> offsets(ByteView bytes, std::size_t begin, const Body& body) {
    std::vector<std::size_t> all;
    for (std::size_t at = 2; at < body.size && all.size() < body.data.size(); ++at) {
      const bool response = bytes[at] == kDle && bytes[at + 1] != kDle;
      at += bytes[at] == kDle ? 1 : 0;
      if (!response) all.push_back(begin + at);
    }
    return all;
  }

  const ByteView frame_;
  FieldWriter writer_;
  std::size_t at_ = 0;
  std::optional<std::uint8_t> station_;
};

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  return LineExplainer(frame.first(std::min(frame.size(), kMaxExplained))).run();
}

}  // namespace fieldcast::df1
