#include "bridge/dds/endpoints/block_writer.hpp"

#include <pthread.h>

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

BlockWriter::BlockWriter(Domain& domain, const std::string& label, Stream stream,
                         SnapshotSender& snapshots)
    : stream_(std::move(stream)),
      values_(stream_.channels),
      writer_(
          domain,
          [&domain, label](dds::DataWriterListener* listener, dds::StatusMask mask) {
            return domain.writer(kSampleBlockTopic, label, listener, mask);
          },
          [this, &snapshots] { snapshots.matched(stream_.bus, true); }) {
  block_.bus() = cut_text(stream_.bus, kMaxNameLength);
  block_.epoch(stream_.epoch);
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

void BlockWriter::write(std::span<const Sample> samples, const UtcMapping& mapping, When when) {
  const std::lock_guard lock(mutex_);
  const bool wanted = readers() > 0;
  BlockFiller filler(block_, stream_.most_bytes);
  for (const Sample& sample : samples) {
    FIELDCAST_CHECK(sample.channel < values_.size());
    LastValue& value = values_[sample.channel];
    to_last_value(sample, mapping, value);
    if (!wanted || filler.add(sample.channel, value)) continue;
    send(filler, false, when);
    filler = BlockFiller(block_, stream_.most_bytes);
    (void)filler.add(sample.channel, value);
  }
  if (wanted && !samples.empty()) send(filler, false, when);
}

void BlockWriter::flush() {
  const std::lock_guard lock(mutex_);
  write_held();
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
    send(filler, true, When::kNow);
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

void BlockWriter::send(BlockFiller& filler, bool snapshot, When when) {
  filler.finish();
  block_.number(++number_);
  block_.snapshot(snapshot);
  if (when == When::kSoon && held_blocks_ < kMostHeld) {
    if (held_blocks_ == held_.size()) held_.push_back(block_);
    std::swap(held_[held_blocks_++], block_);
    ++waited_;
    return;
  }
  write_held();
  writer_.write(&block_);
}

void BlockWriter::write_held() {
  for (std::size_t i = 0; i < held_blocks_; ++i) writer_.write(&held_[i]);
  held_blocks_ = 0;
}

SnapshotSender::SnapshotSender(Domain& domain, Send send, std::function<void()> asked)
    : domain_(domain),
      send_(std::move(send)),
      asked_(std::move(asked)),
      thread_([this] { run(); }) {
  requests_ = domain.reader(kSnapshotRequestTopic, this, dds::StatusMask::data_available());
}

SnapshotSender::~SnapshotSender() { close(); }

void SnapshotSender::close() {
  if (!thread_.joinable()) return;
  domain_.remove(requests_);
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void SnapshotSender::request(const std::string& bus) {
  {
    const std::lock_guard lock(mutex_);
    if (requested_.size() < static_cast<std::size_t>(kMaxBuses)) requested_.insert(bus);
  }
  changed_.notify_one();
}

void SnapshotSender::matched(const std::string& bus, bool wants) {
  if (asked_) asked_();
  if (wants) request(bus);
}

void SnapshotSender::on_data_available(dds::DataReader* reader) {
  idl::SnapshotRequest asked;
  dds::SampleInfo info;
  while (reader->take_next_sample(&asked, &info) == ReturnCode_t::RETCODE_OK) {
    if (info.valid_data) matched(asked.bus().c_str(), true);
  }
}

// Returns false if close() was called.
bool SnapshotSender::rest(Duration time, std::unique_lock<std::mutex>& lock) {
  return !changed_.wait_for(lock, time, [this] { return ending_; });
}

bool SnapshotSender::send_all(const std::string& bus, std::unique_lock<std::mutex>& lock) {
  for (Part part = Part::kFirst;; part = Part::kNext) {
    lock.unlock();
    const Sent sent = send_(bus, part);
    lock.lock();
    if (!rest(kPace * static_cast<int>(sent.blocks), lock)) return false;
    if (sent.all) return true;
  }
}

void SnapshotSender::run() {
  pthread_setname_np(pthread_self(), "snapshots");
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !requested_.empty(); });
    if (ending_ || !rest(kGather, lock)) return;
    for (const std::string& bus : std::exchange(requested_, {})) {
      if (!send_all(bus, lock)) return;
    }
    if (!rest(kRest, lock)) return;
  }
}

}  // namespace fieldcast
