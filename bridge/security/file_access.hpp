// Whole files, read and written for keys and what belongs to them. Throw SecurityError with the
// path. Any thread.
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

namespace fieldcast::security {

inline constexpr mode_t kOwnerOnly = 0600;
inline constexpr mode_t kForAll = 0644;

[[nodiscard]] std::string read_file(const std::string& path);
// The same for a private key. Fails if others than its owner may read or change it.
[[nodiscard]] std::string read_key(const std::string& path);
// Whole or not at all, also on a full disk. Fails if it is there.
void write_new(const std::string& path, const std::string& text, mode_t mode);
// The same in the place of one that may be there: who reads it meanwhile gets the old one or the
// new one.
void replace(const std::string& path, const std::string& text, mode_t mode);

struct NewText {
  std::string path, text;
  mode_t mode = kForAll;
};
// Several of them. None is replaced before all are written.
void replace_all(const std::vector<NewText>& files);
// For the owner only. Fails if it is there.
void make_folder(const std::string& path);
// A file or a folder gets another name, which nothing has.
void move_new(const std::string& from, const std::string& to);

// What is wrong when others than its owner may change a file or a folder, for people, with the
// remedy; empty: they may not, or there is none.
[[nodiscard]] std::string open_to_change(const std::string& path);

// Names that files have until they are whole.
inline constexpr std::string_view kUnfinished = ".new";

}  // namespace fieldcast::security
