// The catalogue of one bus: each channel on the keyed topic, and all of them by blocks. The writer
// of blocks is the bridge's and outlives it. One caller at a time (dds_link.hpp), but flush(),
// which any thread may call.
//
// Owns the writers of fieldcast/Channel, none with more than kChannelsPerCatalogueWriter: when a
// reader is found, Fast DDS 2.9.1 copies for each message that a writer holds the list of all those
// before it (ReaderProxy::add_change), and answers nobody's discovery meanwhile. With 64 000 in one
// writer no new reader was served within 30 s.
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridge/dds/domain.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

class BusCatalogue {
 public:
  // `blocks`: of fieldcast/CatalogueBlock.
  BusCatalogue(Domain& domain, dds::DataWriter* blocks, const std::string& bridge,
               const std::string& bus, std::uint64_t epoch);
  ~BusCatalogue();
  BusCatalogue(const BusCatalogue&) = delete;
  BusCatalogue& operator=(const BusCatalogue&) = delete;

  // Before publish(), in the order of the channel indices. Throws DdsError.
  void add(const DeviceSpec& device, const ChannelSpec& channel, std::optional<Duration> refresh);
  [[nodiscard]] bool publish();  // everything; false: it does not fit
  // Before publish(): it is the same catalogue as that of another bridge, which has published it.
  void go_on_with(std::uint64_t epoch);
  [[nodiscard]] std::uint64_t epoch() const;
  // The keyed entry leaves at once, its block with flush().
  void set_refresh(ChannelIndex channel, std::optional<Duration> refresh);
  void flush();
  void dispose_blocks();
  void dispose_channels();
  // Waits at most so long until the readers of fieldcast/Channel have what was written.
  void wait_for_readers(Duration limit);

  [[nodiscard]] const std::vector<idl::Channel>& channels() const { return channels_; }

 private:
  [[nodiscard]] bool write_block(std::size_t first);  // REQUIRES: mutex_ held
  [[nodiscard]] dds::DataWriter* writer_of(std::size_t channel) const;

  Domain& domain_;
  dds::DataWriter* const blocks_;
  std::vector<dds::DataWriter*> writers_;  // of fieldcast/Channel
  const std::string bridge_;
  const std::string bus_;
  mutable std::mutex mutex_;  // what follows
  std::uint64_t epoch_;
  std::vector<idl::Channel> channels_;  // by channel index, as published
  std::set<std::size_t> changed_;       // the first channel of blocks that flush() has to write
  idl::CatalogueBlock block_;
};

}  // namespace fieldcast
