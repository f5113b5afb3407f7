// A password, shared secret or key in locked memory (not swapped), excluded from core dumps and
// overwritten when released (libsodium). Copies share one text. Any thread. If RLIMIT_MEMLOCK is
// too small, it may be swapped; secrets_are_locked() returns false then.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

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

// Files with secrets: only the owner, root and, with kOwnerAndGroup, the group may read them.
enum class Readers : std::uint8_t {
  kOwner,          // only the owner: the password of a person
  kOwnerAndGroup,  // also the group: a file of root that a service's group reads
};

inline constexpr std::size_t kMaxSecretFile = 64 * 1024;  // bytes

// Fails with one line with the path if it cannot be read, is not a file, or others may access it.
[[nodiscard]] tl::expected<void, std::string> check_secret_file(const std::string& path,
                                                                Readers readers);
// Reads the whole file under the same rule. Checks and reads through one descriptor, so that the
// file cannot be replaced in between. A pipe is accepted.
[[nodiscard]] tl::expected<Secret, std::string> read_secret_file(const std::string& path,
                                                                 Readers readers);
// Reads the first line, without the line end. Also fails if that line is empty.
[[nodiscard]] tl::expected<Secret, std::string> read_secret_line(const std::string& path,
                                                                 Readers readers);

// Protects the memory of a process that holds secrets. Call once at the start of main().

// Disables core dumps and access to the memory by processes of the same user (PR_SET_DUMPABLE,
// RLIMIT_CORE). Does nothing with FIELDCAST_CORE_DUMPS=1 in the environment, for debugging.
void guard_memory();

// One line for the log about each missing protection; empty if all are active.
[[nodiscard]] std::string unguarded_memory();

}  // namespace fieldcast
