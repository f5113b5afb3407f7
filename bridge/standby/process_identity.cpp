#include "bridge/standby/process_identity.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

namespace fieldcast {
namespace {

std::string boot() {
  std::string id;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), id);
  return id;
}

std::string pid_namespace() {
  std::error_code ignored;
  // For example "pid:[402653]".
  return std::filesystem::read_symlink("/proc/self/ns/pid", ignored).string();
}

// Returns the start time of a process in ticks after boot. `std::nullopt` if the process is not
// visible, empty if it has ended but was not reaped. proc(5), /proc/pid/stat: "pid (name) state ..
// starttime"; the name may contain any character.
std::optional<std::string> start_of(const std::string& pid) {
  constexpr int kState = 3, kStartTime = 22;
  std::string line, field, state;
  std::getline(std::ifstream(fmt::format("/proc/{}/stat", pid)), line);
  const auto name_end = line.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(name_end + 1));
  for (int number = kState; number <= kStartTime && fields >> field; ++number) {
    if (number == kState) state = field;
  }
  return state == "Z" || state == "X" ? std::string{} : field;
}

}  // namespace

std::string own_process_identity() {
  const std::string pid = std::to_string(::getpid());
  return fmt::format("{}/{}/{}/{}", boot(), pid_namespace(), pid, start_of(pid).value_or(""));
}

namespace {

struct Process {
  std::string pid, start;
};

// Returns `std::nullopt` for a process on another kernel or in another namespace.
std::optional<Process> process_of(const std::string& identity) {
  const std::string here = fmt::format("{}/{}/", boot(), pid_namespace());
  if (!identity.starts_with(here)) return std::nullopt;
  const std::string process = identity.substr(here.size());
  const auto slash = process.find('/');
  if (slash == 0 || slash == std::string::npos || process.find_first_not_of("0123456789") != slash)
    return std::nullopt;
  return Process{process.substr(0, slash), process.substr(slash + 1)};
}

pid_t number_of(const Process& process) {
  return static_cast<pid_t>(std::strtol(process.pid.c_str(), nullptr, 10));
}

}  // namespace

bool has_ended(const std::string& identity) {
  const auto process = process_of(identity);
  if (!process) return false;
  if (const auto start = start_of(process->pid)) return *start != process->start;
  // /proc may hide the processes of other users.
  return ::kill(number_of(*process), 0) != 0 && errno == ESRCH;
}

FileDescriptor open_process(const std::string& identity) {
  const auto process = process_of(identity);
  if (!process) return {};
  FileDescriptor handle(static_cast<int>(::syscall(SYS_pidfd_open, number_of(*process), 0)));
  // The number may have been reused for another process.
  if (const auto start = start_of(process->pid); start && *start != process->start) return {};
  return handle;
}

std::string own_host_name() {
  std::array<char, 65> name{};
  (void)::gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace fieldcast
