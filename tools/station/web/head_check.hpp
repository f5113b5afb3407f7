// Checks the header of a request byte by byte before a parser reads it, and refuses what a proxy in
// front of the station could read differently (RFC 9112, 2.2, 5.1, 5.2, 6.1, 6.3): another length
// of the same request would hide a second request in its body. Pure.
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
  // `all`: every byte of the request so far. The fault is final; empty if there is none yet.
  [[nodiscard]] std::optional<HeadFault> put(std::string_view all);
  // Bytes of the header with its empty line; 0 while it is incomplete.
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  [[nodiscard]] std::optional<HeadFault> on_line(std::string_view line);
  [[nodiscard]] std::optional<HeadFault> on_length(std::string_view value);
  [[nodiscard]] std::optional<HeadFault> on_coding(std::string_view value);

  std::size_t next_ = 0, line_ = 0, size_ = 0;  // the next byte; where its line begins
  bool first_ = true, has_length_ = false, has_coding_ = false, old_ = false;
};

}  // namespace fieldcast::web
