// Whole files, read and written for keys and what belongs to them. Throw SecurityError with the
// path. Any thread.
#pragma once

#include <sys/types.h>

#include <string>

namespace fieldcast::security {

inline constexpr mode_t kOwnerOnly = 0600;
inline constexpr mode_t kForAll = 0644;

[[nodiscard]] std::string read_file(const std::string& path);
// The same for a private key. Fails if others than its owner may read or change it.
[[nodiscard]] std::string read_key(const std::string& path);
// Fails if it is there.
void write_new(const std::string& path, const std::string& text, mode_t mode);
// In one step: who reads it meanwhile gets the old one or the new one.
void replace(const std::string& path, const std::string& text, mode_t mode);
// For the owner only. Fails if it is there.
void make_folder(const std::string& path);

}  // namespace fieldcast::security
