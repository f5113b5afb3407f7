// Sends commands, alarm actions and interests. A worker thread waits for bridges, so the io thread
// never blocks. Each command ends with one outcome and one audit entry. Runs on the io thread,
// except on_result(). Results after close() are dropped.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "bridge/base/worker.hpp"
#include "bridge/store/records/records.hpp"
#include "tools/station/live/client_message.hpp"
#include "tools/station/live/pending_commands.hpp"

namespace fieldcast::web {

// How commands reach a site. May block for some seconds; called on the worker thread.
class CommandRoute {
 public:
  virtual ~CommandRoute() = default;
  [[nodiscard]] virtual tl::expected<std::uint64_t, StationFault> send(StationCommand command) = 0;
  [[nodiscard]] virtual tl::expected<std::uint64_t, StationFault> send(AlarmAction action) = 0;
};

// The domains of this station.
class CommandPort : public CommandRoute {
 public:
  [[nodiscard]] virtual std::uint64_t reserve_request_id() = 0;
  virtual void declare(const std::string& pattern, Duration refresh) = 0;  // 0: withdraw
};

class CommandController : public CommandSink {
 public:
  static constexpr std::size_t kMaxQueued = PendingCommands::kMaxUnderWay;
  // A command that waits longer for the worker is not sent.
  static constexpr Duration kPatience = std::chrono::seconds{5};
  // Time to find a bridge, and time for a result after the lifespan of its command.
  static constexpr Duration kFinding = std::chrono::seconds{3};
  static constexpr Duration kResult = std::chrono::seconds{3};

  // `audit` may be null. `others` receives outcomes of commands without a `done`. All must outlive
  // this object.
  CommandController(boost::asio::io_context& io, CommandPort& port, Audit* audit, Done others);
  ~CommandController() override;
  CommandController(const CommandController&) = delete;
  CommandController& operator=(const CommandController&) = delete;

  // Sends what is for a bus of the stream by `route`, which must exist until close().
  using IsOfStream = std::function<bool(const std::string& bus)>;
  void set_stream(CommandRoute& route, IsOfStream is_of_stream);

  [[nodiscard]] Submitted submit(const Caller& caller, StationCommand command, Done done) override;
  [[nodiscard]] Submitted submit(const Caller& caller, AlarmAction action, Done done) override;
  [[nodiscard]] std::optional<CommandOutcome> find(std::string_view user,
                                                   std::uint64_t request_id) const override {
    return book_.find(user, request_id);
  }
  [[nodiscard]] bool reaches_stream() const override { return stream_ != nullptr; }

  void declare(const std::string& pattern, Duration refresh);

  // Thread-safe.
  void on_result(const StationResult& result);
  void on_outcome(std::uint64_t request_id, const StationOutcome& outcome);

  // Stops sending. Pending commands get no outcome.
  void close();

 private:
  using Sent = tl::expected<std::uint64_t, StationFault>;
  using Send = std::function<Sent()>;
  Submitted enter(PendingCommands::Asked asked, Send send, Duration lifespan, Done done);
  [[nodiscard]] CommandRoute& route_to(const std::string& bus);
  void run(BoundedQueue<std::function<void()>>& queue);
  void declare_all();
  void finish(std::optional<PendingCommands::Ended> ended);
  void watch();
  void post(std::function<void()> task);

  boost::asio::io_context& io_;
  CommandPort& port_;
  CommandRoute* stream_ = nullptr;
  IsOfStream is_of_stream_;
  Audit* const audit_;
  const Done others_;
  PendingCommands book_;
  boost::asio::steady_timer timer_;
  bool watching_ = false;
  std::mutex mutex_;
  std::map<std::string, Duration> declares_;  // interests waiting for the worker; the newest wins
  std::shared_ptr<bool> open_ = std::make_shared<bool>(true);  // null: closed
  const std::weak_ptr<bool> alive_ = open_;                    // thread-safe
  Worker<std::function<void()>> worker_;  // last member: its thread uses the members above
};

}  // namespace fieldcast::web
