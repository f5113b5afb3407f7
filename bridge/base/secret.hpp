// A password, a shared secret or a key in memory that is not written to swap, is left out of core
// dumps and is overwritten at its end (libsodium). Copies share the one text, which never changes.
// Any thread.
//
// Where the limit of locked memory (RLIMIT_MEMLOCK) is too small the text is kept all the same, but
// may be written to swap; secrets_are_locked() tells.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace fieldcast {

class Secret {
 public:
  Secret() = default;
  explicit Secret(std::string_view text);
  // Leaves nothing of it in `text`.
  [[nodiscard]] static Secret taken_from(std::string& text);

  // Valid as long as a copy of this lives.
  [[nodiscard]] std::string_view text() const { return {text_.get(), size_}; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

 private:
  std::shared_ptr<const char> text_;
  std::size_t size_ = 0;
};

// In a time that depends on the length alone.
[[nodiscard]] bool same_bytes(std::string_view a, std::string_view b);

// Overwrites a text that held a secret, and empties it.
void wipe(std::string& text);

// False: this process may not lock memory, or not enough of it.
[[nodiscard]] bool secrets_are_locked();

}  // namespace fieldcast
