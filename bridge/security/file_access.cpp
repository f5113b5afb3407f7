#include "bridge/security/file_access.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace fieldcast::security {

bool FileError::is_full() const { return code_ == ENOSPC || code_ == EDQUOT || code_ == EFBIG; }

namespace {

[[noreturn]] void fail(const std::string& what, const std::string& path) {
  const int code = errno;
  throw FileError("cannot " + what + ' ' + path + ": " + std::strerror(code), code);
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return number_; }

 private:
  int number_;
};

void fill(int file, const std::string& path, const std::string& text, mode_t mode) {
  const Descriptor owned(file);
  // Independent of the umask.
  if (::fchmod(file, mode) != 0) fail("set the mode of", path);
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(file, text.data() + done, text.size() - done);
    if (written < 0) fail("write", path);
    done += static_cast<std::size_t>(written);
  }
  if (::fsync(file) != 0) fail("write", path);
}

}  // namespace

namespace {

std::string whole(int file, const std::string& path, std::size_t most_bytes) {
  std::string text;
  char part[4096];
  for (;;) {
    const ssize_t got = ::read(file, part, sizeof part);
    if (got < 0) fail("read", path);
    if (got == 0) return text;
    text.append(part, static_cast<std::size_t>(got));
    if (text.size() > most_bytes) throw SecurityError("cannot read " + path + ": it is too long");
  }
}

}  // namespace

std::string read_file(const std::string& path, std::size_t most_bytes) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail("read", path);
  const Descriptor owned(file);
  return whole(file, path, most_bytes);
}

std::string read_key(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail("read", path);
  const Descriptor owned(file);
  struct stat found {};
  if (::fstat(file, &found) != 0) fail("read", path);
  if ((found.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    throw SecurityError(path + ": others may read or change it; chmod 600 " + path);
  return whole(file, path, kMostFileBytes);
}

namespace {

std::string beside(const std::string& path) { return path + std::string(kUnfinished); }

// Leaves no file behind on failure.
void write_beside(const std::string& path, const std::string& text, mode_t mode) {
  const std::string name = beside(path);
  ::unlink(name.c_str());  // left by an interrupted run
  const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly);
  if (file < 0) fail("make", path);
  try {
    fill(file, path, text, mode);
  } catch (const SecurityError&) {
    ::unlink(name.c_str());
    throw;
  }
}

// A new name in a folder is on disk only after the folder is synchronized.
void sync_folder_of(const std::string& path) {
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  const int file = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  const Descriptor owned(file);
  (void)::fsync(file);
}

bool is_there(const std::string& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0;
}

}  // namespace

void move_new(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) != 0) {
    if (errno != EINVAL && errno != ENOSYS) fail("make", to);
    // The file system does not support RENAME_NOREPLACE.
    errno = EEXIST;
    if (is_there(to) || std::rename(from.c_str(), to.c_str()) != 0) fail("make", to);
  }
  sync_folder_of(to);
}

void write_new(const std::string& path, const std::string& text, mode_t mode) {
  write_beside(path, text, mode);
  try {
    move_new(beside(path), path);
  } catch (const SecurityError&) {
    ::unlink(beside(path).c_str());
    throw;
  }
}

void replace(const std::string& path, const std::string& text, mode_t mode) {
  replace_all({{path, text, mode}});
}

void replace_by_link(const std::string& path, const std::string& source, mode_t mode) {
  const std::string name = beside(path);
  ::unlink(name.c_str());  // left by an interrupted run
  if (::link(source.c_str(), name.c_str()) != 0) fail("make", path);
  if (::chmod(name.c_str(), mode) != 0 || std::rename(name.c_str(), path.c_str()) != 0) {
    const int code = errno;
    ::unlink(name.c_str());
    errno = code;
    fail("replace", path);
  }
  sync_folder_of(path);
}

void replace_all(const std::vector<NewText>& files) {
  const auto forget = [&files] {
    for (const NewText& file : files) ::unlink(beside(file.path).c_str());
  };
  try {
    for (const NewText& file : files) write_beside(file.path, file.text, file.mode);
    for (const NewText& file : files) {
      if (std::rename(beside(file.path).c_str(), file.path.c_str()) != 0)
        fail("replace", file.path);
    }
  } catch (const SecurityError&) {
    forget();
    throw;
  }
  for (const NewText& file : files) sync_folder_of(file.path);
}

std::string open_to_change(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0 || (found.st_mode & (S_IWGRP | S_IWOTH)) == 0) return {};
  return path + ": others may change it; chmod go-w " + path;
}

void make_folder(const std::string& path) {
  if (::mkdir(path.c_str(), 0700) != 0) fail("make the folder", path);
}

}  // namespace fieldcast::security
