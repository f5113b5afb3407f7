// One side of a relay: delivers what its stream brings, sends what it is given in order, and says
// when too much waits to be sent. Lives on one io thread.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridge/net/byte_stream.hpp"
#include "core/base/bytes.hpp"
#include "core/base/time.hpp"

namespace fieldcast::program {

// How long the kernel waits for the peer of a relay that takes no bytes just now: with a slow line
// behind it, a peer opens the TCP window in steps. Engineer gives up a peer that takes none at all.
inline constexpr Duration kTunnelPatience = std::chrono::seconds{90};

class RelayEnd : public std::enable_shared_from_this<RelayEnd> {
 public:
  static constexpr std::size_t kHigh = 128 * 1024;  // unsent bytes: the other side must pause
  static constexpr std::size_t kLow = 32 * 1024;    // unsent bytes: the other side may go on
  static constexpr std::size_t kPiece = 32 * 1024;  // bytes of one read, at most

  struct Handlers {
    std::function<void(ByteView)> bytes;
    std::function<void(std::string reason)> gone;  // once, not after close(); for people
    std::function<void(bool)> room;  // false: more than kHigh waits; true: less than kLow again
  };

  explicit RelayEnd(std::unique_ptr<ByteStream> stream)
      : stream_(std::move(stream)), piece_(kPiece) {}

  void start(Handlers handlers);
  void send(ByteView bytes);
  // Stops reading, or goes on; what has arrived in the kernel stays there and holds the peer.
  void pause(bool paused);
  [[nodiscard]] std::size_t unsent() const { return waiting_.size() + writing_.size() - written_; }
  // More than kHigh waited, and not less than kLow yet.
  [[nodiscard]] bool crowded() const { return crowded_; }
  // Bytes have left this machine since it was asked last: a slow peer is no dead one.
  [[nodiscard]] bool drained();
  // Closes at once; no handler is called any more.
  void close();
  // Reads no more, and closes when everything is sent; its owner may close it before. Then calls
  // `done`, once. kLeft: what the kernel took has left too. The kernel does not report that, so the
  // owner calls settle() from time to time.
  enum class Until : std::uint8_t { kTaken, kLeft };
  void finish(Until until, std::function<void()> done);
  // True: closed. REQUIRES: finish() was called.
  bool settle();

 private:
  void read();
  void write();
  void fail(const std::string& reason);

  std::unique_ptr<ByteStream> stream_;
  Handlers handlers_;
  std::function<void()> finished_;
  Bytes piece_;
  Bytes waiting_, writing_;
  std::size_t written_ = 0;  // of writing_
  Until until_ = Until::kTaken;
  std::int64_t taken_ = 0;  // by the kernel, ever
  std::int64_t left_ = 0;   // of these, when drained() was asked last
  bool reading_ = false, paused_ = false, crowded_ = false, closed_ = false;
};

}  // namespace fieldcast::program
