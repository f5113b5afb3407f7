#include "tools/bench/support/live_clients.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cstring>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t kHeader = 16;  // bytes of a frame before its columns

double now_ms() {
  using namespace std::chrono;
  return duration<double, std::milli>(system_clock::now().time_since_epoch()).count();
}

tcp::endpoint server(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

std::string host_of(std::uint16_t port) { return "127.0.0.1:" + std::to_string(port); }

class Client {
 public:
  Client(asio::io_context& io, std::uint16_t port) : stream_(io), port_(port) {}

  void connect() {
    begun_ = Clock::now();
    stream_.next_layer().connect(server(port_));
    stream_.next_layer().set_option(tcp::no_delay(true));
    stream_.set_option(websocket::stream_base::decorator([this](websocket::request_type& request) {
      request.set(http::field::origin, "http://" + host_of(port_));
      request.set(http::field::sec_websocket_protocol, "fieldcast.1");
    }));
    stream_.handshake(host_of(port_), "/live");
    stream_.text(true);
    stream_.write(asio::buffer(std::string_view(R"({"subscribe":"*"})")));
    open_ = true;
    read();
  }
  void close() {
    error_code ignored;
    stream_.next_layer().close(ignored);
  }
  void pause(bool paused) {
    const bool was = std::exchange(paused_, paused);
    if (was && !paused && !reading_) read();
  }

  // REQUIRES: the lock of all clients is held for the following members.
  LiveReceived received;
  double newest_ms = 0;
  std::uint64_t values = 0;                               // since the connection
  std::vector<std::pair<std::uint64_t, double>> arrived;  // values, and seconds since connect()

  std::mutex* lock = nullptr;
  [[nodiscard]] bool is_open() const { return open_; }

 private:
  void read() {
    if (paused_) return;
    reading_ = true;
    stream_.async_read(buffer_, [this](error_code fault, std::size_t bytes) {
      reading_ = false;
      if (fault) {
        open_ = false;
        return;
      }
      take(bytes);
      buffer_.clear();
      read();
    });
  }
  void take(std::size_t bytes) {
    const std::lock_guard guard(*lock);
    received.bytes += bytes;
    if (stream_.got_text()) {
      ++received.texts;
      return;
    }
    const auto* data = static_cast<const char*>(buffer_.cdata().data());
    std::uint32_t n = 0;
    double base = 0;
    std::memcpy(&n, data + 4, sizeof n);
    std::memcpy(&base, data + 8, sizeof base);
    if (n == 0) return;
    const double now = now_ms();
    const bool first = values == 0;
    ++received.frames;
    received.values += n;
    values += n;
    newest_ms = std::max(newest_ms, base);
    if (arrived.size() < 64) arrived.emplace_back(values, seconds_since(begun_));
    if (first) return;
    for (std::uint32_t i = 0; i < n; i += 16) {
      std::uint32_t age = 0;
      std::memcpy(&age, data + kHeader + std::size_t{12} * n + std::size_t{4} * i, sizeof age);
      if (age != 0xFFFFFFFF) received.spread_ms.push_back(now - base + age);
    }
  }

  websocket::stream<tcp::socket> stream_;
  const std::uint16_t port_;
  beast::flat_buffer buffer_;
  Clock::time_point begun_;
  bool paused_ = false, reading_ = false;
  std::atomic<bool> open_{false};
};

}  // namespace

struct LiveClients::State {
  explicit State(std::uint16_t at) : port(at) {}
  template <class Task>
  void run(Task task) {
    std::promise<void> done;
    asio::post(io, [&] {
      try {
        task();
        done.set_value();
      } catch (...) { done.set_exception(std::current_exception()); }
    });
    done.get_future().get();
  }

  const std::uint16_t port;
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  mutable std::mutex lock;
  std::vector<std::unique_ptr<Client>> clients;
  std::thread thread{[this] { io.run(); }};
};

LiveClients::LiveClients(std::uint16_t port) : state_(std::make_unique<State>(port)) {}

LiveClients::~LiveClients() {
  state_->run([this] {
    for (auto& client : state_->clients) client->close();
  });
  state_->work.reset();
  state_->thread.join();
}

std::size_t LiveClients::connect() {
  auto client = std::make_unique<Client>(state_->io, state_->port);
  client->lock = &state_->lock;
  state_->run([&] { client->connect(); });
  const std::lock_guard guard(state_->lock);
  state_->clients.push_back(std::move(client));
  return state_->clients.size() - 1;
}

double LiveClients::first_data(std::size_t client, std::uint64_t values, double patience) {
  const auto begin = Clock::now();
  while (seconds_since(begin) < patience) {
    {
      const std::lock_guard guard(state_->lock);
      for (const auto& [count, seconds] : state_->clients[client]->arrived) {
        if (count >= values) return seconds;
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return 0;
}

void LiveClients::stop_reading(std::size_t client) {
  state_->run([&] { state_->clients[client]->pause(true); });
}

void LiveClients::resume(std::size_t client) {
  state_->run([&] { state_->clients[client]->pause(false); });
}

double LiveClients::age(std::size_t client) const {
  const std::lock_guard guard(state_->lock);
  return (now_ms() - state_->clients[client]->newest_ms) / 1e3;
}

void LiveClients::mark() {
  const std::lock_guard guard(state_->lock);
  for (auto& client : state_->clients) client->received = {};
}

LiveReceived LiveClients::received(std::size_t client) const {
  const std::lock_guard guard(state_->lock);
  return state_->clients[client]->received;
}

bool LiveClients::is_open(std::size_t client) const { return state_->clients[client]->is_open(); }

Fetched fetch(std::uint16_t port, const std::string& path) {
  const auto begin = Clock::now();
  asio::io_context io;
  tcp::socket socket(io);
  socket.connect(server(port));
  http::request<http::empty_body> request(http::verb::get, path, 11);
  request.set(http::field::host, host_of(port));
  request.set(http::field::accept_encoding, "gzip");
  http::write(socket, request);
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(64u << 20u);
  http::read(socket, buffer, parser);
  return {parser.get().body().size(), seconds_since(begin), parser.get().result_int()};
}

}  // namespace fieldcast::bench
