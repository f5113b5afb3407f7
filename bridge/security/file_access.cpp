#include "bridge/security/file_access.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "bridge/security/pki.hpp"

namespace fieldcast::security {
namespace {

constexpr std::size_t kMaxFile = 1 << 20;

[[noreturn]] void fail(const std::string& what, const std::string& path) {
  throw SecurityError("cannot " + what + ' ' + path + ": " + std::strerror(errno));
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
  // Whatever the umask is.
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

std::string whole(int file, const std::string& path) {
  std::string text;
  char part[4096];
  for (;;) {
    const ssize_t got = ::read(file, part, sizeof part);
    if (got < 0) fail("read", path);
    if (got == 0) return text;
    text.append(part, static_cast<std::size_t>(got));
    if (text.size() > kMaxFile) throw SecurityError("cannot read " + path + ": it is too long");
  }
}

}  // namespace

std::string read_file(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail("read", path);
  const Descriptor owned(file);
  return whole(file, path);
}

std::string read_key(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail("read", path);
  const Descriptor owned(file);
  struct stat found {};
  if (::fstat(file, &found) != 0) fail("read", path);
  if ((found.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    throw SecurityError(path + ": others may read or change it; chmod 600 " + path);
  return whole(file, path);
}

void write_new(const std::string& path, const std::string& text, mode_t mode) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly);
  if (file < 0) fail("make", path);
  fill(file, path, text, mode);
}

void replace(const std::string& path, const std::string& text, mode_t mode) {
  const std::string beside = path + ".new";
  ::unlink(beside.c_str());  // of a run that was interrupted
  write_new(beside, text, mode);
  if (std::rename(beside.c_str(), path.c_str()) != 0) fail("replace", path);
}

void make_folder(const std::string& path) {
  if (::mkdir(path.c_str(), 0700) != 0) fail("make the folder", path);
}

}  // namespace fieldcast::security
