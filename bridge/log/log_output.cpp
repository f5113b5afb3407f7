#include "bridge/log/log_output.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <thread>
#include <utility>

namespace fieldcast {
namespace {

constexpr int kPollMilliseconds = 100;

}  // namespace

int duplicate_output(int fd) { return ::fcntl(fd, F_DUPFD_CLOEXEC, 0); }

std::optional<std::size_t> write_output(int fd, std::string_view text) {
  if (fd < 0) return std::nullopt;
  pollfd writable{fd, POLLOUT, 0};
  if (::poll(&writable, 1, kPollMilliseconds) <= 0) return 0;
  const ssize_t size = ::write(fd, text.data(), std::min(text.size(), kOutputPiece));
  if (size >= 0) return static_cast<std::size_t>(size);
  if (errno == EINTR || errno == EAGAIN) return 0;
  return std::nullopt;
}

void start_output_thread(std::function<void()> run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  std::thread([run = std::move(run)] {
    pthread_setname_np(pthread_self(), "log");
    run();
  }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace fieldcast
