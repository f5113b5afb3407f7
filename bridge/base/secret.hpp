// A password, shared secret or key in memory that is locked (not swapped), excluded from core dumps
// and overwritten when released (libsodium). Copies share one immutable text. Any thread.
//
// If the limit of locked memory (RLIMIT_MEMLOCK) is too small, the text is stored anyway but may be
// swapped; secrets_are_locked() returns false then.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace fieldcast {

class Secret {
 public:
  Secret() = default;
  explicit Secret(std::string_view text);
  // Overwrites and empties `text`.
  [[nodiscard]] static Secret taken_from(std::string& text);

  // Valid as long as any copy of this object lives.
  [[nodiscard]] std::string_view text() const { return {text_.get(), size_}; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

 private:
  std::shared_ptr<const char> text_;
  std::size_t size_ = 0;
};

// Compares in a time that depends only on the length.
[[nodiscard]] bool same_bytes(std::string_view a, std::string_view b);

// Overwrites and empties a text that held a secret.
void wipe(std::string& text);

// Returns false if this process may not lock memory, or not enough of it.
[[nodiscard]] bool secrets_are_locked();

}  // namespace fieldcast
