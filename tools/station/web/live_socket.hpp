// One WebSocket at /live. Owns the stream, the protocol and the send queue. Runs on the io thread;
// pending operations share ownership.
#pragma once

#include <memory>
#include <string>

#include "bridge/net/byte_stream.hpp"
#include "tools/station/live/live_peer.hpp"
#include "tools/station/web/site.hpp"

namespace fieldcast::web {

struct LiveLimits {
  std::size_t message_bytes = 4 * 1024;           // maximum message of the client
  Duration handshake = std::chrono::seconds{10};  // also limits the closing handshake
  Duration idle = std::chrono::seconds{120};      // no byte received, not even a pong
};

struct LiveRequest {
  std::unique_ptr<ByteStream> stream;
  std::string head;  // request header, which the WebSocket library parses again
  Site::Upgrade who;
};

class LiveSocket {
 public:
  virtual ~LiveSocket() = default;
  // `gone` is called once, when the WebSocket is closed, never within open().
  [[nodiscard]] static std::shared_ptr<LiveSocket> open(boost::asio::io_context& io,
                                                        LiveRequest request,
                                                        const MakeLiveProtocol& make,
                                                        const LiveLimits& limits,
                                                        std::function<void(LiveSocket*)> gone);

  [[nodiscard]] virtual const Site::Upgrade& who() const = 0;
  // Sends a close frame; closes at the latest after LiveLimits::handshake.
  virtual void end(std::string_view reason) = 0;
  virtual void drop() = 0;  // closes immediately
};

}  // namespace fieldcast::web
