#include "tools/station/live/configuration_requests.hpp"

#include <boost/asio/post.hpp>
#include <utility>

namespace fieldcast::web {

namespace {

void run_tasks(BoundedQueue<std::function<void()>>& tasks) {
  while (const auto task = tasks.take()) {
    if (!tasks.closed()) (*task)();
  }
}

}  // namespace

ConfigurationRequests::ConfigurationRequests(boost::asio::io_context& io, Send send,
                                             std::function<void()> cancel,
                                             std::function<Instant()> now)
    : io_(io),
      send_(std::move(send)),
      cancel_(std::move(cancel)),
      now_(std::move(now)),
      requests_("configure", kMaxWaiting, run_tasks),
      local_("import", kMaxWaiting, run_tasks) {}

ConfigurationRequests::~ConfigurationRequests() {
  requests_.queue().close();
  local_.queue().close();
  cancel_();
}

bool ConfigurationRequests::send(std::string bridge, std::string request,
                                 std::function<void(std::optional<Replied>)> done) {
  auto replied = std::make_shared<std::optional<Replied>>();
  return put(
      requests_,
      [this, replied, latest = now_() + kPatience, bridge = std::move(bridge),
       request = std::move(request)] {
        if (now_() <= latest) *replied = send_(bridge, request);
      },
      [replied, done = std::move(done)] { done(std::move(*replied)); });
}

bool ConfigurationRequests::run(std::function<void()> work, std::function<void()> done) {
  return put(local_, std::move(work), std::move(done));
}

bool ConfigurationRequests::put(Tasks& tasks, std::function<void()> work,
                                std::function<void()> done) {
  std::function<void()> task = [this, weak = std::weak_ptr(open_), work = std::move(work),
                                done = std::move(done)] {
    work();
    boost::asio::post(io_, [weak, done] {
      if (!weak.expired()) done();
    });
  };
  return tasks.queue().try_put(task);
}

}  // namespace fieldcast::web
