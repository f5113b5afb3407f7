// The catalogue of one bus: each channel on the keyed topic, and all of them by blocks. The writers
// are the bridge's and outlive it. One caller at a time (dds_link.hpp), but flush(), which any
// thread may call.
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
  struct Writers {
    dds::DataWriter* channels = nullptr;  // fieldcast/Channel
    dds::DataWriter* blocks = nullptr;    // fieldcast/CatalogueBlock
  };
  BusCatalogue(const Writers& writers, const std::string& bridge, const std::string& bus,
               std::uint64_t epoch);

  // Before publish(), in the order of the channel indices.
  void add(const DeviceSpec& device, const ChannelSpec& channel, std::optional<Duration> refresh);
  [[nodiscard]] bool publish();  // everything; false: it does not fit
  // The keyed entry leaves at once, its block with flush().
  void set_refresh(ChannelIndex channel, std::optional<Duration> refresh);
  void flush();
  void dispose_blocks();
  void dispose_channels();

  [[nodiscard]] const std::vector<idl::Channel>& channels() const { return channels_; }

 private:
  [[nodiscard]] bool write_block(std::size_t first);  // REQUIRES: mutex_ held

  const Writers writers_;
  const std::string bridge_;
  const std::string bus_;
  const std::uint64_t epoch_;
  std::mutex mutex_;                    // what follows
  std::vector<idl::Channel> channels_;  // by channel index, as published
  std::set<std::size_t> changed_;       // the first channel of blocks that flush() has to write
  idl::CatalogueBlock block_;
};

}  // namespace fieldcast
