// A ByteStream over a socket or a descriptor of Asio. Only for bridge/net.
#pragma once

#include <boost/asio/socket_base.hpp>
#include <utility>

#include "bridge/net/byte_stream.hpp"

namespace fieldcast {

template <typename Stream>
class StreamOf final : public ByteStream {
 public:
  explicit StreamOf(Stream stream) : stream_(std::move(stream)) {}
  void read_some(boost::asio::mutable_buffer into, Done done) override {
    stream_.async_read_some(into, std::move(done));
  }
  void write_some(boost::asio::const_buffer from, Done done) override {
    stream_.async_write_some(from, std::move(done));
  }
  std::size_t queued() const override {
    return queued_at(static_cast<int>(const_cast<Stream&>(stream_).native_handle()));
  }
  void end_sending() override {
    if constexpr (requires { stream_.shutdown(boost::asio::socket_base::shutdown_send); }) {
      boost::system::error_code ignored;
      stream_.shutdown(boost::asio::socket_base::shutdown_send, ignored);
    }
  }
  void close() override {
    boost::system::error_code ignored;
    stream_.close(ignored);
  }

 private:
  Stream stream_;
};

}  // namespace fieldcast
