// Serves the site and its WebSockets at /live. Runs on the io thread, as the site does.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "bridge/http/http_server.hpp"
#include "tools/station/web/live_socket.hpp"

namespace fieldcast::web {

struct StationLimits : ServerLimits {
  ConnectionLimits live{.total = 64, .of_one = 48, .working_of_one = 48, .reserved = 16};
  std::size_t live_of_one = 8;                  // WebSockets of one logged-in user
  Duration farewell = std::chrono::seconds{2};  // for WebSockets when the server closes
  LiveLimits socket;
};

struct StationCounters : ServerCounters {
  std::size_t live = 0;  // current WebSockets
};

class StationServer final : private HttpService {
 public:
  // The site must outlive the server. If `make` is empty, /live does not exist.
  StationServer(boost::asio::io_context& io, Site& site, MakeLiveProtocol make,
                const StationLimits& limits = {});
  ~StationServer() override;  // closes all connections without a farewell
  StationServer(const StationServer&) = delete;
  StationServer& operator=(const StationServer&) = delete;

  [[nodiscard]] HttpServer& http() { return http_; }
  // Closes every connection. Calls `done` when all are closed, at the latest after the farewell.
  void close(std::function<void()> done);

  [[nodiscard]] StationCounters counters() const;

 private:
  void handle(RawRequest request, Reply reply) override;
  HttpResponse refusal(unsigned status, std::string_view error,
                       std::string_view hint) const override;
  bool has_login(const RawRequest& request) override;
  bool takes_long_body(const RawRequest& request) override;
  tl::expected<TakeStream, HttpResponse> upgrade(const RawRequest& request) override;
  [[nodiscard]] std::optional<HttpResponse> refuse_live(const Site::Upgrade& who);
  void open_live(LiveRequest request);
  void end_logins(std::uint64_t id);
  void keep_house();
  void look_for_end();

  boost::asio::io_context& io_;
  Site& site_;
  const MakeLiveProtocol make_;
  const StationLimits limits_;
  HttpServer http_;
  std::uint64_t last_live_ = 0, live_refused_ = 0;
  ConnectionTable live_table_;
  std::map<LiveSocket*, std::shared_ptr<LiveSocket>> live_;
  boost::asio::steady_timer house_, farewell_;
  std::function<void()> done_;
  const std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace fieldcast::web
