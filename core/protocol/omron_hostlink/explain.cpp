#include <algorithm>
#include <string>
#include <utility>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/omron_hostlink/explain_fins.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"
#include "core/protocol/omron_hostlink/omron_hostlink.hpp"

namespace fieldcast::omron {
namespace {

constexpr std::size_t kMaxExplained = 4096;
constexpr std::size_t kMaxCMode = 131;

using Named = std::pair<std::string_view, std::string_view>;
constexpr Named kHeaders[] = {{"RR", "read CIO"},
                              {"RL", "read LR"},
                              {"RH", "read HR"},
                              {"RJ", "read AR"},
                              {"RD", "read DM"},
                              {"RE", "read EM"},
                              {"RC", "read timer/counter present values"},
                              {"RG", "read timer/counter flags"},
                              {"WR", "write CIO"},
                              {"WL", "write LR"},
                              {"WH", "write HR"},
                              {"WJ", "write AR"},
                              {"WD", "write DM"},
                              {"WE", "write EM"},
                              {"WC", "write timer/counter present values"},
                              {"WG", "write timer/counter flags"},
                              {"R#", "read a set value by its timer or counter"},
                              {"R$", "read a set value"},
                              {"R%", "read a set value, with its operand"},
                              {"W#", "change a set value by its timer or counter"},
                              {"W$", "change a set value"},
                              {"W%", "change a set value, with its operand"},
                              {"RP", "program read"},
                              {"WP", "program write"},
                              {"MI", "make the I/O table"},
                              {"MS", "status read"},
                              {"SC", "set mode"},
                              {"MM", "model read"},
                              {"TS", "echo test"},
                              {"KS", "force set"},
                              {"KR", "force reset"},
                              {"KC", "cancel forced bits"},
                              {"MF", "error read"},
                              {"QQ", "register areas and read them"},
                              {"XZ", "abort"},
                              {"IC", "undefined command"},
                              {"FA", "FINS"}};

class HostLinkExplainer {
 public:
  explicit HostLinkExplainer(ByteView frame) : frame_(frame) {}

  std::vector<FrameField> run() {
    if (std::ranges::equal(frame_, std::string_view("@**\r"))) {
      writer_.remark("INITIALIZE: every unit cancels unfinished transfers; no response");
      return writer_.take();
    }
    if (frame_.size() == 1 && frame_[0] == kCr) {
      writer_.remark("delimiter: go on with the next frame");
      return writer_.take();
    }
    const auto at = std::ranges::find(frame_, kAt);
    if (at != frame_.begin() && at != frame_.end()) {
      start_ = static_cast<std::size_t>(at - frame_.begin());
      writer_.add(0, start_, "ignored", printable(frame_.first(start_)));
    }
    marked_ = at != frame_.end();
    body();
    return writer_.take();
  }

 private:
  void body() {
    const ByteView own = frame_.subspan(start_);
    const auto cr = std::ranges::find(own, kCr);
    auto end = static_cast<std::size_t>(cr - own.begin());  // later of the FCS
    const bool ended = cr != own.end();
    const bool last = end > 0 && own[end - 1] == kStar;
    if (last) --end;
    if (end < kFcsSize + (marked_ ? kHeadSize : 1))
      return writer_.remark(printable(own), "too short for a frame");
    const ByteView text = own.first(end - kFcsSize);
    if (marked_)
      head(text);
    else
      add(0, text.size(), "data", "of a later frame: " + printable(text), digits_fault(text));
    const ByteView fcs = own.subspan(end - kFcsSize, kFcsSize);
    Bytes right;
    append_digits(right, xor8(text), 2);
    add(end - kFcsSize, kFcsSize, "FCS", printable(fcs),
        std::ranges::equal(fcs, right)
            ? ""
            : "FCS is " + printable(fcs) + ", should be " + printable(right));
    add(end, own.size() - end, "end", last ? "the last frame" : "more frames follow",
        ended ? "" : "CR is missing");
    const auto size = static_cast<std::size_t>(cr - own.begin()) + 1;
    if (marked_ && size > kMaxCMode && !is_fins_)
      writer_.remark(std::to_string(size) + " characters", "longer than 131 characters");
    if (ended && size < own.size())
      writer_.remark("", std::to_string(own.size() - size) + " characters behind the frame");
  }

  void add(std::size_t at, std::size_t length, const std::string& name, const std::string& value,
           const std::string& fault = {}) {
    writer_.add(start_ + at, length, name, value, fault);
  }

  static std::string digits_fault(ByteView characters) {
    for (const std::uint8_t c : characters) {
      if (hex_digit(c) < 0) return "not upper-case hexadecimal digits";
    }
    return {};
  }

  void head(ByteView text) {
    const ByteView unit = text.subspan(1, 2);
    const auto number = read_digits(unit, 10);
    add(1, 2, "unit", printable(unit), number && *number <= 31 ? "" : "must be 00..31 in decimal");
    const std::string header(text.begin() + 3, text.begin() + kHeadSize);
    const auto row = std::ranges::find(kHeaders, header, &Named::first);
    add(3, 2, "header", header + (row != std::end(kHeaders) ? " " + std::string(row->second) : ""),
        row != std::end(kHeaders) ? "" : "no command");
    const ByteView rest = text.subspan(kHeadSize);
    is_fins_ = header == "FA";
    const bool of_area = std::string_view("RLHJDECG").find(header[1]) != std::string_view::npos;
    if (is_fins_)
      fins(rest);
    else if (header[0] == 'R' && of_area)
      read(rest, header[1]);
    else if (header[0] == 'W' && of_area)
      write(rest, header[1]);
    else if (!rest.empty())
      add(kHeadSize, rest.size(), "text", printable(rest));
  }

  void end_code(ByteView rest) {
    const ByteView digits = rest.first(std::min<std::size_t>(2, rest.size()));
    const auto code = read_digits(digits);
    const std::string_view text =
        code ? end_code_text(static_cast<std::uint16_t>(*code)) : std::string_view{};
    const bool known = rest.size() >= 2 && code && text != "unknown end code";
    add(kHeadSize, digits.size(), "end code",
        printable(digits) + (code ? " " : "") + std::string(text), known ? "" : "no end code");
  }

  // A request has eight decimal digits (ten for EM); a response has an end code, then words or
  // flags. Eight digits that begin with an end code could be a response with six digits, which only
  // occurs with flags.
  void read(ByteView rest, char letter) {
    const std::size_t address_size = letter == 'E' ? 6 : 4;
    const bool flags = letter == 'G';
    const bool request = rest.size() == address_size + 4;
    if (!request && rest.size() >= 2 && (flags || (rest.size() - 2) % 4 == 0)) {
      writer_.remark("response");
      end_code(rest);
      return data(rest.subspan(2), kHeadSize + 2, flags);
    }
    writer_.remark("request", request ? "" : "the length of neither a request nor a response");
    if (!request) return add(kHeadSize, rest.size(), "text", printable(rest));
    if (letter == 'E') add(kHeadSize, 2, "bank", printable(rest.first(2)));
    decimal(rest.subspan(address_size - 4, 4), kHeadSize + address_size - 4, "first");
    decimal(rest.subspan(address_size, 4), kHeadSize + address_size, "count");
  }

  void decimal(ByteView digits, std::size_t at, const char* name) {
    add(at, digits.size(), name, printable(digits), read_digits(digits, 10) ? "" : "not decimal");
  }

  void write(ByteView rest, char letter) {
    if (rest.size() == 2) {
      writer_.remark("response");
      return end_code(rest);
    }
    const std::size_t address_size = letter == 'E' ? 6 : 4;
    writer_.remark("request");
    if (rest.size() <= address_size)
      return add(kHeadSize, rest.size(), "text", printable(rest), "too short");
    if (letter == 'E') add(kHeadSize, 2, "bank", printable(rest.first(2)));
    decimal(rest.subspan(address_size - 4, 4), kHeadSize + address_size - 4, "first");
    data(rest.subspan(address_size), kHeadSize + address_size, letter == 'G');
  }

  void data(ByteView digits, std::size_t at, bool flags) {
    if (digits.empty()) return;
    std::string words;
    for (std::size_t i = 0; i < digits.size(); i += flags ? 1 : 4) {
      words +=
          (words.empty() ? "" : " ") +
          printable(digits.subspan(i, std::min<std::size_t>(flags ? 1 : 4, digits.size() - i)));
    }
    std::string fault = digits_fault(digits);
    if (fault.empty() && !flags && digits.size() % 4 != 0) fault = "words have four digits each";
    add(at, digits.size(), flags ? "flags" : "words", words, fault);
  }

  // The ICF of a response has bit 6 and follows two digits; that of a request follows one digit.
  void fins(ByteView rest) {
    const bool request = rest.size() % 2 == 1;
    writer_.remark(request ? "request" : "response");
    if (rest.empty()) return writer_.remark("", "nothing behind FA");
    if (request)
      add(kHeadSize, 1, "wait", printable(rest.first(1)) + " * 10 ms", digits_fault(rest.first(1)));
    else
      end_code(rest);
    const std::size_t skip = request ? 1 : 2;
    const auto bytes = read_hex_bytes(rest.subspan(skip));
    if (!bytes)
      return add(kHeadSize + skip, rest.size() - skip, "message", printable(rest.subspan(skip)),
                 "not upper-case hexadecimal digits");
    if (bytes->empty()) {
      if (request) writer_.remark("", "the FINS message is missing");
      return;
    }
    FieldWriter inner(start_ + kHeadSize + skip, 2, 1);
    explain_fins(*bytes, request, inner);
    writer_.append(inner.take());
  }

  const ByteView frame_;
  FieldWriter writer_;
  std::size_t start_ = 0;
  bool marked_ = false;
  bool is_fins_ = false;
};

}  // namespace

std::vector<FrameField> explain_hostlink(ByteView frame) {
  return HostLinkExplainer(frame.first(std::min(frame.size(), kMaxExplained))).run();
}

}  // namespace fieldcast::omron
