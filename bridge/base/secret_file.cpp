#include "bridge/base/secret_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "bridge/base/errno_text.hpp"
#include "bridge/base/file_descriptor.hpp"

namespace fieldcast {
namespace {

tl::unexpected<std::string> fault(const std::string& path, std::string_view what) {
  return tl::unexpected(fmt::format("{}: {}", path, what));
}

tl::expected<FileDescriptor, std::string> opened(const std::string& path, Readers readers) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (!file.valid()) return fault(path, fmt::format("cannot be read: {}", errno_text(errno)));
  struct stat found {};
  if (::fstat(file.get(), &found) != 0) return fault(path, errno_text(errno));
  if (!S_ISREG(found.st_mode) && !S_ISFIFO(found.st_mode)) return fault(path, "this is no file");
  const mode_t others = readers == Readers::kOwner ? S_IRWXG | S_IRWXO : S_IWGRP | S_IRWXO;
  if ((found.st_mode & others) != 0)
    return fault(path, fmt::format("others may read or change it; chmod 600 {}", path));
  const uid_t self = ::geteuid();
  if (self != 0 && found.st_uid != self && found.st_uid != 0)
    return fault(path, "it belongs to another user, who can read and change it");
  return file;
}

}  // namespace

tl::expected<void, std::string> check_secret_file(const std::string& path, Readers readers) {
  return opened(path, readers).map([](const FileDescriptor&) {});
}

tl::expected<Secret, std::string> read_secret_file(const std::string& path, Readers readers) {
  const auto file = opened(path, readers);
  if (!file) return tl::unexpected(file.error());
  std::string text;
  text.reserve(kMaxSecretFile + 1);  // no reallocation, which would leave a copy behind
  std::array<char, 1024> part;
  ssize_t size = 0;
  while ((size = ::read(file->get(), part.data(), part.size())) > 0 &&
         text.size() <= kMaxSecretFile) {
    text.append(part.data(),
                std::min(static_cast<std::size_t>(size), text.capacity() - text.size()));
  }
  const int error = errno;
  const bool too_long = text.size() > kMaxSecretFile;
  Secret secret = Secret::taken_from(text);
  ::explicit_bzero(part.data(), part.size());
  if (size < 0) return fault(path, fmt::format("cannot be read: {}", errno_text(error)));
  if (too_long) return fault(path, "it is too long for a secret");
  return secret;
}

tl::expected<Secret, std::string> read_secret_line(const std::string& path, Readers readers) {
  const auto whole = read_secret_file(path, readers);
  if (!whole) return tl::unexpected(whole.error());
  std::string_view line = whole->text();
  line = line.substr(0, line.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.empty()) return fault(path, "its first line is empty");
  return Secret(line);
}

}  // namespace fieldcast
