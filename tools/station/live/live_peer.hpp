// The seam between a WebSocket at /live and its protocol. The socket's shell (web/live_socket) owns
// a LiveProtocol and is its LivePeer; all calls both ways are made on the io thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

// The client's end, as the protocol sees it. After close() every call does nothing.
class LivePeer {
 public:
  virtual ~LivePeer() = default;
  // Sent in order with all that was sent before. Texts are rare; a client that leaves more than
  // kMaxUnsent bytes of them unread is closed by the shell.
  virtual void send_text(std::string message) = 0;
  // At most one is under way: REQUIRES that the last one was taken (on_taken).
  virtual void send_binary(std::shared_ptr<const std::string> frame) = 0;
  // Calls on_wake() once at that time; a later call replaces the time. kNever: not at all.
  virtual void wake_at(Instant when) = 0;
  // Sends a close frame with the reason (at most 120 bytes); on_closed() follows later.
  virtual void close(std::string_view reason) = 0;
};
inline constexpr std::size_t kMaxUnsent = 512 * 1024;  // bytes of texts for one client

// What /live speaks with one client, without a socket and a clock.
class LiveProtocol {
 public:
  virtual ~LiveProtocol() = default;
  virtual void on_open(Instant now) = 0;
  virtual void on_text(std::string_view message, Instant now) = 0;  // at most 4 KiB, UTF-8
  virtual void on_taken(Instant now) = 0;  // the kernel has taken the last binary frame
  virtual void on_wake(Instant now) = 0;
  // The client is gone, or it was closed. Nothing is called from then on; it is destroyed later.
  virtual void on_closed() = 0;
};

// Made for each client that has passed the checks of the upgrade. The peer outlives it.
using MakeLiveProtocol =
    std::function<std::unique_ptr<LiveProtocol>(const Caller& caller, LivePeer& peer)>;

}  // namespace fieldcast::web
