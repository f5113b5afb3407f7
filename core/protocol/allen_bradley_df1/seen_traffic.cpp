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

// Size of the check that is right for the packet before it; 0: none is.
std::size_t right_check(ByteView behind, ByteView packet, std::optional<std::uint8_t> station) {
  for (const Check check : {Check::kCrc, Check::kBcc}) {
    const std::size_t size = std::min(behind.size(), size_of(check));
    if (std::ranges::equal(check_of(packet, check, station), behind.first(size))) return size;
  }
  return 0;
}

class Df1Explainer {
 public:
  explicit Df1Explainer(ByteView frame) : frame_(frame) {}

  std::vector<FrameField> run() {
    while (at_ < frame_.size()) symbol(frame_.subspan(at_));
    if (frame_.empty()) writer_.remark("", "nothing to explain");
    return writer_.take();
  }

 private:
  void add(std::size_t size, const char* name, const std::string& value,
           const std::string& fault = {}) {
    if (size == 0) return writer_.remark(name, fault);
    writer_.add(at_, size, name, value, fault);
    at_ += size;
  }

  void symbol(ByteView bytes) {
    const std::uint8_t code = bytes.size() < 2 || bytes[0] != kDle ? 0 : bytes[1];
    if (code == kAck) return add(2, "ACK", "received");
    if (code == kNak) return add(2, "NAK", "damaged, or no space");
    if (code == kEot) return add(2, "EOT", "nothing to send");
    if (code == kStx) return packet(bytes);
    // The number of a station 10 is doubled.
    const std::size_t station = bytes.size() > 3 && bytes[2] == kDle && bytes[3] == kDle ? 3 : 2;
    if (code == kSoh && bytes.size() > station) {
      station_ = bytes[station];
      return add(station + 1, "SOH", "to station " + std::to_string(*station_));
    }
    const bool poll = bytes.size() > station + 1 &&
                      static_cast<std::uint8_t>(bytes[station] + bytes[station + 1]) == 0;
    if (code == kEnq && poll)
      return add(station + 2, "ENQ", "poll of station " + std::to_string(bytes[station]));
    if (code == kEnq) return add(2, "ENQ", "repeat the last ACK or NAK");
    add(bytes.size(), "noise", to_hex(bytes), "not a symbol of DF1");
  }

  void packet(ByteView bytes) {
    const Symbol symbol = parse_symbol(bytes, std::nullopt);
    data_ = symbol.packet;
    read_ = 0;
    offsets_.clear();
    for (std::size_t at = 2; offsets_.size() < data_.size(); ++at) {
      const bool dle = bytes[at] == kDle;
      if (!dle || bytes[at + 1] == kDle) offsets_.push_back(at_ + at);
      at += dle ? 1 : 0;
    }
    add(2, "STX", "packet");
    writer_.deeper();
    head();
    writer_.higher();
    at_ += symbol.size - 2;
    const ByteView left = frame_.subspan(at_);
    if (symbol.kind == Symbol::Kind::kPacket) return check(left);
    add(left.size(), "rest", to_hex(left), "the packet does not end with 10 03");
  }

  void head() {
    if (data_.size() < kHead) return rest("a packet has six bytes at least");
    field(1, "to", std::to_string(data_[0]));
    field(1, "from", std::to_string(data_[1]));
    const bool response = (data_[2] & kReply) != 0;
    field(1, "CMD", hex(data_[2]) + (response ? " response" : " command"));
    const std::uint8_t status = data_[3];
    field(1, "STS", status == 0 ? "00" : device_code_words(kCodes, status),
          !response && status != 0 ? "must be 00 in a command" : "");
    field(2, "TNS", std::to_string(data_[4] | data_[5] << 8));
    if (status == kExtended && left() > 0)
      field(1, "EXT STS",
            device_code_words(kCodes, static_cast<std::uint16_t>(0xF000 | data_[read_])));
    const std::size_t size = !response && data_[2] == kCommand ? command() : left();
    rest(left() == size ? "" : "should be " + std::to_string(size) + " bytes");
  }

  // Returns the number of data bytes that should follow.
  std::size_t command() {
    const std::uint8_t function = left() > 0 ? data_[read_] : 0;
    const bool read = function == kRead, masked = function == kWriteMasked;
    if (left() < 2 || (!read && !masked && function != kWrite)) return left();
    field(1, "FNC", hex(function) + (read ? " read" : masked ? " write bits" : " write"));
    const std::size_t size = read ? 0 : data_[read_];
    field(1, "bytes", std::to_string(data_[read_]));
    if (!number("file") || left() == 0) return size;
    const auto row = std::ranges::find(file_rows(), data_[read_], &FileRow::code);
    const std::string_view name = row == file_rows().end() ? "unknown" : row->name;
    field(1, "type", hex(data_[read_]) + ' ' + std::string(name));
    if (!number("element") || !number("sub-element")) return size;
    if (masked && left() >= 2) field(2, "mask", to_hex(data_.subspan(read_, 2)));
    return size;
  }

  std::size_t left() const { return data_.size() - read_; }
  void field(std::size_t size, const char* name, const std::string& value,
             const std::string& fault = {}) {
    const std::size_t first = offsets_[read_], last = offsets_[read_ + size - 1];
    writer_.add(first, last + 1 - first, name, value, fault);
    read_ += size;
  }
  void rest(const std::string& fault) {
    if (left() > 0) return field(left(), "data", to_hex(data_.subspan(read_)), fault);
    if (!fault.empty()) writer_.remark("data", fault);
  }
  // Returns false if the packet ends before.
  bool number(const char* name) {
    const std::size_t size = left() > 0 && data_[read_] == 0xFF ? 3 : 1;
    if (left() < size) return false;
    const int value = size == 1 ? data_[read_] : data_[read_ + 1] | data_[read_ + 2] << 8;
    field(size, name, std::to_string(value));
    return true;
  }

  void check(ByteView left) {
    const auto station = std::exchange(station_, std::nullopt);
    const std::size_t right = right_check(left, data_, station);
    if (right > 0) return add(right, right == 2 ? "CRC" : "BCC", to_hex(left.first(right)));
    left = left.first(std::min<std::size_t>(2, left.size()));
    add(left.size(), "check", to_hex(left),
        "should be CRC " + to_hex(check_of(data_, Check::kCrc, station)) + " or BCC " +
            to_hex(check_of(data_, Check::kBcc, station)));
  }

  const ByteView frame_;
  FieldWriter writer_;
  std::size_t at_ = 0;
  std::optional<std::uint8_t> station_;
  ByteView data_;                     // of the packet,
  std::vector<std::size_t> offsets_;  // their offsets in the frame,
  std::size_t read_ = 0;              // and how many are explained
};

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  return Df1Explainer(frame.first(std::min(frame.size(), kMaxExplained))).run();
}

// Of a half-duplex master. With full duplex a command is a message of the PLC itself.
SeenRequest seen_request(ByteView bytes) {
  if (bytes.size() < 4 || bytes[0] != kDle || bytes[1] != kSoh) return {};
  const std::size_t at = bytes[2] == kDle ? 4 : 3;
  if (bytes.size() < at + kSymbol || bytes[at] != kDle || bytes[at + 1] != kStx) return {};
  const Symbol symbol = parse_symbol(bytes.subspan(at), std::nullopt);
  const bool whole = symbol.kind == Symbol::Kind::kPacket && symbol.packet.size() >= kHead;
  if (!whole || (symbol.packet[2] & kReply) != 0) return {};
  const std::size_t end = at + symbol.size;
  const std::size_t check = right_check(bytes.subspan(end), symbol.packet, bytes[2]);
  return {check > 0 ? end + check : 0, true};
}

}  // namespace fieldcast::df1
