// One WebSocket at /live: the shell around its protocol. Owns the stream, the protocol and what
// waits to be sent. Lives on the io thread; shared with the operations under way.
#pragma once

#include <memory>
#include <string>

#include "tools/station/live/live_peer.hpp"
#include "tools/station/web/http_session.hpp"

namespace fieldcast::web {

struct LiveLimits {
  std::size_t message_bytes = 4 * 1024;           // of the client
  Duration handshake = std::chrono::seconds{10};  // and the farewell of a close
  Duration idle = std::chrono::seconds{120};      // no byte came, not even the answer to a ping
};

class LiveSocket {
 public:
  virtual ~LiveSocket() = default;
  // `gone` is called once, when the WebSocket is closed, and never inside this function.
  [[nodiscard]] static std::shared_ptr<LiveSocket> open(boost::asio::io_context& io,
                                                        LiveRequest request,
                                                        const MakeLiveProtocol& make,
                                                        const LiveLimits& limits,
                                                        std::function<void(LiveSocket*)> gone);

  [[nodiscard]] virtual const Site::Upgrade& who() const = 0;
  // Sends a close frame; closes at the latest after the limit of the handshake.
  virtual void end(std::string_view reason) = 0;
  virtual void drop() = 0;  // closes at once
};

}  // namespace fieldcast::web
