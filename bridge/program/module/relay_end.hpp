// One side of a relay: delivers and sends bytes, and reports when too many wait. One io thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
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
  // Stops reading, closes when everything is sent, and calls `done` once. kLeft: also waits for the
  // kernel, so the owner calls settle() regularly. The owner may close it earlier.
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

// Connections whose peers have not authenticated yet, limited per address and in total; a further
// one cuts the oldest, first of its own address. Authenticated ones are never cut. Pure; one owner.
class SilentConnections {
 public:
  using Id = std::uint64_t;
  using Cut = std::function<void()>;  // ends the connection; called at most once, after its removal

  SilentConnections(std::size_t most, std::size_t most_of_one)
      : most_(most), most_of_one_(most_of_one) {}

  // Adds a connection of this host (without port). Cuts an older one if a limit is reached.
  [[nodiscard]] Id add(const std::string& host, Cut cut);
  // Removes a connection that has authenticated or ended. Returns false if it was cut.
  bool remove(Id id);
  // Cuts the oldest connection of the hosts with the most. Returns false if there is none.
  bool cut_one();

  [[nodiscard]] std::size_t size() const { return all_.size(); }

 private:
  struct Connection {
    std::string host;
    Cut cut;
  };
  void cut_oldest_of(const std::string& host);
  void cut(std::map<Id, Connection>::iterator which);

  const std::size_t most_, most_of_one_;
  std::map<Id, Connection> all_;           // the oldest first
  std::map<std::string, std::size_t> of_;  // number of connections by host
  Id last_ = 0;
};

}  // namespace fieldcast::program
