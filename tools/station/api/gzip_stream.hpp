// Compresses what is sent while it is made (RFC 1952, by zlib). One owner, one thread at a time.
// Throws std::bad_alloc without memory.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace fieldcast::web {

class GzipStream {
 public:
  enum class Flush : unsigned char {
    kNone,  // what zlib gives of its own will
    kEnd,   // all of it: nothing follows
  };

  GzipStream();
  ~GzipStream();
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  // The compressed bytes that this text adds; possibly none.
  [[nodiscard]] std::string add(std::string_view text, Flush flush);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] std::string gzip(std::string_view text);

}  // namespace fieldcast::web
