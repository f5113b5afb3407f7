#include "bridge/dds/endpoints/block_writer.hpp"

#include "bridge/base/check.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

BlockWriter::BlockWriter(Domain& domain, const std::string& label, Stream stream,
                         std::function<void()> on_reader)
    : domain_(domain),
      stream_(std::move(stream)),
      on_reader_(std::move(on_reader)),
      values_(stream_.channels) {
  block_.bus() = cut_text(stream_.bus, kMaxNameLength);
  block_.epoch(stream_.epoch);
  writer_ = domain_.writer(kSampleBlockTopic, label, this, dds::StatusMask::publication_matched());
}

BlockWriter::~BlockWriter() { domain_.remove(writer_); }

void BlockWriter::on_publication_matched(dds::DataWriter*,
                                         const dds::PublicationMatchedStatus& status) {
  readers_.store(static_cast<std::uint32_t>(status.current_count), std::memory_order_relaxed);
  if (status.current_count_change > 0) on_reader_();
}

void BlockWriter::go_on_with(std::uint64_t epoch, std::uint64_t number,
                             std::span<const Sample> last, const UtcMapping& mapping) {
  const std::lock_guard lock(mutex_);
  block_.epoch(epoch);
  number_ = number;
  for (const Sample& sample : last) {
    if (sample.channel < values_.size() && sample.sequence != 0)
      to_last_value(sample, mapping, values_[sample.channel]);
  }
}

void BlockWriter::write(std::span<const Sample> samples, const UtcMapping& mapping) {
  const std::lock_guard lock(mutex_);
  const bool wanted = readers() > 0;
  BlockFiller filler(block_, stream_.most_bytes);
  for (const Sample& sample : samples) {
    FIELDCAST_CHECK(sample.channel < values_.size());
    LastValue& value = values_[sample.channel];
    to_last_value(sample, mapping, value);
    if (!wanted || filler.add(sample.channel, value)) continue;
    send(filler, false);
    filler = BlockFiller(block_, stream_.most_bytes);
    (void)filler.add(sample.channel, value);
  }
  if (wanted && !samples.empty()) send(filler, false);
}

std::size_t BlockWriter::write_snapshot() {
  const std::lock_guard lock(mutex_);
  if (readers() == 0) return 0;
  std::size_t blocks = 0;
  ChannelIndex next = 0;
  do {
    BlockFiller filler(block_, stream_.most_bytes);
    for (; next < values_.size(); ++next) {
      if (values_[next].sequence != 0 && !filler.add(next, values_[next])) break;
    }
    send(filler, true);
    ++blocks;
  } while (next < values_.size());
  return blocks;
}

bool BlockWriter::last_value(ChannelIndex channel, LastValue& out) const {
  const std::lock_guard lock(mutex_);
  FIELDCAST_CHECK(channel < values_.size());
  if (values_[channel].sequence == 0) return false;
  out = values_[channel];
  return true;
}

void BlockWriter::send(BlockFiller& filler, bool snapshot) {
  filler.finish();
  block_.number(++number_);
  block_.snapshot(snapshot);
  writer_->write(&block_);
}

}  // namespace fieldcast
