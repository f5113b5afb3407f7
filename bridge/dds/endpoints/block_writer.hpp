// Writes the SampleBlock topic of one bus: the samples of an exchange in one message, and snapshots
// of the last values of all channels in a few messages. It writes only while a reader is matched.
//
// Owns the writer and a copy of every last value. write() has one caller at a time (dds_link.hpp);
// all other functions may be called from any thread. A write never waits for a reader: the writer's
// history is a ring, and a reader that lags loses the oldest blocks.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class BlockWriter : private dds::DataWriterListener {
 public:
  // Largest block in bytes: if all peers are on this machine, and on networks, where a block must
  // fit into one packet.
  static constexpr std::size_t kBytesOnLoopback = 32'000, kBytesOnNetworks = 1'300;

  struct Stream {
    std::string bus;
    std::size_t channels = 0;
    std::uint64_t epoch = 0;  // of the bus's catalogue
    std::size_t most_bytes = kBytesOnNetworks;
  };
  // Calls `on_reader` on a DDS thread for each new reader, which needs a snapshot. Throws DdsError.
  BlockWriter(Domain& domain, const std::string& label, Stream stream,
              std::function<void()> on_reader);
  ~BlockWriter() override;
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  // Continues the stream of another bridge after its block `number`, with its last values. Call it
  // before the first write().
  void go_on_with(std::uint64_t epoch, std::uint64_t number, std::span<const Sample> last,
                  const UtcMapping& mapping);

  void write(std::span<const Sample> samples, const UtcMapping& mapping);
  // Writes the last value of every channel that has one, or an empty block. Returns the number of
  // blocks.
  std::size_t write_snapshot();

  // Returns false if the channel has no value.
  [[nodiscard]] bool last_value(ChannelIndex channel, LastValue& out) const;

  [[nodiscard]] std::uint32_t readers() const { return readers_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t written() const { return number_.load(std::memory_order_relaxed); }

 private:
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override;
  void send(BlockFiller& filler, bool snapshot);  // REQUIRES: mutex_ held

  Domain& domain_;
  const Stream stream_;
  const std::function<void()> on_reader_;
  std::atomic<std::uint32_t> readers_{0};
  mutable std::mutex mutex_;       // protects the members below and the order of blocks
  std::vector<LastValue> values_;  // by channel index
  idl::SampleBlock block_;
  std::atomic<std::uint64_t> number_{0};  // of the last block; changed with mutex_ held
  dds::DataWriter* writer_ = nullptr;
};

}  // namespace fieldcast
