#include "bridge/service/process_watch.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <exception>

#include "bridge/base/write_faults.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/log/log.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/security/authority.hpp"

namespace fieldcast {

namespace {

sigset_t taken_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGUSR1}) sigaddset(&set, signal);
  return set;
}

}  // namespace

int daemon_main(const char* name, const std::function<ExitCode()>& run) {
  make_writes_fail_not_kill();
  guard_memory();
  try {
    return static_cast<int>(run());
  } catch (const std::exception& error) {
    log_error(name, error.what());
    flush_log(kLastWords);
    return static_cast<int>(ExitCode::kInternal);
  }
}

Signals::Signals() {
  const sigset_t set = taken_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { take(); });
  on_removed([this] {
    const std::lock_guard lock(mutex_);
    put(kRemoved);
  });
}

Signals::~Signals() {
  on_removed({});
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

std::shared_ptr<void> Signals::if_stuck(std::function<void()> last_words) {
  const auto set = [this](std::function<void()> words) {
    const std::lock_guard lock(mutex_);
    last_words_ = std::move(words);
  };
  set(std::move(last_words));
  return {nullptr, [set](void*) { set({}); }};
}

int Signals::wait(Duration limit) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, limit, [this] { return !taken_.empty(); })) return 0;
  const int signal = taken_.front();
  taken_.pop_front();
  return signal;
}

void Signals::put(int signal) {
  if (std::find(taken_.begin(), taken_.end(), signal) == taken_.end()) taken_.push_back(signal);
  changed_.notify_all();
}

void Signals::take() {
  pthread_setname_np(pthread_self(), "signals");
  const sigset_t set = taken_signals();
  for (int signal = 0;;) {
    if (sigwait(&set, &signal) != 0) continue;
    std::unique_lock lock(mutex_);
    if (ended_) return;
    put(signal);
    if (signal != SIGTERM && signal != SIGINT) continue;
    ending_ = true;
    if (changed_.wait_for(lock, kEndLimit, [this] { return ended_; })) return;
    if (last_words_) last_words_();
    std::_Exit(static_cast<int>(ExitCode::kHung));
  }
}

bool is_look_due(std::optional<UtcTime> not_after, UtcTime last, UtcTime now) {
  if (now < last || now.nanoseconds - last.nanoseconds >= security::kDay.count()) return true;
  return not_after && last < *not_after && *not_after <= now;
}

void IdentityWatch::joined(const DdsSpec& spec, UtcTime now) {
  folder_ = spec.security;
  not_after_ = folder_ ? security::end_of_member(*folder_) : std::nullopt;
  last_ = now;
}

void IdentityWatch::look(UtcTime now) {
  if (!folder_ || !is_look_due(not_after_, last_, now)) return;
  last_ = now;
  const security::MemberCheck check = security::check_program(*folder_, is_bridge_, now);
  for (const std::string& line : check.faults) log_error("security", line);
  for (const std::string& line : check.warnings) log_warning("security", line);
  if (!not_after_ || now < *not_after_) return;
  log_error("security",
            fmt::format("the certificate with which this program joined ended on {}: nobody who "
                        "joins from then on finds it; {} {}",
                        security::date_text(*not_after_),
                        check.faults.empty() ? "it is renewed, and" : "once it is renewed",
                        is_bridge_ ? "a reload (SIGHUP) takes it up" : "start this program again"));
}

}  // namespace fieldcast
