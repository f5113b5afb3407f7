#include "bridge/metrics/metrics_server.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <utility>

#include "bridge/base/io_thread.hpp"
#include "bridge/http/http_server.hpp"
#include "bridge/log/log.hpp"
#include "bridge/net/byte_stream.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;

constexpr int kNiceness = 10;  // the buses have priority
constexpr std::string_view kPath = "/metrics", kHealthPath = "/healthz";
constexpr std::string_view kPlainText = "text/plain; charset=utf-8";

class MetricsService final : public web::HttpService {
 public:
  MetricsService(MetricsServer::Source source, MetricsServer::Health health)
      : source_(std::move(source)), health_(std::move(health)) {}

  void handle(web::RawRequest request, web::Reply reply) override {
    const std::string_view path =
        std::string_view(request.target).substr(0, request.target.find('?'));
    if (path != kPath && path != kHealthPath) return reply(refusal(404, {}, {}));
    if (request.method != "GET") {
      web::HttpResponse refused = refusal(405, {}, {});
      refused.headers.emplace_back("allow", "GET");
      return reply(std::move(refused));
    }
    web::HttpResponse response;
    if (path == kHealthPath) {
      const std::string fault = health_();
      response.status = fault.empty() ? 200 : 503;
      response.content_type = kPlainText;
      response.body = (fault.empty() ? "ok" : fault) + '\n';
      return reply(std::move(response));
    }
    const MetricsFormat format = format_for(request.accept);
    response.content_type = content_type_of(format);
    response.body = source_(format);
    reply(std::move(response));
  }
  web::HttpResponse refusal(unsigned status, std::string_view, std::string_view) const override {
    web::HttpResponse refused;
    refused.status = status;
    refused.content_type = kPlainText;
    refused.body = fmt::format("{}; there are GET {} and GET {}\n", web::reason_of(status), kPath,
                               kHealthPath);
    refused.close = true;
    return refused;
  }

 private:
  const MetricsServer::Source source_;
  const MetricsServer::Health health_;
};

web::ServerLimits server_limits(const MetricsServer::Limits& limits) {
  const std::size_t most = limits.connections;
  web::ServerLimits all;
  all.connections = {
      .total = most, .of_one = most, .working_of_one = most, .reserved = 0, .evicts_working = true};
  all.http.header_bytes = all.http.body_bytes = limits.header_bytes;
  // The wait for the first byte, and that for the rest.
  all.http.idle = all.http.header = all.http.body = limits.request / 2;
  all.http.progress = all.http.response = limits.response;
  return all;
}

}  // namespace

struct MetricsServer::State {
  State(const ListenSpec& where, Source source, Health health, const Limits& given)
      : listen(where), limits(given), service(std::move(source), std::move(health)) {}

  void open();
  void close();

  const ListenSpec listen;
  const Limits limits;
  MetricsService service;
  std::atomic<std::uint16_t> port{0};
  bool said = false;       // the failure to listen was logged
  IoThread io{"metrics"};  // outlives the members below, and ends before those above
  asio::steady_timer again{io.context()};
  web::HttpServer server{io.context(), service, server_limits(limits)};
  std::optional<Listener> listener;
};

void MetricsServer::State::open() {
  listener.emplace(io.context(),
                   [this](asio::ip::tcp::socket socket) { server.accept(std::move(socket)); });
  if (const auto listening = listener->open(listen); !listening) {
    listener.reset();
    if (!said)
      log_error("metrics", fmt::format("{}: they are not served, the buses run; tried again every "
                                       "{} until it succeeds",
                                       listening.error(), to_text(limits.try_again)));
    said = true;
    again.expires_after(limits.try_again);
    return again.async_wait([this](boost::system::error_code cancelled) {
      if (!cancelled) open();
    });
  }
  port = listener->port();
  const bool v6 = listen.host.find(':') != std::string::npos;
  log_info("metrics", fmt::format("served at http://{}:{}{}",
                                  v6 ? '[' + listen.host + ']' : listen.host, port.load(), kPath));
  if (!on_loopback(listen))
    log_warning(
        "metrics",
        fmt::format("{} needs no login: every client that can connect to it can read the values",
                    listen.host));
}

void MetricsServer::State::close() {
  again.cancel();
  listener.reset();
  server.close();
}

MetricsServer::MetricsServer(const ListenSpec& listen, Source source, Health health,
                             const Limits& limits)
    : state_(std::make_unique<State>(listen, std::move(source), std::move(health), limits)) {
  asio::post(state_->io.context(), [&state = *state_] {
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);  // of this thread
    state.open();
  });
}

MetricsServer::~MetricsServer() {
  state_->io.run([this] { state_->close(); });
  state_->io.run([] {});  // the cancelled handlers have run
}

std::uint16_t MetricsServer::port() const { return state_->port; }

}  // namespace fieldcast
