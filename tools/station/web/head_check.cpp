#include "tools/station/web/head_check.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::web {
namespace {

constexpr HeadFault kLineEnd{400, "a line does not end with CR LF", "send HTTP/1.1"};
constexpr HeadFault kControl{400, "a control character in the header", "remove it"};
constexpr HeadFault kFolding{400, "a header line begins with a space",
                             "send each header in one line"};
constexpr HeadFault kName{400, "a header without a valid name",
                          "send NAME: VALUE without a space before the colon"};
constexpr HeadFault kLength{400, "the Content-Length is not a number", "send digits only"};
constexpr HeadFault kTwoLengths{400, "the length of the body is given more than once",
                                "send Content-Length once, or Transfer-Encoding: chunked"};
constexpr HeadFault kOldCoding{400, "Transfer-Encoding needs HTTP/1.1", "send Content-Length"};
constexpr HeadFault kCoding{501, "unknown Transfer-Encoding",
                            "send Content-Length, or Transfer-Encoding: chunked"};

char head_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, head_lower, head_lower);
}

bool is_token_char(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

std::string_view without_spaces(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

std::optional<HeadFault> HeadCheck::put(std::string_view all) {
  for (; size_ == 0 && next_ < all.size(); ++next_) {
    const char c = all[next_];
    const bool after_cr = next_ > line_ && all[next_ - 1] == '\r';
    if (after_cr != (c == '\n')) return kLineEnd;
    if (c == '\n') {
      const std::string_view line = all.substr(line_, next_ - 1 - line_);
      line_ = next_ + 1;
      if (line.empty() && !first_) size_ = line_;
      if (auto fault = size_ > 0 ? std::nullopt : on_line(line)) return fault;
    } else if (c != '\r' && c != '\t' && (static_cast<unsigned char>(c) < ' ' || c == 0x7F)) {
      return kControl;
    }
  }
  return std::nullopt;
}

std::optional<HeadFault> HeadCheck::on_line(std::string_view line) {
  if (std::exchange(first_, false)) {
    old_ = !line.ends_with(" HTTP/1.1");  // the parser checks the rest of the line
    return std::nullopt;
  }
  if (line.front() == ' ' || line.front() == '\t') return kFolding;
  const std::string_view name = line.substr(0, line.find(':'));
  if (name.empty() || name.size() == line.size() || !std::ranges::all_of(name, is_token_char))
    return kName;
  const std::string_view value = without_spaces(line.substr(name.size() + 1));
  if (same_word(name, "content-length")) return on_length(value);
  if (same_word(name, "transfer-encoding")) return on_coding(value);
  return std::nullopt;
}

std::optional<HeadFault> HeadCheck::on_length(std::string_view value) {
  if (std::exchange(has_length_, true) || has_coding_) return kTwoLengths;
  const bool digits = !value.empty() && value.find_first_not_of("0123456789") == value.npos;
  return digits ? std::nullopt : std::optional(kLength);
}

std::optional<HeadFault> HeadCheck::on_coding(std::string_view value) {
  if (std::exchange(has_coding_, true) || has_length_) return kTwoLengths;
  if (old_) return kOldCoding;
  return same_word(value, "chunked") ? std::nullopt : std::optional(kCoding);
}

}  // namespace fieldcast::web
