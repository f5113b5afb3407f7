// One side of a relay: delivers the bytes of its stream, sends bytes in order, and reports when too
// many wait to be sent. Runs on one io thread.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridge/net/byte_stream.hpp"
#include "core/base/bytes.hpp"
#include "core/base/time.hpp"

namespace fieldcast::program {

// Time that the kernel waits for the peer of a relay that accepts no bytes: with a slow line behind
// it, a peer opens the TCP window in steps. Engineer disconnects a peer that accepts none at all.
inline constexpr Duration kTunnelPatience = std::chrono::seconds{90};

class RelayEnd : public std::enable_shared_from_this<RelayEnd> {
 public:
  static constexpr std::size_t kHigh = 128 * 1024;  // unsent bytes: the other side must pause
  static constexpr std::size_t kLow = 32 * 1024;    // unsent bytes: the other side may continue
  static constexpr std::size_t kPiece = 32 * 1024;  // largest read in bytes

  struct Handlers {
    std::function<void(ByteView)> bytes;
    std::function<void(std::string reason)> gone;  // called once, not after close(); human-readable
    // false: more than kHigh are unsent; true: less than kLow again
    std::function<void(bool)> room;
  };

  explicit RelayEnd(std::unique_ptr<ByteStream> stream)
      : stream_(std::move(stream)), piece_(kPiece) {}

  void start(Handlers handlers);
  void send(ByteView bytes);
  // Pauses or resumes reading; bytes that have arrived stay in the kernel and slow down the peer.
  void pause(bool paused);
  [[nodiscard]] std::size_t unsent() const { return waiting_.size() + writing_.size() - written_; }
  // True after more than kHigh bytes were unsent, until less than kLow are.
  [[nodiscard]] bool crowded() const { return crowded_; }
  // Returns true if bytes have left this machine since the last call: a slow peer is not dead.
  [[nodiscard]] bool drained();
  // Closes immediately; no handler is called after it.
  void close();
  // Stops reading, and closes when everything is sent; the owner may close it earlier. Then calls
  // `done` once. kLeft: also waits until the kernel has sent the bytes. The kernel does not report
  // that, so the owner calls settle() regularly.
  enum class Until : std::uint8_t { kTaken, kLeft };
  void finish(Until until, std::function<void()> done);
  // Returns true if closed. REQUIRES: finish() was called.
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
  std::int64_t taken_ = 0;  // by the kernel, in total
  std::int64_t left_ = 0;   // of these, at the last call of drained()
  bool reading_ = false, paused_ = false, crowded_ = false, closed_ = false;
};

}  // namespace fieldcast::program
