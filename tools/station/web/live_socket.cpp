#include "tools/station/web/live_socket.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "tools/station/web/stream_adapter.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

constexpr std::size_t kMaxReasonBytes = 120;
// costs memory for each client and helps to guess secrets (CRIME)
constexpr bool kCompression = false;

std::chrono::steady_clock::duration steady(Duration duration) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(duration);
}

class Socket final : public LiveSocket,
                     public LivePeer,
                     public std::enable_shared_from_this<Socket> {
 public:
  Socket(asio::io_context& io, LiveRequest request, const LiveLimits& limits,
         std::function<void(LiveSocket*)> gone)
      : io_(io),
        who_(std::move(request.who)),
        limits_(limits),
        gone_(std::move(gone)),
        stream_(StreamAdapter(io, std::move(request.stream))),
        message_(limits.message_bytes + 1, '\0'),  // + 1: never full, a longer message is refused
        wake_(io),
        end_(io) {
    http::request_parser<http::empty_body> parser;
    parser.eager(true);
    error_code fault;
    parser.put(asio::const_buffer(request.head.data(), request.head.size()), fault);
    FIELDCAST_CHECK(parser.is_done());  // HttpSession has parsed the same header
    request_ = parser.release();
  }

  void start(const MakeLiveProtocol& make) {
    protocol_ = make(who_.caller, *this);
    stream_.set_option(
        websocket::stream_base::timeout{steady(limits_.handshake), steady(limits_.idle), true});
    stream_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, "fieldcast.1");
      response.set(http::field::server, "fieldcast");
    }));
    stream_.read_message_max(limits_.message_bytes);
    stream_.auto_fragment(false);
    stream_.async_accept(request_, [self = shared_from_this()](error_code fault) {
      if (self->closed_) return;
      if (fault) return self->drop();
      self->open_ = true;
      self->protocol_->on_open(steady_now());
      self->read();
    });
  }

  const Site::Upgrade& who() const override { return who_; }
  void end(std::string_view reason) override { close(reason); }

  void drop() override {
    if (closed_) return;
    closed_ = true;
    wake_.cancel();
    end_.cancel();
    stream_.next_layer().stream().close();
    if (open_) protocol_->on_closed();
    asio::post(io_, [self = shared_from_this()] {
      self->protocol_.reset();
      self->gone_(self.get());
    });
  }

  void send_text(std::string message) override {
    if (closed_ || ending_) return;
    unsent_bytes_ += message.size();
    if (unsent_bytes_ > kMaxUnsent) return drop_soon();
    unsent_.push_back({std::make_shared<const std::string>(std::move(message)), false});
    write();
  }
  void send_binary(std::shared_ptr<const std::string> frame) override {
    if (closed_ || ending_) return;
    FIELDCAST_CHECK(!binary_under_way_);
    binary_under_way_ = true;
    unsent_.push_back({std::move(frame), true});
    write();
  }
  void wake_at(Instant when) override {
    wake_.cancel();
    if (closed_ || ending_ || when == kNever) return;
    wake_.expires_at(std::chrono::steady_clock::time_point(steady(when.time_since_epoch())));
    wake_.async_wait([self = shared_from_this()](error_code cancelled) {
      if (!cancelled && !self->closed_ && !self->ending_) self->protocol_->on_wake(steady_now());
    });
  }
  void close(std::string_view reason) override {
    if (closed_ || ending_) return;
    ending_ = true;
    reason_ = std::string(reason.substr(0, kMaxReasonBytes));
    wake_.cancel();
    end_.expires_after(steady(limits_.handshake));
    end_.async_wait([self = shared_from_this()](error_code cancelled) {
      if (!cancelled) self->drop();
    });
    if (!open_) return drop_soon();
    if (!writing_) say_goodbye();
  }

 private:
  struct Message {
    std::shared_ptr<const std::string> bytes;
    bool binary;
  };

  // Post the drop: the protocol may be the caller.
  void drop_soon() {
    ending_ = true;
    asio::post(io_, [self = shared_from_this()] { self->drop(); });
  }

  // Beast 1.74 fails an assertion in async_read() (read_size_hint) if this side closes while it
  // receives a fragmented message; so read parts into our own buffer.
  void read() {
    stream_.async_read_some(asio::buffer(&message_[size_], message_.size() - size_),
                            [self = shared_from_this()](error_code fault, std::size_t count) {
                              if (self->closed_) return;
                              if (fault) return self->drop();
                              self->on_read(count);
                            });
  }
  void on_read(std::size_t count) {
    size_ += count;
    if (stream_.is_message_done()) {
      on_message(std::string_view(message_).substr(0, size_));
      size_ = 0;
    }
    if (!closed_) read();
  }
  void on_message(std::string_view message) {
    if (ending_) return;
    if (!stream_.got_text()) return close("messages are text");
    protocol_->on_text(message, steady_now());
  }

  void write() {
    if (writing_ || closed_ || unsent_.empty()) return;
    writing_ = true;
    const Message message = unsent_.front();
    stream_.binary(message.binary);
    stream_.async_write(asio::buffer(*message.bytes),
                        [self = shared_from_this(), message](error_code fault, std::size_t) {
                          if (self->closed_) return;
                          if (fault) return self->drop();
                          self->on_written(message);
                        });
  }
  void on_written(const Message& message) {
    writing_ = false;
    unsent_.pop_front();
    if (message.binary)
      binary_under_way_ = false;
    else
      unsent_bytes_ -= message.bytes->size();
    if (ending_) return say_goodbye();
    write();
    if (message.binary) protocol_->on_taken(steady_now());
  }
  void say_goodbye() {
    unsent_.clear();
    stream_.async_close(websocket::close_reason(websocket::close_code::policy_error, reason_),
                        [self = shared_from_this()](error_code) { self->drop(); });
  }

  asio::io_context& io_;
  const Site::Upgrade who_;
  const LiveLimits limits_;
  const std::function<void(LiveSocket*)> gone_;
  websocket::stream<StreamAdapter, kCompression> stream_;
  http::request<http::empty_body> request_;
  std::string message_;  // received part of the client's message: the first size_ bytes
  std::size_t size_ = 0;
  asio::steady_timer wake_, end_;
  std::unique_ptr<LiveProtocol> protocol_;
  std::deque<Message> unsent_;    // the first message is being written
  std::size_t unsent_bytes_ = 0;  // text messages only
  std::string reason_;
  bool open_ = false, writing_ = false, binary_under_way_ = false, ending_ = false, closed_ = false;
};

}  // namespace

std::shared_ptr<LiveSocket> LiveSocket::open(boost::asio::io_context& io, LiveRequest request,
                                             const MakeLiveProtocol& make, const LiveLimits& limits,
                                             std::function<void(LiveSocket*)> gone) {
  const auto socket = std::make_shared<Socket>(io, std::move(request), limits, std::move(gone));
  socket->start(make);
  return socket;
}

}  // namespace fieldcast::web
