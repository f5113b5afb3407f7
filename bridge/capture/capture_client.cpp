#include "bridge/capture/capture_client.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

#include "bridge/base/clock.hpp"
#include "bridge/capture/capture_socket.hpp"

namespace fieldcast {

namespace asio = boost::asio;

CaptureClient::CaptureClient(Socket socket,
                             std::function<void(CaptureClient&, const std::string&)> asked,
                             std::function<void(CaptureClient&)> gone)
    : socket_(std::move(socket)),
      limit_(socket_.get_executor()),
      asked_(std::move(asked)),
      gone_(std::move(gone)) {}

void CaptureClient::start() {
  limit_.expires_after(kRequestLimit);
  limit_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
    if (!cancelled) self->close();
  });
  read();
}

// After the request only the end of the stream is expected, which ends the capture.
void CaptureClient::read() {
  socket_.async_read_some(
      asio::buffer(buffer_),
      [self = shared_from_this()](boost::system::error_code error, std::size_t size) {
        if (!error) return self->came(size);
        if (error == asio::error::eof && !self->bus_.empty())
          return self->end({}, read_clocks().utc);
        self->close();
      });
}

void CaptureClient::came(std::size_t size) {
  if (!bus_.empty() || ending_) return read();
  request_.append(buffer_.data(), size);
  const auto end = request_.find('\n');
  if (end == request_.npos && request_.size() <= kMaxCaptureRequest) return read();
  limit_.cancel();
  asked_(*this, request_.substr(0, end));
  if (!bus_.empty()) read();
}

void CaptureClient::reply(const std::string& text) {
  waiting_.insert(waiting_.end(), text.begin(), text.end());
  waiting_.push_back('\n');
  ending_ = true;
  send();
}

void CaptureClient::begin(const std::string& name, const Bytes& head, UtcTime now) {
  static constexpr std::string_view kOk = "ok\n";
  bus_ = name;
  counts_ = {.begun = now, .ended = now};
  waiting_.insert(waiting_.end(), kOk.begin(), kOk.end());
  append(waiting_, head);
  send();
}

void CaptureClient::packet(ByteView block, UtcTime at, bool) {
  if (ending_) return;
  if (waiting_.size() + block.size() > kMaxUnsent) {
    ++counts_.dropped;
    return;
  }
  append(waiting_, block);
  ++counts_.frames;
  counts_.ended = at;
  send();
}

void CaptureClient::end(const std::string& why, UtcTime now) {
  if (std::exchange(ending_, true)) return;
  counts_.ended = now;
  append(waiting_, capture_tail(counts_, why));
  limit_.expires_after(kEndLimit);
  limit_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
    if (!cancelled) self->close();
  });
  send();
}

void CaptureClient::send() {
  if (!sending_.empty()) return;
  if (waiting_.empty()) {
    if (ending_) close();
    return;
  }
  sending_.swap(waiting_);
  asio::async_write(socket_, asio::buffer(sending_),
                    [self = shared_from_this()](boost::system::error_code error, std::size_t) {
                      self->sending_.clear();
                      error ? self->close() : self->send();
                    });
}

void CaptureClient::close() {
  const auto gone = std::exchange(gone_, {});
  if (!gone) return;
  ending_ = true;
  boost::system::error_code ignored;
  limit_.cancel();
  socket_.close(ignored);
  gone(*this);
}

}  // namespace fieldcast
