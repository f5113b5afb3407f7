// Interfaces between a WebSocket at /live, which owns the LiveProtocol and implements LivePeer, and
// its protocol. All calls are on the io thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "bridge/http/http_message.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

// After close() every call has no effect.
class LivePeer {
 public:
  virtual ~LivePeer() = default;
  // Sent in order. A client with more than kMaxUnsent bytes of unread texts is closed.
  virtual void send_text(std::string message) = 0;
  // REQUIRES: no other frame is in flight (see on_taken).
  virtual void send_binary(std::shared_ptr<const std::string> frame) = 0;
  // Calls on_wake() once at that time; a later call replaces the time. kNever: cancels it.
  virtual void wake_at(Instant when) = 0;
  // Sends a close frame with the reason (at most 120 bytes); on_closed() follows later.
  virtual void close(std::string_view reason) = 0;
};
inline constexpr std::size_t kMaxUnsent = 512 * 1024;  // bytes of texts for one client

class LiveProtocol {
 public:
  virtual ~LiveProtocol() = default;
  virtual void on_open(Instant now) = 0;
  virtual void on_text(std::string_view message, Instant now) = 0;  // at most 4 KiB, UTF-8
  virtual void on_taken(Instant now) = 0;  // the kernel has accepted the last binary frame
  virtual void on_wake(Instant now) = 0;
  // The client disconnected or was closed; the last call before the destructor.
  virtual void on_closed() = 0;
};

// Called for each client that passed the checks of the upgrade. The peer outlives the protocol.
using MakeLiveProtocol =
    std::function<std::unique_ptr<LiveProtocol>(const Caller& caller, LivePeer& peer)>;

}  // namespace fieldcast::web
