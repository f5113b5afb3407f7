// Reads and writes complete key files. Throws SecurityError with the path; FileError if a call of
// the system failed. Any thread.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/security/pki.hpp"

namespace fieldcast::security {

class FileError : public SecurityError {
 public:
  FileError(const std::string& text, int code) : SecurityError(text), code_(code) {}
  [[nodiscard]] int code() const { return code_; }  // errno
  // No space, no quota left, or a limit of the size of a file.
  [[nodiscard]] bool is_full() const;

 private:
  int code_;
};

inline constexpr mode_t kOwnerOnly = 0600;
inline constexpr mode_t kForAll = 0644;

inline constexpr std::size_t kMostFileBytes = 1 << 20;  // of a key, a certificate, a list
// Fails if the file is longer than `most_bytes`.
[[nodiscard]] std::string read_file(const std::string& path,
                                    std::size_t most_bytes = kMostFileBytes);
// As read_file(), for a private key. Fails if other users may read or change it.
[[nodiscard]] std::string read_key(const std::string& path);
// Writes the complete file or nothing, also on a full disk. Fails if the file exists.
void write_new(const std::string& path, const std::string& text, mode_t mode);
// The same, but replaces an existing file: a concurrent reader gets the old or the new contents.
void replace(const std::string& path, const std::string& text, mode_t mode);

// The same with the content of `source`, which becomes a second name of that file: no block of data
// is written, so that it works on a full disk. A later change of one within its file changes both.
void replace_by_link(const std::string& path, const std::string& source, mode_t mode);

struct NewText {
  std::string path, text;
  mode_t mode = kForAll;
};
// Replaces several files; none is replaced before all are written.
void replace_all(const std::vector<NewText>& files);
// Only the owner has access. Fails if it exists.
void make_folder(const std::string& path);
// Renames a file or a folder. Fails if the new name exists.
void move_new(const std::string& from, const std::string& to);

// A fault with the remedy if other users may change the file or folder; empty otherwise.
[[nodiscard]] std::string open_to_change(const std::string& path);

// Suffix of the name of an incomplete file.
inline constexpr std::string_view kUnfinished = ".new";

}  // namespace fieldcast::security
