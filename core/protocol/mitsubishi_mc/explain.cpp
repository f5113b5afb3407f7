#include <algorithm>
#include <array>
#include <string>

#include "core/codec/digits.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/mitsubishi_mc/codes.hpp"
#include "core/protocol/mitsubishi_mc/command_names.hpp"
#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/mitsubishi_mc/mitsubishi_mc.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr std::size_t kMaxExplained = 8192;  // characters

std::string hex(std::uint32_t number, unsigned digits) {
  Bytes text;
  append_digits(text, number, digits);
  return {text.begin(), text.end()};
}

class McExplainer {
 public:
  McExplainer(ByteView frame, const Format& format, bool response)
      : frame_(frame), format_(format), response_(response) {}

  std::vector<FrameField> run() {
    writer_.remark(std::string(format_.numbered ? "4E " : "3E ") +
                   (response_ ? "response, " : "request, ") +
                   (format_.ascii ? "ASCII code" : "binary code"));
    at_ = kSubheader * format_.width();
    add_raw(0, at_, "subheader");
    if (format_.numbered) number("serial", 2), number("fixed", 2, 0);
    number("network", 1);
    number("station", 1);
    number("module", 2);
    number("unit", 1);
    length();
    number(response_ ? "end code" : "timer", 2);
    if (response_ && last_ != 0) {
      add_raw(at_, std::min(left(), 5 * format_.width()), "station with the error");
      at_ += std::min(left(), 5 * format_.width());
    }
    if (!response_ || last_ != 0) {
      number("command", 2);
      number("subcommand", 2);
    }
    if (left() > 0) add_raw(at_, left(), response_ ? "data" : "parameters");
    return writer_.take();
  }

 private:
  [[nodiscard]] std::size_t left() const { return frame_.size() - at_; }

  // Digits are shown as text.
  void add_raw(std::size_t at, std::size_t size, const std::string& name) {
    const ByteView part = frame_.subspan(at, size);
    writer_.add(at, size, name, format_.ascii ? printable(part) : to_hex(part));
  }

  void number(const std::string& name, std::size_t bytes, std::uint32_t must = UINT32_MAX) {
    const std::size_t size = bytes * format_.width();
    last_ = 0;
    if (left() < size) {
      if (!short_) writer_.remark("", name + " is missing");
      short_ = true;
      at_ = frame_.size();
      return;
    }
    const auto value = read_number(frame_.subspan(at_), format_, bytes);
    std::string fault;
    if (!value)
      fault = "not hexadecimal digits";
    else if (must != UINT32_MAX && *value != must)
      fault = "must be " + hex(must, static_cast<unsigned>(2 * bytes));
    last_ = value.value_or(0);
    std::string text = hex(last_, static_cast<unsigned>(2 * bytes));
    if (name == "command") {
      if (const auto words = command_name(last_); !words.empty()) text += " " + std::string(words);
    } else if (name == "end code" && last_ != 0) {
      text += " " + std::string(device_code_text(kCodes, static_cast<std::uint16_t>(last_)));
    } else if (name == "timer") {
      text += last_ == 0 ? " no limit" : " = " + std::to_string(last_ * 250) + " ms";
    }
    writer_.add(at_, size, name, text, fault);
    at_ += size;
  }

  void length() {
    const std::size_t size = kLength * format_.width();
    if (left() < size) return number("length", kLength);
    const auto counted = read_number(frame_.subspan(at_), format_, kLength);
    const std::size_t present = left() - size;
    std::string fault;
    if (!counted)
      fault = "not hexadecimal digits";
    else if (*counted != present)
      fault = "should be " + std::to_string(present);
    writer_.add(at_, size, "length", std::to_string(counted.value_or(0)), fault);
    at_ += size;
  }

  const ByteView frame_;
  const Format format_;
  const bool response_;
  FieldWriter writer_;
  std::size_t at_ = 0;
  std::uint32_t last_ = 0;  // the last number
  bool short_ = false;
};

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  if (frame.size() > kMaxExplained) frame = frame.first(kMaxExplained);
  for (const bool ascii : {false, true}) {
    for (const bool numbered : {false, true}) {
      for (const bool response : {false, true}) {
        const Format format{.numbered = numbered, .ascii = ascii};
        Bytes subheader;
        append_number(subheader, format,
                      (numbered ? kRequest4e : kRequest3e) | (response ? kResponse : 0), 1);
        append_number(subheader, format, 0, 1);
        if (frame.size() >= subheader.size() &&
            std::ranges::equal(frame.first(subheader.size()), subheader))
          return McExplainer(frame, format, response).run();
      }
    }
  }
  FieldWriter writer;
  writer.remark(to_hex(frame.first(std::min<std::size_t>(frame.size(), 4))),
                "expected 50 00, 54 00, D0 00 or D4 00, or these digits in ASCII code");
  return writer.take();
}

}  // namespace fieldcast::mitsubishi_mc
