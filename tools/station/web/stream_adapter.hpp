// Adapts ByteStream to the stream concept of Boost.Beast. For live_socket.cpp only.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/role.hpp>
#include <memory>
#include <utility>

#include "bridge/net/byte_stream.hpp"

namespace fieldcast::web {

class StreamAdapter {
 public:
  using executor_type = boost::asio::any_io_executor;

  StreamAdapter(boost::asio::io_context& io, std::unique_ptr<ByteStream> stream)
      : executor_(io.get_executor()), stream_(std::move(stream)) {}

  [[nodiscard]] executor_type get_executor() const { return executor_; }
  [[nodiscard]] ByteStream& stream() { return *stream_; }

  template <typename Buffers, typename Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
        [this, into = first_of<boost::asio::mutable_buffer>(buffers)](auto handler) {
          if (into.size() == 0) return complete(std::move(handler));
          stream_->read_some(into, shared(std::move(handler)));
        },
        token);
  }
  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
        [this, from = first_of<boost::asio::const_buffer>(buffers)](auto handler) {
          if (from.size() == 0) return complete(std::move(handler));
          stream_->write_some(from, shared(std::move(handler)));
        },
        token);
  }

 private:
  // The first buffer that is not empty; read_some and write_some may transfer fewer bytes.
  template <typename Buffer, typename Buffers>
  static Buffer first_of(const Buffers& buffers) {
    for (auto at = boost::asio::buffer_sequence_begin(buffers);
         at != boost::asio::buffer_sequence_end(buffers); ++at) {
      const Buffer buffer = *at;
      if (buffer.size() != 0) return buffer;
    }
    return {};
  }
  // Makes a copyable handler for std::function; Asio handlers are move-only.
  template <typename Handler>
  static ByteStream::Done shared(Handler handler) {
    return [kept = std::make_shared<Handler>(std::move(handler))](
               boost::system::error_code fault, std::size_t count) { (*kept)(fault, count); };
  }
  template <typename Handler>
  void complete(Handler handler) {
    boost::asio::post(executor_, [handler = std::move(handler)]() mutable {
      handler(boost::system::error_code{}, 0);
    });
  }

  boost::asio::any_io_executor executor_;
  std::unique_ptr<ByteStream> stream_;
};

// Beast calls these at the end of a WebSocket and on its timeout.
template <typename Handler>
void async_teardown(boost::beast::role_type, StreamAdapter& adapter, Handler&& handler) {
  adapter.stream().end_sending();
  boost::asio::post(adapter.get_executor(), [handler = std::forward<Handler>(handler)]() mutable {
    handler(boost::system::error_code{});
  });
}
inline void beast_close_socket(StreamAdapter& adapter) { adapter.stream().close(); }

}  // namespace fieldcast::web
