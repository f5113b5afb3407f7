#include "bridge/dds/endpoints/snapshot_sender.hpp"

#include <pthread.h>

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <utility>

namespace fieldcast {

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

void SnapshotSender::on_data_available(dds::DataReader* reader) {
  idl::SnapshotRequest asked;
  dds::SampleInfo info;
  while (reader->take_next_sample(&asked, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    if (asked_) asked_();
    request(asked.bus().c_str());
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
