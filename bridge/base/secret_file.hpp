// Files that hold a secret: passwords, shared secrets, private keys. One rule for all of them: who
// is neither the owner nor root must not read them. Any thread.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"

namespace fieldcast {

// Who may read such a file besides its owner.
enum class Readers : std::uint8_t {
  kOwner,          // nobody: the password of a person
  kOwnerAndGroup,  // its group: a file of root that a service's group reads
};

inline constexpr std::size_t kMaxSecretFile = 64 * 1024;  // bytes

// Nothing, or why the file is not taken, in one line that begins with the path: it cannot be read,
// others may read or change it, it is no file.
[[nodiscard]] tl::expected<void, std::string> check_secret_file(const std::string& path,
                                                                Readers readers);
// The whole file, by the same rule; checked and read by one descriptor, so that nobody changes it
// in between. A pipe counts as a file.
[[nodiscard]] tl::expected<Secret, std::string> read_secret_file(const std::string& path,
                                                                 Readers readers);
// Its first line, without the end of the line. The error also when that line is empty.
[[nodiscard]] tl::expected<Secret, std::string> read_secret_line(const std::string& path,
                                                                 Readers readers);

}  // namespace fieldcast
