// Publishes the catalogue of one bus: all channels in blocks, whose writer outlives this object,
// and each channel on the keyed topic, from its first reader on: an instance takes 850 bytes in the
// library. One caller at a time, except flush() and wake(). Each writer of fieldcast/Channel has at
// most kChannelsPerCatalogueWriter channels: for a new reader, Fast DDS 2.9.1 copies, for each
// message in a history, the list of all earlier messages (ReaderProxy::add_change), without
// discovery meanwhile. With 64 000 channels in one writer, no new reader was served within 30 s.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast {

class BusCatalogue : private dds::DataWriterListener {
 public:
  // `matched`: called on a DDS thread for the first reader of fieldcast/Channel; then call wake().
  BusCatalogue(Domain& domain, dds::DataWriter* blocks, const std::string& bridge,
               const std::string& bus, std::uint64_t epoch, std::function<void()> matched);
  ~BusCatalogue() override;
  BusCatalogue(const BusCatalogue&) = delete;
  BusCatalogue& operator=(const BusCatalogue&) = delete;

  // Adds a channel; call it before publish(), in the order of the channel indices. Both outlive
  // this object, since a message of each channel would need 800 bytes. Throws DdsError.
  void add(const DeviceSpec& device, const ChannelSpec& channel, std::optional<Duration> refresh);
  // Writes all blocks, and the channels that were written before; returns false if they do not fit.
  [[nodiscard]] bool publish();
  // Adopts the epoch of another bridge's identical catalogue. Call it before publish().
  void go_on_with(std::uint64_t epoch);
  [[nodiscard]] std::uint64_t epoch() const;
  // If a reader was matched, writes at most `most` channels that are not written. Returns false if
  // more are left, also because the library refused one: call it again.
  [[nodiscard]] bool wake(std::size_t most);
  // The keyed entry is written immediately, if it was before; its block with flush().
  void set_refresh(ChannelIndex channel, std::optional<Duration> refresh);
  void flush();
  void dispose_blocks();
  void dispose_channels();
  // Waits at most `limit` until the readers of fieldcast/Channel have acknowledged everything.
  void wait_for_readers(Duration limit);

  [[nodiscard]] idl::Channel message(ChannelIndex channel) const;

 private:
  struct Entry {
    const DeviceSpec* device;
    const ChannelSpec* channel;
    std::optional<Duration> refresh;  // as published
  };
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override;
  // REQUIRES for all: mutex_ held.
  [[nodiscard]] bool write_block(std::size_t first);
  void make(std::size_t channel, idl::Channel& out) const;
  bool write_channel(std::size_t channel, idl::Channel& scratch);
  [[nodiscard]] dds::DataWriter* writer_of(std::size_t channel) const;

  Domain& domain_;
  dds::DataWriter* const blocks_;
  std::vector<dds::DataWriter*> writers_;  // of fieldcast/Channel
  const std::string bridge_;
  const std::string bus_;
  const std::function<void()> matched_;
  std::atomic<bool> wanted_{false};
  mutable std::mutex mutex_;  // protects the members below
  std::uint64_t epoch_;
  std::vector<Entry> channels_;    // by channel index
  std::size_t written_ = 0;        // channels that have instances, from the first on
  std::set<std::size_t> changed_;  // first channel of each block that flush() has to write
};

}  // namespace fieldcast
