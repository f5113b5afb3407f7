// Sends requests about configurations to bridges, one after the other, on its own thread, so that
// the io thread never blocks. Work without a bridge has a second thread. Runs on the io thread.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/clock.hpp"
#include "bridge/base/worker.hpp"
#include "bridge/http/http_server.hpp"
#include "bridge/station/station.hpp"

namespace fieldcast::web {

class ConfigurationRequests {
 public:
  static constexpr std::size_t kMaxWaiting = 16;
  // For the reply of a bridge. The plan of a large configuration lasts seconds.
  static constexpr Duration kWait = std::chrono::seconds{20};
  // A request that has waited longer for its turn is not sent. Its client could get the response
  // 503, of HttpLimits::handler, before the bridge runs the request.
  static constexpr Duration kPatience = HttpLimits{}.handler - kWait - std::chrono::seconds{1};

  using Replied = tl::expected<std::string, StationFault>;
  // Blocks; called on the thread of this object.
  using Send = std::function<Replied(const std::string& bridge, std::string request)>;
  // `cancel` ends a pending `send`. `now`: any thread. `io` must outlive this object.
  ConfigurationRequests(boost::asio::io_context& io, Send send, std::function<void()> cancel,
                        std::function<Instant()> now = steady_now);
  ~ConfigurationRequests();
  ConfigurationRequests(const ConfigurationRequests&) = delete;
  ConfigurationRequests& operator=(const ConfigurationRequests&) = delete;

  // `done` is called once on the io thread, unless this object is destroyed before; without a value
  // if the request was not sent within kPatience. Returns false if too many requests wait; then
  // `done` is not called.
  [[nodiscard]] bool send(std::string bridge, std::string request,
                          std::function<void(std::optional<Replied>)> done);
  // Does other slow work about configurations on a thread without bridges; `done` as above.
  [[nodiscard]] bool run(std::function<void()> work, std::function<void()> done);

 private:
  using Tasks = Worker<std::function<void()>>;

  [[nodiscard]] bool put(Tasks& tasks, std::function<void()> work, std::function<void()> done);

  boost::asio::io_context& io_;
  const Send send_;
  const std::function<void()> cancel_;
  const std::function<Instant()> now_;
  std::shared_ptr<bool> open_ = std::make_shared<bool>(true);
  Tasks requests_, local_;  // last: their threads use the members above
};

}  // namespace fieldcast::web
