// Sends the commands of people, what they do about alarms, and interests, without holding up the io
// thread: a worker thread waits for bridges. Each command ends in one outcome, and in one entry of
// the station's audit where there is one.
//
// Everything on the io thread, but on_result(), which is for any thread. Results that come after
// close() are dropped.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "bridge/base/worker.hpp"
#include "bridge/store/audit.hpp"
#include "tools/station/live/command_book.hpp"
#include "tools/station/live/command_sink.hpp"

namespace fieldcast::web {

// What the desk needs of DDS.
class CommandPort {
 public:
  virtual ~CommandPort() = default;
  [[nodiscard]] virtual std::uint64_t reserve_request_id() = 0;
  // These may wait some seconds; on the desk's worker thread.
  [[nodiscard]] virtual tl::expected<std::uint64_t, StationFault> send(StationCommand command) = 0;
  [[nodiscard]] virtual tl::expected<std::uint64_t, StationFault> send(AlarmAction action) = 0;
  virtual void declare(const std::string& pattern, Duration refresh) = 0;  // 0: withdraw
};

class CommandDesk : public CommandSink {
 public:
  static constexpr std::size_t kMaxQueued = CommandBook::kMaxUnderWay;
  // What still waits for the worker after this time is not sent.
  static constexpr Duration kPatience = std::chrono::seconds{5};
  // For a bridge to be found, and for a result after the lifespan of its command.
  static constexpr Duration kFinding = std::chrono::seconds{3};
  static constexpr Duration kResult = std::chrono::seconds{3};

  // `audit` may be null. `others` is told the outcomes of commands that nobody waits for. All of
  // them outlive the desk; the port is used from the first command on.
  CommandDesk(boost::asio::io_context& io, CommandPort& port, Audit* audit, Done others);
  ~CommandDesk() override;
  CommandDesk(const CommandDesk&) = delete;
  CommandDesk& operator=(const CommandDesk&) = delete;

  [[nodiscard]] Submitted submit(const Caller& caller, StationCommand command, Done done) override;
  [[nodiscard]] Submitted submit(const Caller& caller, AlarmAction action, Done done) override;
  [[nodiscard]] std::optional<CommandOutcome> find(std::string_view user,
                                                   std::uint64_t request_id) const override {
    return book_.find(user, request_id);
  }

  // As InterestBook::Declare.
  void declare(const std::string& pattern, Duration refresh);

  void on_result(const StationResult& result);  // any thread

  // Nothing is sent from here on; what is under way has no outcome any more.
  void close();

 private:
  using Sent = tl::expected<std::uint64_t, StationFault>;
  using Send = std::function<Sent()>;
  Submitted enter(CommandBook::Asked asked, Send send, Duration lifespan, Done done);
  void run(BoundedQueue<std::function<void()>>& queue);
  void declare_all();
  void finish(std::optional<CommandBook::Ended> ended);
  void watch();
  // Runs on the io thread, unless the desk is closed by then.
  void post(std::function<void()> task);

  boost::asio::io_context& io_;
  CommandPort& port_;
  Audit* const audit_;
  const Done others_;
  CommandBook book_;
  boost::asio::steady_timer timer_;
  bool watching_ = false;
  std::mutex mutex_;
  std::map<std::string, Duration> declares_;  // those that wait for the worker; the newest wins
  std::shared_ptr<bool> open_ = std::make_shared<bool>(true);  // null: closed
  const std::weak_ptr<bool> alive_ = open_;                    // any thread
  Worker<std::function<void()>> worker_;                       // last: it uses what is above
};

}  // namespace fieldcast::web
