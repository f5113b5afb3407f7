// The SampleBlock writer of one bus: the samples of an exchange in one message, and the last values
// of all channels in a few. Writes only while a reader is matched.
//
// Owns the writer and a copy of every last value. write() has one caller at a time (dds_link.hpp);
// everything else comes from any thread. Nobody waits for a reader: the writer is a ring, and one
// that stays behind loses the oldest.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "bridge/dds/domain.hpp"
#include "bridge/dds/topics/block.hpp"

namespace fieldcast {

class BlockWriter : private dds::DataWriterListener {
 public:
  // Bytes of a block where all peers are on this machine, and where one must not be cut on its way.
  static constexpr std::size_t kBytesOnLoopback = 32'000, kBytesOnNetworks = 1'300;

  struct Stream {
    std::string bus;
    std::size_t channels = 0;
    std::uint64_t epoch = 0;  // of its catalogue
    std::size_t most_bytes = kBytesOnNetworks;
  };
  // `on_reader` is called on a DDS thread for each reader that is new and wants a snapshot. Throws
  // DdsError.
  BlockWriter(Domain& domain, const std::string& label, Stream stream,
              std::function<void()> on_reader);
  ~BlockWriter() override;
  BlockWriter(const BlockWriter&) = delete;
  BlockWriter& operator=(const BlockWriter&) = delete;

  // Before anything is written: the stream of another bridge goes on here, after its block `number`
  // and its last values.
  void go_on_with(std::uint64_t epoch, std::uint64_t number, std::span<const Sample> last,
                  const UtcMapping& mapping);

  void write(std::span<const Sample> samples, const UtcMapping& mapping);
  // The last value of every channel that has one, or an empty block. Returns the number of blocks.
  std::size_t write_snapshot();

  // False if the channel has none.
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
  mutable std::mutex mutex_;       // what follows, and the order of blocks
  std::vector<LastValue> values_;  // by channel index
  idl::SampleBlock block_;
  std::atomic<std::uint64_t> number_{0};  // of the last block; changed with mutex_ held
  dds::DataWriter* writer_ = nullptr;
};

}  // namespace fieldcast
