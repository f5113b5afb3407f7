// Files that hold a secret: passwords, shared secrets, private keys. Only the owner and root, and
// with kOwnerAndGroup the group, may have permission to read them. Any thread.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/secret.hpp"

namespace fieldcast {

// Who may read the file, in addition to root.
enum class Readers : std::uint8_t {
  kOwner,          // only the owner: the password of a person
  kOwnerAndGroup,  // also the group: a file of root that a service's group reads
};

inline constexpr std::size_t kMaxSecretFile = 64 * 1024;  // bytes

// Fails with one line that begins with the path if the file cannot be read, is not a file, or if
// others may read or change it.
[[nodiscard]] tl::expected<void, std::string> check_secret_file(const std::string& path,
                                                                Readers readers);
// Reads the whole file under the same rule. Checks and reads through one descriptor, so that the
// file cannot be replaced in between. A pipe is accepted.
[[nodiscard]] tl::expected<Secret, std::string> read_secret_file(const std::string& path,
                                                                 Readers readers);
// Reads the first line, without the line end. Also fails if that line is empty.
[[nodiscard]] tl::expected<Secret, std::string> read_secret_line(const std::string& path,
                                                                 Readers readers);

}  // namespace fieldcast
