#include "bridge/port/port_lock.hpp"

#include <fmt/format.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "bridge/base/errno_text.hpp"

namespace fieldcast {
namespace {

namespace fs = std::filesystem;

// The kernel stores the first 15 bytes of a program's name (proc(5), /proc/pid/comm). The command
// line has the complete name, unless the program has changed it.
std::string name_of_process(long pid) {
  constexpr std::size_t kKept = 15;
  std::string name, command;
  std::getline(std::ifstream(fmt::format("/proc/{}/comm", pid)), name);
  if (name.size() < kKept) return name;
  std::getline(std::ifstream(fmt::format("/proc/{}/cmdline", pid)), command, '\0');
  const std::string whole = fs::path(command).filename();
  return whole.compare(0, kKept, name) == 0 ? whole : name;
}

std::string describe_process(long pid) {
  const std::string name = name_of_process(pid);
  return name.empty() ? fmt::format("process {}", pid) : fmt::format("{} (process {})", name, pid);
}

// Returns the process that holds a flock on this file: "1: FLOCK  ADVISORY  WRITE 1234 08:01:5678 0
// EOF" (proc(5), /proc/locks).
std::optional<long> lock_holder(const struct stat& file) {
  const std::string wanted =
      fmt::format("{:02x}:{:02x}:{}", major(file.st_dev), minor(file.st_dev), file.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream fields(line);
    std::string number, kind, advisory, access, identity;
    long pid = 0;
    if (fields >> number >> kind >> advisory >> access >> pid >> identity && kind == "FLOCK" &&
        identity == wanted && pid > 0)
      return pid;
  }
  return std::nullopt;
}

std::optional<long> opener(const fs::path& file) {
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    const std::string name = process.path().filename();
    long pid = 0;
    const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (fault != std::errc{} || end != name.data() + name.size() || pid == ::getpid()) continue;
    for (fs::directory_iterator fd(process.path() / "fd", ignored), last; !ignored && fd != last;
         fd.increment(ignored)) {
      if (fs::read_symlink(fd->path(), ignored) == file) return pid;
    }
    ignored.clear();
  }
  return std::nullopt;
}

}  // namespace

std::string port_user(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return {};
  if (const auto pid = lock_holder(file)) return describe_process(*pid);
  std::error_code fault;
  const fs::path real = fs::canonical(path, fault);
  if (fault) return {};
  const auto pid = opener(real);
  return pid ? describe_process(*pid) : std::string{};
}

std::optional<std::string> lock_port(int fd, const std::string& path) {
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return fmt::format("cannot lock: {}", errno_text(errno));
    const std::string user = port_user(path);
    return user.empty() ? "in use by another program" : "in use by " + user;
  }
  // Also excludes programs that do not use flock. Works on pseudo-terminals too; root ignores it.
  ::ioctl(fd, TIOCEXCL);
  return std::nullopt;
}

}  // namespace fieldcast
