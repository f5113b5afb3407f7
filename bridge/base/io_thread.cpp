#include "bridge/base/io_thread.hpp"

#include <pthread.h>
#include <sys/prctl.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <thread>

namespace fieldcast {
namespace {

// Tolerance of the kernel's timers. The default of 50 us is too much for silences of 1.75 ms.
constexpr unsigned long kTimerSlackNanoseconds = 1000;
constexpr std::size_t kLongestThreadName = 15;

}  // namespace

struct IoThread::Loop {
  // Run by one thread: Asio's locks are never contended.
  std::shared_ptr<boost::asio::io_context> context = std::make_shared<boost::asio::io_context>(1);
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{
      context->get_executor()};
  std::thread thread;
};

IoThread::IoThread(const std::string& name) : loop_(std::make_unique<Loop>()) {
  loop_->thread =
      std::thread([&context = *loop_->context, name = name.substr(0, kLongestThreadName)] {
        pthread_setname_np(pthread_self(), name.c_str());
        prctl(PR_SET_TIMERSLACK, kTimerSlackNanoseconds);
        context.run();
      });
}

IoThread::~IoThread() {
  loop_->context->stop();
  loop_->thread.join();
}

boost::asio::io_context& IoThread::context() { return *loop_->context; }

std::shared_ptr<boost::asio::io_context> IoThread::shared_context() { return loop_->context; }

void IoThread::run(std::function<void()> task) {
  std::packaged_task<void()> packaged(std::move(task));
  boost::asio::post(*loop_->context, [&packaged] { packaged(); });
  packaged.get_future().get();
}

}  // namespace fieldcast
