// Bodies in gzip (RFC 1952). No thread of its own; throws std::bad_alloc only.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace fieldcast::web {

// All of it at once, at the fastest level.
[[nodiscard]] std::string packed(std::string_view text);
// REQUIRES: packed, and of our own making.
[[nodiscard]] std::string unpacked(std::string_view gzip);

// Piece by piece, for a streamed body.
class GzipPieces {
 public:
  GzipPieces();
  ~GzipPieces();
  GzipPieces(const GzipPieces&) = delete;
  GzipPieces& operator=(const GzipPieces&) = delete;

  // What is to be sent for this piece; may be empty, since it gathers.
  [[nodiscard]] std::string put(std::string_view text);
  [[nodiscard]] std::string finish();  // the rest; once

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
