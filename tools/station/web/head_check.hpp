// Checks a request header before the parser. Refuses what a proxy could parse differently
// (RFC 9112, 2.2, 5.1, 5.2, 6.1, 6.3): the body could then smuggle a second request. Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace fieldcast::web {

struct HeadFault {
  unsigned status = 400;
  std::string_view error, hint;
};

class HeadCheck {
 public:
  // `all`: all received bytes of the request. Returns the first fault, which is final.
  [[nodiscard]] std::optional<HeadFault> put(std::string_view all);
  // Size of the header with its empty line; 0 while it is incomplete.
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  [[nodiscard]] std::optional<HeadFault> on_line(std::string_view line);
  [[nodiscard]] std::optional<HeadFault> on_length(std::string_view value);
  [[nodiscard]] std::optional<HeadFault> on_coding(std::string_view value);

  // next_: the next byte; line_: the start of its line
  std::size_t next_ = 0, line_ = 0, size_ = 0;
  bool first_ = true, has_length_ = false, has_coding_ = false, old_ = false;
};

}  // namespace fieldcast::web
