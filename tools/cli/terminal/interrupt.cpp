#include "tools/cli/terminal/interrupt.hpp"

#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "tools/cli/terminal/gzip_file.hpp"
#include "tools/cli/terminal/terminal.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {

namespace {

sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
  return set;
}

}  // namespace

Interrupt::Interrupt() {
  const auto set = ending_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { wait_for_signals(); });
}

Interrupt::~Interrupt() {
  ending_ = true;
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

void Interrupt::on_raise(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
  if (raised_ && wake_) wake_();
}

void Interrupt::wait_for_signals() {
  const auto set = ending_signals();
  int signal = 0;
  while (sigwait(&set, &signal) != 0) {}
  if (ending_) return;
  raised_ = true;
  {
    const std::lock_guard lock(mutex_);
    if (wake_) wake_();
  }
  // A command can block in a full output: a second signal or the time limit ends it.
  const timespec limit{kEndLimit.count(), 0};
  while (sigtimedwait(&set, nullptr, &limit) < 0 && errno == EINTR) {}
  if (ending_) return;
  give_terminal_back_now();
  wipe_progress_at_end();
  std::_Exit(to_int(ExitCode::kInterrupted));
}

EndAtOnce::EndAtOnce(Duration grace) : grace_(grace) {
  interrupt_.on_raise([this] { end(); });
}

EndAtOnce::~EndAtOnce() {
  {
    const std::lock_guard lock(whole_);
    ended_ = true;
  }
  changed_.notify_all();
  interrupt_.on_raise({});
}

void EndAtOnce::end() {
  std::unique_lock lock(whole_);
  if (changed_.wait_for(lock, grace_, [this] { return ended_; })) return;
  wipe_progress_at_end();
  GzipFile::remove_unfinished();
  ::_exit(to_int(ExitCode::kInterrupted));
}

}  // namespace fieldcast::cli
