#include "bridge/metrics/metrics_server.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "bridge/base/io_thread.hpp"
#include "bridge/log/log.hpp"
#include "bridge/net/byte_stream.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr int kNiceness = 10;               // the buses have priority
constexpr std::chrono::seconds kLinger{1};  // time for a client to read the last response
constexpr std::string_view kPath = "/metrics";

// Shared data of the connections, which it outlives.
struct Service {
  const MetricsServer::Source source;
  const MetricsServer::Limits limits;
};

// One client, which may send several requests. Closes itself after a fault or a time limit.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, const Service& service)
      : stream_(std::move(socket)), service_(service), buffer_(2 * service.limits.header_bytes) {}

  void read() {
    mark_progress();
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(service_.limits.header_bytes));
    stream_.expires_after(service_.limits.request);
    http::async_read_header(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](error_code fault, std::size_t) { self->on_header(fault); });
  }
  void close() {
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    stream_.close();
  }
  [[nodiscard]] bool is_open() const { return stream_.socket().is_open(); }
  // Time at which the present wait for the client began.
  [[nodiscard]] std::chrono::steady_clock::time_point since() const { return since_; }

 private:
  void mark_progress() { since_ = std::chrono::steady_clock::now(); }

  void on_header(error_code fault) {
    if (fault == http::error::header_limit || fault == http::error::buffer_overflow)
      return refuse(http::status::request_header_fields_too_large);
    const bool foreign =
        fault && fault.category() == http::make_error_code(http::error::bad_method).category();
    if (foreign && fault != http::error::end_of_stream && fault != http::error::partial_message)
      return refuse(http::status::bad_request);
    if (fault) return close();
    const auto& request = parser_->get();
    keep_alive_ = request.keep_alive() && parser_->is_done();
    const beast::string_view target = request.target();
    const std::string_view path = std::string_view(target.data(), target.size());
    if (path.substr(0, path.find('?')) != kPath) return refuse(http::status::not_found);
    if (request.method() != http::verb::get) return refuse(http::status::method_not_allowed);
    const beast::string_view accept = request[http::field::accept];
    const MetricsFormat format = format_for({accept.data(), accept.size()});
    respond(http::status::ok, content_type_of(format), service_.source(format));
  }
  void refuse(http::status status) {
    keep_alive_ = false;
    const beast::string_view reason = http::obsolete_reason(status);
    respond(status, "text/plain; charset=utf-8",
            fmt::format("{}; there is GET {}\n", std::string_view(reason.data(), reason.size()),
                        kPath));
  }
  void respond(http::status status, std::string_view type, std::string text) {
    response_ = http::response<http::string_body>(status, 11);
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    if (status == http::status::method_not_allowed) response_.set(http::field::allow, "GET");
    response_.keep_alive(keep_alive_);
    response_.body() = std::move(text);
    response_.prepare_payload();
    mark_progress();
    stream_.expires_after(service_.limits.response);
    http::async_write(
        stream_, response_,
        [self = shared_from_this()](error_code fault, std::size_t) { self->on_written(fault); });
  }
  void on_written(error_code fault) {
    response_.body() = {};
    if (fault) return close();
    if (keep_alive_) return read();
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(kLinger);
    drain();
  }
  // Reads and discards what the client still sends. If a socket with unread bytes is closed, TCP
  // resets the connection and the response can be lost.
  void drain() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(service_.limits.header_bytes),
                            [self = shared_from_this()](error_code fault, std::size_t) {
                              return fault ? self->close() : self->drain();
                            });
  }

  beast::tcp_stream stream_;
  const Service& service_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
  bool keep_alive_ = false;
  std::chrono::steady_clock::time_point since_;
};

}  // namespace

struct MetricsServer::State {
  State(const ListenSpec& where, Source source, const Limits& limits)
      : listen(where), service{std::move(source), limits} {}

  void open();
  void accept(tcp::socket socket);
  void close();

  const ListenSpec listen;
  const Service service;
  std::atomic<std::uint16_t> port{0};
  bool said = false;  // the failure to listen was logged
  std::vector<std::weak_ptr<Connection>> connections;
  IoThread io{"metrics"};  // outlives the members below, and ends before those above
  asio::steady_timer again{io.context()};
  std::optional<Listener> listener;
};

void MetricsServer::State::open() {
  listener.emplace(io.context(), [this](tcp::socket socket) { accept(std::move(socket)); });
  if (const auto listening = listener->open(listen); !listening) {
    listener.reset();
    if (!said)
      log_error("metrics", fmt::format("{}: they are not served, the buses run; tried again every "
                                       "{} until it succeeds",
                                       listening.error(), to_text(service.limits.try_again)));
    said = true;
    again.expires_after(service.limits.try_again);
    return again.async_wait([this](error_code cancelled) {
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

void MetricsServer::State::accept(tcp::socket socket) {
  std::erase_if(connections, [](const auto& each) {
    const auto connection = each.lock();
    return !connection || !connection->is_open();
  });
  if (connections.size() >= service.limits.connections) {
    const auto oldest = std::ranges::min_element(
        connections, {}, [](const auto& each) { return each.lock()->since(); });
    oldest->lock()->close();
    connections.erase(oldest);
  }
  const auto made = std::make_shared<Connection>(std::move(socket), service);
  connections.push_back(made);
  made->read();
}

void MetricsServer::State::close() {
  again.cancel();
  listener.reset();
  for (const auto& each : connections) {
    if (const auto connection = each.lock()) connection->close();
  }
}

MetricsServer::MetricsServer(const ListenSpec& listen, Source source, const Limits& limits)
    : state_(std::make_unique<State>(listen, std::move(source), limits)) {
  asio::post(state_->io.context(), [&state = *state_] {
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);  // of this thread
    state.open();
  });
}

MetricsServer::~MetricsServer() {
  const auto wait_for = [&io = state_->io](auto task) {
    std::promise<void> done;
    asio::post(io.context(), [&] {
      task();
      done.set_value();
    });
    done.get_future().wait();
  };
  wait_for([this] { state_->close(); });
  wait_for([] {});  // the cancelled handlers have run
}

std::uint16_t MetricsServer::port() const { return state_->port; }

}  // namespace fieldcast
