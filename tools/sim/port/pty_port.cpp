#include "tools/sim/port/pty_port.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <termios.h>

#include <cerrno>
#include <climits>
#include <cstddef>
#include <cstring>
#include <filesystem>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {
namespace {

// Another spelling of /dev/pts, which marks links created by this program.
constexpr const char* kOurs = "/dev/pts/../pts/";

std::string reason(const std::string& path, const char* what) {
  return fmt::format("{}: {} ({})", path, what, errno_text(errno));
}

std::string target_of(const std::string& path) {
  char target[PATH_MAX];
  const ssize_t length = ::readlink(path.c_str(), target, sizeof target);
  return length > 0 ? std::string(target, static_cast<std::size_t>(length)) : std::string{};
}

// Bound while the program serves the path.
FileDescriptor take_lock(const std::string& path) {
  FileDescriptor lock(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::error_code ignored;
  const std::string name =
      fmt::format("fieldcast-pty-{}",
                  std::hash<std::string>{}(std::filesystem::absolute(path, ignored).string()));
  std::memcpy(address.sun_path + 1, name.data(), name.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (!lock || ::bind(lock.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0)
    return FileDescriptor{};
  return lock;
}

bool make_raw(int fd) {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  return ::tcsetattr(fd, TCSANOW, &settings) == 0;
}

}  // namespace

tl::expected<PtyPort, std::string> PtyPort::open(const std::string& path) {
  PtyPort port;
  port.lock_ = take_lock(path);
  if (!port.lock_) return tl::unexpected(path + ": another program of Fieldcast serves this path");
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    if (!S_ISLNK(status.st_mode) || target_of(path).rfind(kOurs, 0) != 0) {
      return tl::unexpected(
          path +
          ": exists already and was not made by Fieldcast; choose another path, or remove it");
    }
    if (::unlink(path.c_str()) != 0)
      return tl::unexpected(reason(path, "cannot remove the link of an earlier program"));
  }
  port.master_.reset(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  char name[64];
  if (!port.master_ || ::grantpt(port.master_.get()) != 0 || ::unlockpt(port.master_.get()) != 0 ||
      ::ptsname_r(port.master_.get(), name, sizeof name) != 0) {
    return tl::unexpected(reason(path, "no pseudo-terminal"));
  }
  port.terminal_ = name;
  port.slave_.reset(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!port.slave_ || !make_raw(port.slave_.get()))
    return tl::unexpected(reason(path, "the pseudo-terminal does not open"));
  const std::string target = kOurs + port.terminal_.substr(std::strlen("/dev/pts/"));
  if (::symlink(target.c_str(), path.c_str()) != 0) {
    return tl::unexpected(reason(path, errno == ENOENT
                                           ? "cannot make the link: its folder is missing"
                                           : "cannot make the link"));
  }
  port.path_ = path;
  return port;
}

PtyPort::~PtyPort() {
  if (!master_ || path_.empty()) return;
  if (target_of(path_) == kOurs + terminal_.substr(std::strlen("/dev/pts/")))
    ::unlink(path_.c_str());
}

void PtyPort::forget_exclusive_use() { ::ioctl(slave_.get(), TIOCNXCL); }

}  // namespace fieldcast::sim
