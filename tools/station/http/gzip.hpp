// Gzip (RFC 1952) for bodies. Throws only std::bad_alloc.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace fieldcast::web {

[[nodiscard]] std::string packed(std::string_view text);
// REQUIRES: the bytes are output of packed().
[[nodiscard]] std::string unpacked(std::string_view gzip);

class GzipPieces {
 public:
  GzipPieces();
  ~GzipPieces();
  GzipPieces(const GzipPieces&) = delete;
  GzipPieces& operator=(const GzipPieces&) = delete;

  // Returns the bytes to send for this piece; may be empty, because zlib buffers.
  [[nodiscard]] std::string put(std::string_view text);
  [[nodiscard]] std::string finish();  // returns the rest; call once

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
