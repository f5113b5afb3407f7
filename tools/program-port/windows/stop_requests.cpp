#include "tools/program-port/stop_requests.hpp"

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "tools/program-port/windows/stop_requests.hpp"

namespace fieldcast::port {
namespace {

// The system ends the process about 5 s after it has closed the console.
constexpr std::chrono::milliseconds kLastWait{4500};

// Shared with the threads on which the system reports its requests.
std::mutex guard;
std::condition_variable ended;
std::function<void()> notify;  // empty: no session
bool requested = false;
std::atomic<bool> console_ends_session = true;

// The default handler would end the process.
BOOL WINAPI on_control(DWORD what) {
  if (!console_ends_session) return TRUE;
  request_stop();
  if (what == CTRL_C_EVENT || what == CTRL_BREAK_EVENT) return TRUE;
  std::unique_lock lock(guard);
  ended.wait_for(lock, kLastWait, [] { return !notify; });
  return TRUE;
}

}  // namespace

void request_stop() {
  const std::lock_guard lock(guard);
  requested = true;
  if (notify) notify();
}

void ignore_console() { console_ends_session = false; }

struct StopRequests::State {
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work;
  std::function<void()> on_stop;
  bool cancelled = false;
};

StopRequests::StopRequests(boost::asio::io_context& io, std::function<void()> on_stop)
    : state_(std::make_shared<State>(boost::asio::make_work_guard(io), std::move(on_stop))) {
  const std::lock_guard lock(guard);
  notify = [state = state_, &io] {
    boost::asio::post(io, [state] {
      if (!state->cancelled) state->on_stop();
    });
  };
  if (requested) notify();
  ::SetConsoleCtrlHandler(on_control, TRUE);
}

StopRequests::~StopRequests() {
  cancel();
  const std::lock_guard lock(guard);
  notify = nullptr;
  ended.notify_all();
}

void StopRequests::cancel() {
  state_->cancelled = true;
  state_->work.reset();
}

}  // namespace fieldcast::port
