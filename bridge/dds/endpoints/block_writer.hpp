// Writes the SampleBlock topic of one bus while a reader is matched: the samples of an exchange in
// one message, and snapshots of all last values in a few. Owns the writer, a copy of every last
// value, and the blocks that wait for flush(). write() has one caller at a time; any thread may
// call the others. A write never waits: the history is a ring, and a reader that lags loses the
// oldest blocks.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/endpoints/renewed_writer.hpp"
#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class SnapshotSender;

class BlockWriter {
 public:
  // Largest block in bytes: with all peers on this machine; on networks, to fit into one packet.
  static constexpr std::size_t kBytesOnLoopback = 32'000, kBytesOnNetworks = 1'300;

  struct Stream {
    std::string bus;
    std::size_t channels = 0;
    std::uint64_t epoch = 0;  // of the bus's catalogue
    std::size_t most_bytes = kBytesOnNetworks;
  };
  // Requests a snapshot for each new reader. Throws DdsError.
  BlockWriter(Domain& domain, const std::string& label, Stream stream, SnapshotSender& snapshots);
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  // Continues another bridge's stream after its block `number`. Call it before the first write().
  void go_on_with(std::uint64_t epoch, std::uint64_t number, std::span<const Sample> last,
                  const UtcMapping& mapping);

  // kSoon: the block waits for flush() or for the next one that does not wait.
  enum class When : std::uint8_t { kNow, kSoon };
  void write(std::span<const Sample> samples, const UtcMapping& mapping, When when = When::kNow);
  void flush();
  // Writes the last value of every channel, or an empty block. Returns the number of blocks.
  std::size_t write_snapshot();

  // Returns false if the channel has no value.
  [[nodiscard]] bool last_value(ChannelIndex channel, LastValue& out) const;

  void tidy(Instant now) { writer_.tidy(now); }  // call it regularly

  [[nodiscard]] std::uint32_t readers() const { return writer_.readers(); }
  [[nodiscard]] std::uint64_t written() const { return number_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t waited() const { return waited_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kMostHeld = 16;

  // REQUIRES for both: mutex_ held.
  void send(BlockFiller& filler, bool snapshot, When when);
  void write_held();

  const Stream stream_;
  mutable std::mutex mutex_;       // protects the members below and the order of blocks
  std::vector<LastValue> values_;  // by channel index
  idl::SampleBlock block_;
  std::vector<idl::SampleBlock> held_;  // kept for their memory; the first held_blocks_ wait
  std::size_t held_blocks_ = 0;
  std::atomic<std::uint64_t> number_{0};  // of the last block; changed with mutex_ held
  std::atomic<std::uint64_t> waited_{0};  // blocks that waited for flush()
  RenewedWriter writer_;
};

// Decides when the last values of a bus are sent again: for new readers, and for readers that lost
// blocks (SnapshotRequest). One snapshot serves all requests that arrive meanwhile. request() never
// waits, on any thread; a thread of this object sends the snapshots.
class SnapshotSender : private dds::DataReaderListener {
 public:
  static constexpr Duration kGather = std::chrono::milliseconds{20};  // after the first request
  static constexpr Duration kRest = std::chrono::milliseconds{100};   // between two rounds
  // After each block: sockets of readers on this machine hold only a few.
  static constexpr Duration kPace = std::chrono::microseconds{500};

  struct Sent {
    std::size_t blocks = 0;
    bool all = true;  // false: the next part must follow
  };
  enum class Part : std::uint8_t { kFirst, kNext };
  // Writes a part of the snapshot of a bus, or nothing if there is no such bus.
  using Send = std::function<Sent(const std::string& bus, Part part)>;
  // `asked` is called on a DDS thread for each request and matched reader; may be null.
  SnapshotSender(Domain& domain, Send send, std::function<void()> asked);
  ~SnapshotSender() override;

  void request(const std::string& bus);
  // A reader of the bus has matched. `wants`: it needs the last values.
  void matched(const std::string& bus, bool wants);
  void close();  // nothing is sent after it returns; a second call has no effect

 private:
  void on_data_available(dds::DataReader* reader) override;
  void run();
  bool rest(Duration time, std::unique_lock<std::mutex>& lock);
  bool send_all(const std::string& bus, std::unique_lock<std::mutex>& lock);

  Domain& domain_;
  const Send send_;
  const std::function<void()> asked_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> requested_;
  bool ending_ = false;
  dds::DataReader* requests_ = nullptr;
  std::thread thread_;  // last member: it uses the members above
};

}  // namespace fieldcast
