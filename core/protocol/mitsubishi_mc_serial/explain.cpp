#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/mitsubishi_mc/command_names.hpp"
#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/mitsubishi_mc_serial/codes.hpp"
#include "core/protocol/mitsubishi_mc_serial/mitsubishi_mc_serial.hpp"
#include "core/protocol/mitsubishi_mc_serial/seen_traffic.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr std::size_t kMaxExplained = 8192;  // characters

std::string digits(std::uint32_t number, std::size_t count) {
  Bytes text;
  append_digits(text, number, static_cast<unsigned>(count));
  return {text.begin(), text.end()};
}

std::string_view short_command_name(std::string_view command) {
  static constexpr std::pair<std::string_view, std::string_view> kNames[] = {
      {"BR", "read bits"},        {"WR", "read words"},     {"BW", "write bits"},
      {"WW", "write words"},      {"JR", "read bits"},      {"QR", "read words"},
      {"JW", "write bits"},       {"QW", "write words"},    {"BT", "write some bits"},
      {"WT", "write some words"}, {"PC", "read CPU model"}, {"TT", "loopback test"}};
  for (const auto& [name, words] : kNames) {
    if (name == command) return words;
  }
  return {};
}

class SerialExplainer {
 public:
  explicit SerialExplainer(ByteView frame) : frame_(frame) {}

  std::vector<FrameField> run() {
    binary_ = frame_.size() >= 2 && frame_[0] == kDle && frame_[1] == kStx;
    const std::uint8_t first = frame_.empty() ? 0 : frame_[0];
    if (!binary_ && first != kEnq && first != kStx && first != kAck && first != kNak) {
      writer_.remark(printable(frame_.first(std::min<std::size_t>(frame_.size(), 16))),
                     "no frame begins so: 05, 02, 06, 15 or 10 02");
      return writer_.take();
    }
    binary_ ? cut_binary() : cut_ascii(first);
    format_ = format_of(first);
    writer_.remark(title(first));
    if (binary_) count();
    header();
    if (!response_)
      request();
    else if (binary_)
      number("response", 2), code();
    if (response_ && format_.enclosed)
      add(format_.end_code_size(), "end code", raw(format_.end_code_size()));
    if (refused_) code();
    if (left() > 0) add(left(), response_ ? "data" : "parameters", raw(left()));
    ending();
    return writer_.take();
  }

 private:
  // Sets the text between the marks, the offset of each of its characters, and the offset behind.
  void cut_ascii(std::uint8_t first) {
    std::size_t end = frame_.size();
    if (first == kStx)
      end = static_cast<std::size_t>(std::ranges::find(frame_, kEtx) - frame_.begin());
    if (first != kStx && end >= 3 && frame_[end - 1] == '\n' && frame_[end - 2] == '\r') end -= 2;
    if (first == kEnq && end >= 3 && has_sum(frame_.subspan(1, end - 1))) end -= 2;
    for (std::size_t at = 1; at < end; ++at) keep(at);
    behind_ = end;
    sum_expected_ = first == kEnq || first == kStx;
  }
  void cut_binary() {
    std::size_t at = 2;
    for (; at < frame_.size(); ++at) {
      const bool pair = frame_[at] == kDle;
      if (pair && (at + 1 == frame_.size() || frame_[at + 1] != kDle)) break;
      keep(at);
      if (pair) ++at;
    }
    behind_ = at;
    sum_expected_ = true;
  }
  void keep(std::size_t at) {
    text_.push_back(frame_[at]);
    offsets_.push_back(at);
  }

  // A request without a sum is as long as its command needs.
  static bool has_sum(ByteView text) {
    if (text.size() <= header_size({.frame = frame_of(text)})) return false;
    const auto request = ascii_request(text);
    return !request || text.size() > request->size;
  }

  // A frame does not contain the number of its format. A block number is recognized by the
  // identifier behind it, which is not a valid station or PC. In 1C frames it is recognized by a
  // known command or by the length of a short response, so not in responses with data.
  SerialFormat format_of(std::uint8_t first) {
    response_ = binary_ ? is_binary_response() : first != kEnq;
    refused_ = first == kNak;
    if (binary_) return {.binary = true};
    const auto request = ascii_request(text_);
    const bool enclosed =
        first == kStx && request && request->certain && request->size == text_.size();
    if (request && (first == kEnq || enclosed)) {
      response_ = false;
      SerialFormat format = request->format;
      format.enclosed = enclosed;
      return format;
    }
    const ByteView behind = ByteView(text_).subspan(std::min(text_.size(), kBlockDigits));
    SerialFormat format{.frame = frame_of(behind)};
    format.numbered = format.frame != SerialFrame::k1c;
    if (!format.numbered) format.frame = frame_of(text_);
    if (format.frame == SerialFrame::k1c && (first == kAck || first == kNak))
      format.numbered = behind.size() == header_size(format) + (refused_ ? format.code_size() : 0);
    if (first == kStx) find_end_code(format);
    return format;
  }

  void find_end_code(SerialFormat& format) {
    const EndCodePair codes = end_codes_of(format.frame);
    const ByteView text = ByteView(text_).subspan(std::min(text_.size(), header_size(format)));
    for (const std::string_view code : {codes.done, codes.refused}) {
      if (!printable(text).starts_with(code)) continue;
      format.enclosed = true;
      refused_ = code == codes.refused;
    }
  }

  bool is_binary_response() const {
    const std::size_t at = 2 + header_size({.binary = true});
    return text_.size() >= at + 2 && text_[at] == 0xFF && text_[at + 1] == 0xFF;
  }

  std::string title(std::uint8_t first) const {
    const std::string_view name = format_.frame == SerialFrame::k4c   ? "4C "
                                  : format_.frame == SerialFrame::k3c ? "3C "
                                                                      : "1C ";
    const std::string_view kind = !response_                   ? "request"
                                  : refused_                   ? "refusal"
                                  : first == kAck || is_done() ? "response without data"
                                                               : "response";
    const bool line_end = frame_.size() >= 2 && frame_.back() == '\n';
    return std::string(name) + std::string(kind) + ", format " +
           (binary_            ? "5"
            : line_end         ? "4"
            : format_.enclosed ? "3"
            : format_.numbered ? "2"
                               : "1");
  }

  // A response of format 3 without data.
  [[nodiscard]] bool is_done() const {
    return response_ && format_.enclosed &&
           text_.size() == header_size(format_) + format_.end_code_size();
  }
  [[nodiscard]] std::size_t left() const { return text_.size() - at_; }
  [[nodiscard]] ByteView next(std::size_t size) const { return ByteView(text_).subspan(at_, size); }
  [[nodiscard]] std::string raw(std::size_t size) const {
    return binary_ ? to_hex(next(size)) : printable(next(size));
  }

  void add(std::size_t size, std::string name, const std::string& value,
           const std::string& fault = {}) {
    const std::size_t begin = offsets_[at_];
    const std::size_t end = at_ + size < text_.size() ? offsets_[at_ + size] : behind_;
    writer_.add(begin, end - begin, std::move(name), value, fault);
    at_ += size;
  }

  // Returns the number; 0 if it is missing or not a number.
  template <typename Words>
  std::uint32_t number(std::string name, std::size_t bytes, Words words) {
    const Format code{.ascii = !binary_};
    const std::size_t size = bytes * code.width();
    if (left() < size) {
      if (!short_) writer_.remark("", name + " is missing");
      short_ = true;
      at_ = text_.size();
      return 0;
    }
    const auto value = read_number(next(size), code, bytes);
    std::string text = value ? digits(*value, 2 * bytes) : raw(size);
    if (value) text += words(*value);
    add(size, std::move(name), text, value ? "" : "not hexadecimal digits");
    return value.value_or(0);
  }
  std::uint32_t number(std::string name, std::size_t bytes) {
    return number(std::move(name), bytes, [](std::uint32_t) { return std::string(); });
  }

  void count() {
    if (left() < 2) return static_cast<void>(number("count", 2));
    const std::size_t present = left() - 2;
    const auto counted = *read_number(next(2), {}, 2);
    add(2, "count", std::to_string(counted),
        counted == present ? "" : "should be " + std::to_string(present));
  }

  void header() {
    const bool is_4c = format_.frame == SerialFrame::k4c, is_1c = format_.frame == SerialFrame::k1c;
    if (format_.numbered) number("block", 1);
    if (!is_1c) number("frame", 1);
    number("station", 1);
    if (!is_1c) number("network", 1);
    number("PC", 1);
    if (is_4c) number("module", 2), number("unit", 1);
    if (!is_1c) number("own station", 1);
  }

  void request() {
    if (format_.frame != SerialFrame::k1c) {
      number("command", 2, [](std::uint32_t command) {
        const std::string_view name = command_name(command);
        return name.empty() ? std::string() : " " + std::string(name);
      });
      number("subcommand", 2);
      return;
    }
    if (left() < 3) return;
    const std::string command = printable(next(2));
    const std::string_view name = short_command_name(command);
    add(2, "command", command + (name.empty() ? "" : " ") + std::string(name));
    const auto wait = read_digits(next(1));
    add(1, "wait", wait ? std::to_string(*wait * 10) + " ms" : raw(1),
        wait ? "" : "not a hexadecimal digit");
  }

  void code() {
    const bool is_short = format_.frame == SerialFrame::k1c;
    const auto words = [&](std::uint32_t value) {
      if (value == 0 && !is_short) return std::string();
      const auto number = static_cast<std::uint16_t>(value);
      const std::string_view text =
          is_short ? device_code_text(kShortCodes, number) : device_code_text(kSerialCodes, number);
      return text.empty() ? std::string() : " " + std::string(text);
    };
    number("code", is_short ? 1 : 2, words);
  }

  // From the mark behind the text on.
  void ending() {
    std::size_t at = behind_;
    Bytes summed = text_;
    if (binary_ || frame_[0] == kStx) {
      const std::size_t size = binary_ ? 2 : 1;
      if (frame_.size() < at + size || frame_[at + size - 1] != kEtx)
        return writer_.remark("", "incomplete: 03 and the sum are missing");
      if (!binary_) summed.push_back(kEtx);
      at += size;
    }
    const bool without_sum = !binary_ && response_ && format_.enclosed && (refused_ || is_done());
    if (sum_expected_ && !without_sum) at = sum(at, summed);
    const ByteView rest = frame_.subspan(at);
    static constexpr std::array<std::uint8_t, 2> kLineEnd{'\r', '\n'};
    if (rest.empty()) return;
    if (!binary_ && std::ranges::equal(rest, kLineEnd))
      writer_.add(at, 2, "end", "0D 0A");
    else
      writer_.add(at, rest.size(), "surplus", printable(rest), "characters behind the frame");
  }

  // Returns the offset behind the sum.
  std::size_t sum(std::size_t at, ByteView summed) {
    const ByteView rest = frame_.subspan(at);
    if (rest.size() < 2 || rest[0] == '\r') {
      writer_.remark("without a sum");
      return at;
    }
    const std::string right = digits(sum8(summed), 2), present = printable(rest.first(2));
    writer_.add(at, 2, "sum", present, present == right ? "" : "should be " + right);
    return at + 2;
  }

  const ByteView frame_;
  bool binary_ = false, response_ = false, refused_ = false;
  bool sum_expected_ = false, short_ = false;
  SerialFormat format_;
  FieldWriter writer_;
  Bytes text_;
  std::vector<std::size_t> offsets_;
  std::size_t behind_ = 0, at_ = 0;
};

}  // namespace

std::vector<FrameField> explain_serial(ByteView frame) {
  return SerialExplainer(frame.first(std::min(frame.size(), kMaxExplained))).run();
}

}  // namespace fieldcast::mitsubishi_mc
