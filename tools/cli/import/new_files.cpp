#include "tools/cli/import/new_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "bridge/base/errno_text.hpp"
#include "bridge/security/file_access.hpp"
#include "bridge/security/pki.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {
namespace {

std::string beside(const std::string& path) { return path + ".new"; }

// Returns 0 or an errno. Replaces atomically, only with `replace`.
int give_name(const std::string& path, bool replace) {
  const unsigned flags = replace ? 0 : RENAME_NOREPLACE;
  if (::renameat2(AT_FDCWD, beside(path).c_str(), AT_FDCWD, path.c_str(), flags) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // For file systems without RENAME_NOREPLACE: link() fails if the file exists.
  if (!replace && ::link(beside(path).c_str(), path.c_str()) != 0) return errno;
  if (!replace) return ::unlink(beside(path).c_str()) == 0 ? 0 : errno;
  return std::rename(beside(path).c_str(), path.c_str()) == 0 ? 0 : errno;
}

}  // namespace

std::optional<std::string> write_new_files(const std::vector<NewFile>& files, bool replace) {
  const auto refused = [](const std::string& path) {
    return fmt::format("{} is there already; it is not written over (--force does)",
                       printable(path));
  };
  std::error_code ignored;
  for (const NewFile& file : files) {
    if (!replace && std::filesystem::exists(file.path, ignored)) return refused(file.path);
  }
  std::optional<std::string> fault;
  try {
    for (const NewFile& file : files) {
      ::unlink(beside(file.path).c_str());  // left by a killed run
      security::write_new(beside(file.path), file.text, security::kForAll);
    }
  } catch (const security::SecurityError& error) { fault = error.what(); }
  std::size_t named = 0;
  for (; !fault && named < files.size(); ++named) {
    const int error = give_name(files[named].path, replace);
    if (error == 0) continue;
    fault = error == EEXIST ? refused(files[named].path)
                            : fmt::format("cannot write {}: {}", printable(files[named].path),
                                          errno_text(error));
    break;
  }
  if (!fault) return std::nullopt;
  for (std::size_t i = 0; i < files.size(); ++i) {
    ::unlink(beside(files[i].path).c_str());
    if (i < named && !replace) ::unlink(files[i].path.c_str());
  }
  return fault;
}

}  // namespace fieldcast::cli
